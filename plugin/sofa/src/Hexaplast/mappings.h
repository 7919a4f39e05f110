// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/BaseMechanicalState.h>

#include <algorithm>
#include <vector>

namespace hexaplast::sofa_plugin
{

/// Whether a state follows another one: a mechanical mapping leads to it. One that is for the eye alone, from it to a
/// visual model, may stand beside it.
inline bool followsAnother(const sofa::core::behavior::BaseMechanicalState& state)
{
    std::vector<sofa::core::BaseMapping*> mappings;
    state.getContext()->get<sofa::core::BaseMapping>(&mappings, sofa::core::objectmodel::BaseContext::Local);
    return std::any_of(mappings.begin(), mappings.end(),
                       [&](sofa::core::BaseMapping* mapping)
                       {
                           const auto& to = mapping->getMechTo();
                           return mapping->isMechanical() && std::find(to.begin(), to.end(), &state) != to.end();
                       });
}

}  // namespace hexaplast::sofa_plugin
