// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/core/behavior/ConstraintSolver.h>
#include <sofa/core/behavior/ForceField.h>
#include <sofa/version.h>

#if SOFA_VERSION >= 251200
#include <sofa/component/constraint/lagrangian/solver/UnbuiltGaussSeidelConstraintSolver.h>
#endif

#include <vector>

/// What differs between the releases of SOFA that the plugin is compiled against, v24.12 to v26.06. No other file asks
/// for the version.
namespace hexaplast::sofa_plugin
{

static_assert(SOFA_VERSION >= 241200, "Hexaplast needs SOFA v24.12 or later");

#if SOFA_VERSION >= 260600
using SofaComponent = sofa::core::objectmodel::BaseComponent;
#else
using SofaComponent = sofa::core::objectmodel::BaseObject;
#endif

/// All of a kind in a context and below.
template <class T>
std::vector<T*> allBelow(const sofa::core::objectmodel::BaseContext& context)
{
    std::vector<T*> found;
    context.get<T>(&found, sofa::core::objectmodel::BaseContext::SearchDown);
    return found;
}

/// The solvers of constraints in a scene that ask for one constraint after the other. Before v25.12 that was a word of
/// GenericConstraintSolver, which is not looked for.
inline std::vector<sofa::core::behavior::ConstraintSolver*> unbuiltConstraintSolvers(
    [[maybe_unused]] const sofa::core::objectmodel::BaseContext& root)
{
    std::vector<sofa::core::behavior::ConstraintSolver*> found;
#if SOFA_VERSION >= 251200
    using sofa::component::constraint::lagrangian::solver::UnbuiltGaussSeidelConstraintSolver;
    const auto all = allBelow<UnbuiltGaussSeidelConstraintSolver>(root);
    found.assign(all.begin(), all.end());
#endif
    return found;
}

/// Whether a component has been found not to work (v24.12 has no question of its own for that).
inline bool isInvalid(const SofaComponent& component)
{
    return component.d_componentState.getValue() == sofa::core::objectmodel::ComponentState::Invalid;
}

}  // namespace hexaplast::sofa_plugin
