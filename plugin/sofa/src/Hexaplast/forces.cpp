// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/InstrumentContactForceField.h>
#include <Hexaplast/registration.h>

#include "parts/grasp.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"

namespace hexaplast::sofa_plugin
{

void registerForces(sofa::core::ObjectFactory* factory)
{
    registerComponent<ForceOf<parts::TangentialLoad>>(factory, parts::TangentialLoad::description());
    registerComponent<ForceOf<parts::Grasp>>(factory, parts::Grasp::description());
    registerComponent<InstrumentContactForceField>(factory, attributes::kInstrumentContactInSofa);
    registerComponent<ContactOf<parts::Tissues>>(factory, parts::Tissues::description());
}

}  // namespace hexaplast::sofa_plugin
