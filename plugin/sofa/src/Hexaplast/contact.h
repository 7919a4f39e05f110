// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/OdeSolver.h>

/// What contact asks of the graph around it. Throws InputError where that is not there.
namespace hexaplast::sofa_plugin
{

using BodyField = HexahedronElastoplasticFEMForceField<Vec3Types>;

/// The field whose body has its nodes in `state`.
inline BodyField& body_field_of(const sofa::core::behavior::BaseMechanicalState& state)
{
    using sofa::core::objectmodel::BaseContext;
    const std::string on = "on its state '" + state.getName() + "'";
    BodyField* found = nullptr;
    std::vector<BodyField*> fields;
    state.getContext()->getRootContext()->get<BodyField>(&fields, BaseContext::SearchDown);
    for (BodyField* field : fields)
        if (field->getMState() == &state) found = field;
    if (!found) throw InputError("no body " + on + ": contact is that of a body's surface");
    if (!found->works()) throw InputError("its body '" + found->getName() + "' is invalid (see its error above)");
    if (state.getContext()->get<sofa::core::BaseMapping>(BaseContext::Local))
        throw InputError("its state '" + state.getName() +
                         "' follows another one: must be one that an integrator moves");
    return *found;
}

/// The EulerImplicitSolver that moves what is in a context; InputError for any other.
inline const sofa::core::behavior::OdeSolver& implicit_euler_of(const sofa::core::objectmodel::BaseContext& context)
{
    const auto* integrator = context.get<sofa::core::behavior::OdeSolver>();
    if (!integrator || integrator->getClassName() != "EulerImplicitSolver")
        throw InputError("needs an EulerImplicitSolver in its node or above");
    for (const char* scheme : {"trapezoidalScheme", "firstOrder"})
        if (const auto* is_on = dynamic_cast<const Data<bool>*>(integrator->findData(scheme));
            is_on && is_on->getValue())
            throw InputError(fmt::format("its EulerImplicitSolver has {}: contact needs implicit Euler", scheme));
    return *integrator;
}

inline SReal rayleigh_stiffness_of(const sofa::core::behavior::OdeSolver& integrator)
{
    const auto* stiffness = dynamic_cast<const Data<SReal>*>(integrator.findData("rayleighStiffness"));
    return stiffness ? stiffness->getValue() : 0;
}

/// The Rayleigh stiffness of contact is there for SOFA, which multiplies the stiffness by it: OptionError for another
/// one than its own.
inline void require_own_rayleigh_stiffness(SReal given, SReal own)
{
    if (given != own)
        throw parts::OptionError("rayleighStiffness",
                                 fmt::format("= {}: must not be given, as the Rayleigh stiffness of the integrator "
                                             "does not act on contact. damping damps it",
                                             given));
}

}  // namespace hexaplast::sofa_plugin
