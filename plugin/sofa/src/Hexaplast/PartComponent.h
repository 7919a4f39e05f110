// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/dependencies.h>
#include <Hexaplast/SavedState.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/table.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/AnimateEndEvent.h>
#include <sofa/simulation/IntegrateBeginEvent.h>

#include <iosfwd>
#include <optional>

namespace hexaplast::sofa_plugin
{

/// A force field of SOFA that is made from a part: between SOFA's calls, in its order, and those of the part. Data that
/// change during a simulation take effect at the beginning of the next step, or by reinit: SOFA's update callbacks
/// would be called within a step, by whoever asks for the state of the component first.
template <class TBase>
class PartComponent : public TableComponent<TBase>
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(PartComponent, TBase), SOFA_TEMPLATE(TableComponent, TBase));

    // What flowed stays: the part follows the Data as it would at the beginning of the next step.
    void reinit() override
    {
        if (!hasPart()) return initPart();
        m_inputs->haveChanged();
        othersHaveChanged();
        takeData();
    }

    void reset() override
    {
        if (!hasPart()) return;
        // a step that was lost is forgotten, Data that were refused are not
        if (m_dataAreAccepted) this->d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
        attempt(*this,
                [&]
                {
                    resetPart();
                    m_state.takeFirst([this](std::istream& in) { loadPart(in); });
                });
    }

    void handleEvent(sofa::core::objectmodel::Event* event) override
    {
        if (sofa::simulation::AnimateBeginEvent::checkEventType(event))
        {
            m_numIntegrations = 0;
            if (!hasPart() && !isInvalid(*this)) this->bwdInit();  // it was added during the run
            const bool ownHaveChanged = hasPart() && m_inputs->haveChanged(),
                       othersHave = hasPart() && othersHaveChanged();
            if (ownHaveChanged || othersHave || (hasPart() && m_state.isGiven())) takeData();
            if (!mayStep(*this) || !hasPart()) return;
            const SReal dt = static_cast<sofa::simulation::AnimateBeginEvent*>(event)->getDt();
            m_dt = dt;
            attempt(*this, [&] { beginStep(this->getContext()->getTime(), dt); });
        }
        else if (sofa::simulation::IntegrateBeginEvent::checkEventType(event))
        {
            if (works() && ++m_numIntegrations > 1) attempt(*this, [&] { refuseIntegrations(); });
        }
        else if (works() && sofa::simulation::AnimateEndEvent::checkEventType(event))
        {
            const SReal dt = static_cast<sofa::simulation::AnimateEndEvent*>(event)->getDt();
            attempt(*this, [&] { endStep(dt); });
            m_state.hasChanged();
        }
    }

    /// One that has been given to it in place of what it keeps, before the next step would.
    void takeGivenState()
    {
        if (hasPart() && m_state.isGiven()) takeData();
    }

    virtual bool hasPart() const = 0;

    /// Whether it has a part, and no error.
    bool works() const { return hasPart() && !isInvalid(*this); }

    /// For MultigridCGLinearSolver: whether there are derivatives at the latest forces.
    virtual bool isInMatrix() const { return true; }

    /// For the same solver: whether the part has forces that would pull at the end of the present step. It tries an
    /// end, and asks the part to let go of what pulls there, until nothing does, or for as often as it likes.
    virtual bool isOneSided() const { return false; }
    virtual void acceptStep() {}  ///< the step ends as it has been tried

    /// [s] that the stiffness is multiplied by for velocities, beside that of the integrator.
    double wholeRayleighStiffness() const { return this->rayleighStiffness.getValue() + ownRayleighStiffness(); }

    /// From now on addDForce adds nothing: a solver of ours has the stiffness by other ways.
    void leaveOutOfProducts(bool leftOut) { m_isLeftOut = leftOut; }

protected:
    /// description: of the attributes that it has as Data. makesData: as of TableComponent.
    explicit PartComponent(const Description& description, bool makesData = true)
        : TableComponent<TBase>(description, "", makesData)
    {
        this->f_listening.setValue(true);
    }

    /// Makes the part and begins to look at the Data.
    virtual void initPart()
    {
        acceptData([&] { makePart(); });
        m_inputs.emplace(*this, this->description());
        m_inputs->add(this->rayleighStiffness);
        if (works()) attempt(*this, [&] { m_state.takeFirst([this](std::istream& in) { loadPart(in); }, true); });
    }

    virtual void checkRayleighStiffness() const  ///< OptionError where it is not allowed
    {
        parts::check_range("rayleighStiffness", attributes::kNotNegative, this->rayleighStiffness.getValue());
    }

    virtual void makePart() = 0;    ///< from the Data; what was there goes
    virtual void updatePart() = 0;  ///< by Data that have changed
    /// Whether what the part is made from in other components has changed since this was asked last.
    virtual bool othersHaveChanged() { return false; }
    virtual void resetPart() {}
    virtual void beginStep(SReal /*time*/, SReal /*dt*/) {}
    virtual void endStep(SReal /*dt*/) {}
    virtual void refuseIntegrations() const {}           ///< InputError where there must be one in a step
    virtual void savePart(std::ostream& out) const = 0;  ///< what it keeps from step to step
    virtual void loadPart(std::istream& in) = 0;         ///< InputError for what cannot be that

    bool isLeftOut() const { return m_isLeftOut; }

    /// [s] in the present step: minus that of the integrator, where it is not to act on the part.
    virtual double ownRayleighStiffness() const { return 0; }

    /// What makes of SOFA's factor of a stiffness in a matrix, -h (h + r) - h times the Data rayleighStiffness, that
    /// with the whole of it.
    double matrixScale() const
    {
        const double whole = m_dt + this->rayleighStiffness.getValue(), own = ownRayleighStiffness();
        return own == 0 ? 1 : whole / (whole - own);
    }

    Inputs& inputs() { return *m_inputs; }  ///< once it has been initialised

private:
    /// Lets `call` make or change the part by the Data. Where it came through the component is valid; else what is
    /// wrong with the Data is said, all at once.
    template <class Call>
    void acceptData(const Call& call)
    {
        m_dataAreAccepted = acceptDataOf(
            *this, [&] { checkRayleighStiffness(); }, call);
    }

    void takeData()
    {
        const auto load = [this](std::istream& in) { loadPart(in); };
        if (m_state.isGiven() && !attempt(*this, [&] { m_state.take(load); })) return;
        acceptData([&] { updatePart(); });
    }

    SavedState m_state{*this, [this](std::ostream& out)
                       {
                           if (hasPart()) savePart(out);
                       }};
    std::optional<Inputs> m_inputs;
    SReal m_dt = 0;  ///< of the present step
    int m_numIntegrations = 0;
    bool m_dataAreAccepted = false;
    bool m_isLeftOut = false;
};

}  // namespace hexaplast::sofa_plugin
