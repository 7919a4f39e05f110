// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ForceOf.h>
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/component/odesolver/backward/EulerImplicitSolver.h>
#include <sofa/core/behavior/OdeSolver.h>
#include <sofa/core/visual/VisualParams.h>

#include <algorithm>
#include <sstream>

#include "hexaplast/contact/contact_terms.hpp"
#include "parts/contact_options.hpp"

namespace hexaplast::sofa_plugin
{

using BodyField = HexahedronElastoplasticFEMForceField;
using sofa::component::odesolver::backward::EulerImplicitSolver;

/// The field of a scene whose body has its nodes in `state`; InputError where there is none.
inline BodyField& bodyFieldOf(const sofa::core::behavior::BaseMechanicalState& state,
                              const sofa::core::objectmodel::BaseContext& context)
{
    for (BodyField* field : allBelow<BodyField>(*context.getRootContext()))
    {
        if (field->getMState() != &state) continue;
        if (!field->works()) throw InputError("its body '" + field->getName() + "' is invalid (see its error above)");
        if (followsAnother(state))
            throw InputError("its state '" + state.getName() +
                             "' follows another one: must be one that an integrator moves");
        return *field;
    }
    throw InputError("no body on its state '" + state.getName() + "': contact is that of a body's surface");
}

/// The EulerImplicitSolver that moves what is in a context; InputError for any other.
inline const EulerImplicitSolver& implicitEulerOf(const sofa::core::objectmodel::BaseContext& context)
{
    const auto* integrator = context.get<sofa::core::behavior::OdeSolver>();
    const auto* euler = dynamic_cast<const EulerImplicitSolver*>(integrator);
    const std::string lacks = parts::integrator_lacks(
        euler        ? "EulerImplicitSolver"
        : integrator ? integrator->getClassName()
                     : "",
        [&](std::string_view scheme)
        { return scheme == "firstOrder" ? euler->d_firstOrder.getValue() : euler->d_trapezoidalScheme.getValue(); },
        "in its node or above");
    if (!lacks.empty()) throw InputError(lacks);
    return *euler;
}

inline constexpr float kContactPointSize = 5, kContactForceWidth = 2;  // [pixels]
inline constexpr double kLongestForce = 0.1;                           // of the body's size

/// The points that touch, red where they slip, and the forces on the first body as lines from there. scale: [m/N]; 0:
/// so that the greatest force is a tenth of the body's size.
inline void drawContactTerms(sofa::helper::visual::DrawTool& tool, const ContactTerms& contacts,
                             const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, double scale)
{
    if (contacts.empty() || x.first.rows() == 0) return;
    std::vector<Vec3> forces;
    double greatest = 0;
    for (const ContactTerm& term : contacts.terms)
    {
        forces.push_back(term.force(term.at(x), term.at(v)));
        greatest = std::max(greatest, forces.back().norm());
    }
    const Vec3 extent = (x.first.colwise().maxCoeff() - x.first.colwise().minCoeff()).transpose();
    if (scale == 0 && greatest > 0) scale = kLongestForce * extent.norm() / greatest;

    std::vector<sofa::type::Vec3> stick, slip, ends;
    for (std::size_t i = 0; i < forces.size(); ++i)
    {
        const Vec3 place = contacts.terms[i].place_on_first(x.first);
        (contacts.terms[i].slips ? slip : stick).push_back(vec3(place));
        ends.push_back(vec3(place));
        ends.push_back(vec3(Vec3(place + scale * forces[i])));
    }
    tool.disableLighting();
    if (!stick.empty()) tool.drawPoints(stick, kContactPointSize, sofa::type::RGBAColor::green());
    if (!slip.empty()) tool.drawPoints(slip, kContactPointSize, sofa::type::RGBAColor::red());
    tool.drawLines(ends, kContactForceWidth, sofa::type::RGBAColor::yellow());
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
        const std::array states = this->states();
        if (!states[0] || !states[1])
            throw InputError("needs object1, and object2 where it is another one: the MechanicalObjects of two bodies");
        const std::array fields = {&bodyFieldOf(*states[0], *this->getContext()),
                                   &bodyFieldOf(*states[1], *this->getContext())};
        const auto& integrator = implicitEulerOf(*this->getContext());
        for (std::size_t k = 0; k < Part::kNumStates; ++k)
            if (states[k]->getContext()->template get<sofa::core::behavior::OdeSolver>() != &integrator)
                throw parts::OptionError(
                    k == 0 ? "object1" : "object2",
                    "leads to '" + states[k]->getPathName() +
                        "', which another integrator moves: bodies that touch need one EulerImplicitSolver and one "
                        "linear solver in a node above both, and the contact stands below it");
        m_fields = {fields[0], fields[1]};
        m_bodies = {fields[0]->part(), fields[1]->part()};
        return {.bodies = {fields[0]->body(), fields[1]->body()}};
    }

    void checkRayleighStiffness() const override
    {
        const SReal given = this->rayleighStiffness.getValue();
        if (given == 0) return;
        std::ostringstream reason;
        reason << "= " << given
               << ": must not be given, as the Rayleigh stiffness of the integrator does not act on contact. damping "
                  "damps it";
        throw parts::OptionError("rayleighStiffness", reason.str());
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
        const std::vector<BodyField*> present = allBelow<BodyField>(*this->getContext()->getRootContext());
        const auto isAsItWas = [&](const sofa::core::sptr<BodyField>& field, const auto& body) {
            return std::count(present.begin(), present.end(), field.get()) > 0 && field->works() &&
                   field->part() == body;
        };
        return !isAsItWas(m_fields[0], m_bodies[0]) || !isAsItWas(m_fields[1], m_bodies[1]);
    }
    void resetPart() override
    {
        if (othersHaveChanged()) this->makePart();
        acceptStep();
        Inherit::resetPart();
    }

    void beginStep(SReal time, SReal dt) override
    {
        prescribe(dt);
        const SReal ofIntegrator = implicitEulerOf(*this->getContext()).d_rayleighStiffness.getValue();
        this->beginPart({.time = time, .dt = dt, .rayleigh_stiffness = ofIntegrator});
        m_dt = dt;
        m_isOpen = true;
        m_isAccepted = false;
    }
    void refuseIntegrations() const override
    {
        throw InputError(
            "its integrator takes several steps within one: contacts are found once, so that MultiStepAnimationLoop "
            "needs collisionSteps = 1 and integrationSteps = 1");
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
        drawContactTerms(tool, this->m_part->terms(), this->positions(),
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

    std::array<sofa::core::sptr<BodyField>, 2> m_fields;  ///< of the bodies that touch; of one state, the same twice
    std::array<std::shared_ptr<const parts::HexahedralBody>, 2> m_bodies;  ///< that the part refers to
    SReal m_dt = 0;                                                        ///< of the present step
    bool m_isOpen = false;                                                 ///< it has begun and not ended
    bool m_isAccepted = true;  ///< nothing pulls at the end of the present step
    bool m_isWarned = false;   ///< of a linear solver that does not accept its steps
    bool m_hasWarnedOfPair = false;
};

}  // namespace hexaplast::sofa_plugin
