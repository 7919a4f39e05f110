// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/Instrument.h>
#include <Hexaplast/registration.h>

#include "parts/grasp.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"

namespace hexaplast::sofa_plugin
{

void registerForces(sofa::core::ObjectFactory* factory)
{
    register_component<ForceOf<parts::TangentialLoad>>(factory, parts::TangentialLoad::description());
    register_component<ForceOf<parts::Grasp>>(factory, parts::Grasp::description());
    register_component<Instrument>(factory, attributes::kInstrumentContactInSofa);
    register_component<ContactOf<parts::Tissues>>(factory, parts::Tissues::description());
}

}  // namespace hexaplast::sofa_plugin
