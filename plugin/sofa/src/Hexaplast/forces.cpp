// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/InstrumentContactForceField.h>
#include <Hexaplast/registration.h>

#include "parts/grasp.hpp"
#include "parts/tangential_load.hpp"
#include "parts/tissue_contact.hpp"

namespace hexaplast::sofa_plugin
{

[[maybe_unused]] const bool kForcesAreRegistered =
    registerComponent<ForceOf<parts::TangentialLoad>>(parts::TangentialLoad::description()) &&
    registerComponent<ForceOf<parts::Grasp>>(parts::Grasp::description()) &&
    registerComponent<InstrumentContactForceField>(attributes::kInstrumentContactInSofa) &&
    registerComponent<ContactOf<parts::Tissues>>(parts::Tissues::description());

}  // namespace hexaplast::sofa_plugin
