// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/OdeSolver.h>

#include "parts/contact_options.hpp"

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
    const auto has = [&](const char* scheme)
    {
        const auto* data = dynamic_cast<const Data<bool>*>(integrator->findData(scheme));
        return data && data->getValue();
    };
    const std::string lacks =
        parts::integrator_lacks(integrator ? integrator->getClassName() : "", has, "in its node or above");
    if (!lacks.empty()) throw InputError(lacks);
    return *integrator;
}

/// What all contacts of bodies have, besides what makes them a component (TBase). Data: plugin/attributes/contact.hpp.
template <class TBase>
class ContactComponent : public TBase
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(ContactComponent, TBase), TBase);

    Data<SReal> d_contactStiffness{this->fromTable(d_contactStiffness, "contactStiffness", "Contact")};
    Data<SReal> d_tangentialStiffness{this->fromTable(d_tangentialStiffness, "tangentialStiffness", "Contact")};
    Data<SReal> d_friction{this->fromTable(d_friction, "friction", "Contact")};
    Data<SReal> d_contactDistance{this->fromTable(d_contactDistance, "contactDistance", "Contact")};
    Data<SReal> d_damping{this->fromTable(d_damping, "damping", "Contact")};
    Data<int> d_maxSubdivision{this->fromTable(d_maxSubdivision, "maxSubdivision", "Contact")};
    Data<bool> d_active{this->fromTable(d_active, "active", "Contact")};
    Data<sofa::type::Vec3> d_force{this->fromTable(d_force, "force")};
    Data<SReal> d_depth{this->fromTable(d_depth, "depth")};
    Data<int> d_touching{this->fromTable(d_touching, "touching")};
    Data<int> d_slipping{this->fromTable(d_slipping, "slipping")};
    Data<SReal> d_drawForceScale{this->initData(&d_drawForceScale, SReal(0), "drawForceScale",
                                                "Length of a force that is drawn [m/N]. 0: the greatest one has a "
                                                "tenth of the size of the body.")};

    bool isOneSided() const override { return !m_isAccepted && this->isInMatrix(); }
    void acceptStep() override { m_isAccepted = true; }

protected:
    using TBase::TBase;

    void checkRayleighStiffness() const override
    {
        if (const SReal given = this->rayleighStiffness.getValue(); given != m_ownRayleighStiffness)
            throw parts::OptionError("rayleighStiffness",
                                     fmt::format("= {}: must not be given, as the Rayleigh stiffness of the integrator "
                                                 "does not act on contact. damping damps it",
                                                 given));
    }

    SReal rayleighStiffnessOfIntegrator() const
    {
        const auto* stiffness =
            dynamic_cast<const Data<SReal>*>(implicit_euler_of(*this->getContext()).findData("rayleighStiffness"));
        return stiffness ? stiffness->getValue() : 0;
    }

    /// A step begins, for which the part has found its contacts. ownStiffness [s]: the Rayleigh stiffness that takes
    /// back the integrator's, since SOFA multiplies the stiffness by it.
    void openStep(SReal dt, SReal ownStiffness)
    {
        m_dt = dt;
        m_isOpen = true;
        m_ownRayleighStiffness = ownStiffness;
        this->rayleighStiffness.setValue(ownStiffness);
        m_isAccepted = false;
    }

    /// Finds the contacts of the present step anew if a body has changed since they were found: a body may stand behind
    /// them.
    template <class Part>
    void followBodies(const Part& part)
    {
        if (m_isOpen && !this->othersHaveChanged() && !part.is_of_present_bodies())
            this->beginStep(this->getContext()->getTime(), m_dt);
    }

    /// It ends.
    void closeStep()
    {
        m_isOpen = false;
        if (!isOneSided() || m_isWarned) return;
        m_isWarned = true;
        msg_warning(this) << "its linear solver is not a MultigridCGLinearSolver: contacts that pull at the end of a "
                             "step are released after it only";
    }

    template <class Contact>
    void showContact(const Contact& contact)
    {
        d_force.setValue(vec3(contact.force()));
        d_depth.setValue(contact.depth());
        d_touching.setValue(contact.num_touching());
        d_slipping.setValue(contact.num_slipping());
    }

private:
    SReal m_dt = 0;         // of the present step
    bool m_isOpen = false;  // it has begun and not ended
    SReal m_ownRayleighStiffness = 0;
    bool m_isAccepted = true;  // nothing pulls at the end of the present step
    bool m_isWarned = false;   // of a linear solver that does not accept its steps
};

}  // namespace hexaplast::sofa_plugin
