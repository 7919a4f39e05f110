// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ForceOf.h>
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/contact_drawing.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/OdeSolver.h>

#include <algorithm>

#include "parts/contact_options.hpp"

namespace hexaplast::sofa_plugin
{

using BodyField = HexahedronElastoplasticFEMForceField<Vec3Types>;

/// The field whose body has its nodes in `state`; InputError where there is none.
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

/// A contact of bodies. Contacts are found at AnimateBeginEvent, anchors follow at AnimateEndEvent.
template <class Part>
class ContactOf : public ForceOf<Part>
{
public:
    using Inherit = ForceOf<Part>;
    SOFA_CLASS(SOFA_TEMPLATE(ContactOf, Part), Inherit);

    Data<SReal> d_drawForceScale{this->initData(&d_drawForceScale, SReal(0), "drawForceScale",
                                                "Length of a force that is drawn [m/N]. 0: the greatest one has a "
                                                "tenth of the size of the body.")};

    // Bodies and integrators may be declared later: it is made when all of them have had their init.
    void init() override
    {
        this->m_part.reset();
        if constexpr (Part::kNumStates == 2) Inherit::init();
    }
    void bwdInit() override
    {
        Inherit::bwdInit();
        this->initPart();
        if (!this->works()) return;
        attempt(*this,
                [&]
                {
                    prescribe(0);
                    this->m_part->look_at_start(this->getContext()->getTime(), this->positions());
                });
        this->sayWarnings();
        warnOfSamePair();
    }

    void draw(const sofa::core::visual::VisualParams* vparams) override
    {
        if (!this->works() || !vparams->displayFlags().getShowForceFields()) return;
        auto* tool = vparams->drawTool();
        const auto lifeCycle = tool->makeStateLifeCycle();
        drawContacts(*tool);
    }

    bool isOneSided() const override { return !m_isAccepted && this->isInMatrix(); }
    void acceptStep() override { m_isAccepted = true; }

protected:
    explicit ContactOf(const Description& description = Part::description()) : Inherit(description) {}

    /// Tells the part of a motion that it does not find out itself, in a step of dt.
    virtual void prescribe(SReal /*dt*/) {}

    parts::Surroundings surroundings() override
    {
        m_bodyFields = {};
        const std::array states = this->states();
        if (!states[0] || !states[1])
            throw InputError("needs object1, and object2 where it is another one: the MechanicalObjects of two bodies");
        const std::array fields = {&body_field_of(*states[0]), &body_field_of(*states[1])};
        const auto& integrator = implicit_euler_of(*this->getContext());
        for (std::size_t k = 0; k < Part::kNumStates; ++k)
            if (states[k]->getContext()->template get<sofa::core::behavior::OdeSolver>() != &integrator)
                throw parts::OptionError(
                    k == 0 ? "object1" : "object2",
                    fmt::format("leads to '{}', which another integrator moves: bodies that touch need one "
                                "EulerImplicitSolver and one linear solver in a node above both, and the contact "
                                "stands below it",
                                states[k]->getPathName()));
        m_bodyFields = fields;
        m_bodiesMade = {fields[0]->timesMade(), fields[1]->timesMade()};
        return {.bodies = {fields[0]->body(), fields[1]->body()}};
    }

    void checkRayleighStiffness() const override
    {
        if (const SReal given = this->rayleighStiffness.getValue(); given != m_ownRayleighStiffness)
            throw parts::OptionError("rayleighStiffness",
                                     fmt::format("= {}: must not be given, as the Rayleigh stiffness of the integrator "
                                                 "does not act on contact. damping damps it",
                                                 given));
    }

    void makePart() override
    {
        Inherit::makePart();
        acceptStep();
    }
    void updatePart() override
    {
        if (othersHaveChanged()) return this->makePart();
        Inherit::updatePart();
        warnOfSamePair();
    }
    bool othersHaveChanged() override
    {
        return m_bodiesMade[0] != m_bodyFields[0]->timesMade() || m_bodiesMade[1] != m_bodyFields[1]->timesMade();
    }
    void resetPart() override
    {
        if (othersHaveChanged()) this->makePart();
        acceptStep();
        Inherit::resetPart();
    }

    /// SOFA multiplies the stiffness by the Rayleigh stiffness of the integrator: an own one takes that back.
    void beginStep(SReal time, SReal dt) override
    {
        prescribe(dt);
        const auto* given =
            dynamic_cast<const Data<SReal>*>(implicit_euler_of(*this->getContext()).findData("rayleighStiffness"));
        this->beginPart({.time = time, .dt = dt, .rayleigh_stiffness = given ? given->getValue() : 0});
        m_dt = dt;
        m_isOpen = true;
        m_ownRayleighStiffness = this->m_part->rayleigh_stiffness();
        this->rayleighStiffness.setValue(m_ownRayleighStiffness);
        m_isAccepted = false;
    }
    void endStep(SReal dt) override
    {
        m_isOpen = false;
        if (isOneSided() && !std::exchange(m_isWarned, true))
            msg_warning(this) << "its linear solver is not a MultigridCGLinearSolver: contacts that pull at the end of "
                                 "a step are released after it only";
        Inherit::endStep(dt);
    }

    /// Finds the contacts of the present step anew if a body has changed since they were found: a body may be declared
    /// later.
    void beforeForces() override
    {
        if (m_isOpen && !othersHaveChanged() && !this->m_part->is_of_present_bodies())
            this->beginStep(this->getContext()->getTime(), m_dt);
    }

    void drawContacts(sofa::helper::visual::DrawTool& tool) const
    {
        const std::array states = this->states();
        draw_contacts(tool, this->m_part->terms(), this->positions(),
                      {view(states[0]->readVelocities().ref()), view(states[1]->readVelocities().ref())},
                      d_drawForceScale.getValue());
    }

private:
    /// Once, of another active contact between the same bodies that was there before.
    void warnOfSamePair()
    {
        if constexpr (Part::kNumStates == 2)
        {
            if (m_hasWarnedOfPair || !this->m_part->is_active()) return;
            std::vector<ContactOf*> all;
            this->getContext()->getRootContext()->template get<ContactOf>(
                &all, sofa::core::objectmodel::BaseContext::SearchDown);
            for (const ContactOf* other : all)
            {
                const std::array own = this->states(), others = other->states();
                if (other == this || !other->works() || other->m_hasWarnedOfPair || !other->m_part->is_active() ||
                    !std::is_permutation(own.begin(), own.end(), others.begin()))
                    continue;
                m_hasWarnedOfPair = true;
                this->m_part->warn_of_same_pair(other->getName());
                return this->sayWarnings();
            }
        }
    }

    std::array<BodyField*, 2> m_bodyFields = {};  // of one state: the same twice
    std::array<int, 2> m_bodiesMade = {};         // which of the bodies that these fields have made
    SReal m_dt = 0;                               // of the present step
    bool m_isOpen = false;                        // it has begun and not ended
    SReal m_ownRayleighStiffness = 0;
    bool m_isAccepted = true;  // nothing pulls at the end of the present step
    bool m_isWarned = false;   // of a linear solver that does not accept its steps
    bool m_hasWarnedOfPair = false;
};

}  // namespace hexaplast::sofa_plugin
