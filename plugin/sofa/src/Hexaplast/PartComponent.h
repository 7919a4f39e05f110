// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/SavedState.h>
#include <Hexaplast/dependencies.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/fields.h>
#include <Hexaplast/matrices.h>
#include <Hexaplast/table.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/AnimateEndEvent.h>
#include <sofa/simulation/IntegrateBeginEvent.h>

#include <array>
#include <iosfwd>
#include <optional>

#include "hexaplast/layout/linear_system.hpp"
#include "parts/force.hpp"

namespace hexaplast::sofa_plugin
{

/// The forces of a part on a state, or between two, as MultigridCGLinearSolver asks for them without the detour through
/// SOFA's vectors. Fields are those of both states, of one state the same twice.
class OurForces
{
public:
    virtual ~OurForces() = default;

    virtual std::array<MechanicalState*, 2> states() const = 0;

    /// Whether there is a part, and no error; and derivatives at the latest forces.
    virtual bool works() const = 0;
    bool isInMatrix() const { return works() && forces().is_in_matrix(); }

    /// f += forces, df += (b B + k K) dx.
    virtual void addOwnForce(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) = 0;
    void addOwnProduct(double b, double k, const Pair<ConstPoints>& dx, Pair<Points> df) const
    {
        forces().add_stiffness_product(k + b * wholeRayleighStiffness(), dx, df);
        if (b != 0) forces().add_damping_product(b, dx, df);
    }

    /// The same of one state for the kernels; false, and nothing added, where they cannot express it.
    bool addOperator(double b, double k, MatrixFreeSystem& system) const
    {
        if (!addStiffness(k + b * wholeRayleighStiffness(), system)) return false;
        forces().add_damping_diagonal(b, system.diagonal);
        return true;
    }

    /// Whether the part has forces that would pull at the end of the present step. The solver tries an end, and asks
    /// the part to let go of what pulls there, until nothing does, or for as often as it likes.
    virtual bool isOneSided() const { return false; }
    bool release(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v) { return forces().release(x, v); }
    virtual void acceptStep() {}  ///< the step ends as it has been tried

    /// From now on addDForce adds nothing: a solver of ours has the stiffness by other ways.
    void leaveOutOfProducts(bool leftOut) { m_isLeftOut = leftOut; }

protected:
    virtual parts::Force& forces() const = 0;  ///< of the part, where there is one

    /// [s] that the stiffness is multiplied by for velocities, beside that of the integrator.
    virtual double wholeRayleighStiffness() const = 0;
    virtual bool addStiffness(double factor, MatrixFreeSystem& system) const
    {
        return forces().add_stiffness_diagonal(factor, system.diagonal);
    }
    bool isLeftOut() const { return m_isLeftOut; }

private:
    bool m_isLeftOut = false;
};

/// SOFA's vector to add to, where it has fewer nodes with as many as another one.
inline auto grown(Data<Vec3Types::VecDeriv>& f, const Data<Vec3Types::VecDeriv>& other)
{
    const auto numNodes = other.getValue().size();
    if (f.getValue().size() < numNodes) sofa::helper::getWriteAccessor(f).resize(numNodes);
    return sofa::helper::getWriteAccessor(f);
}

/// A force field of SOFA that is made from a part: between SOFA's calls, in its order, and those of the part. Data that
/// change during a simulation take effect at the beginning of the next step, or by reinit: SOFA's update callbacks
/// would be called within a step, by whoever asks for the state of the component first.
template <class TBase>
class PartComponent : public TableComponent<TBase>, public OurForces
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

    bool works() const override { return hasPart() && !isInvalid(*this); }

    void addOwnForce(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) override
    {
        beforeForces();
        forces().add_force(this->getContext()->getTime(), x, v, f);
    }

    void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix* matrix) override
    {
        const auto addTo = [&](std::array<int, 2> first)
        { forces().add_stiffness_blocks(matrixScale(), m_stiffness, first); };
        addBlocks(m_stiffness, addTo,
                  [&](auto* of, auto* by) { return matrix->getForceDerivativeIn(of).withRespectToPositionsIn(by); });
    }
    void buildDampingMatrix(sofa::core::behavior::DampingMatrix* matrix) override
    {
        const auto addTo = [&](std::array<int, 2> first) { forces().add_damping_blocks(1, m_damping, first); };
        addBlocks(m_damping, addTo,
                  [&](auto* of, auto* by) { return matrix->getForceDerivativeIn(of).withRespectToVelocityIn(by); });
    }

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

    virtual void beforeForces() {}  ///< are computed

    /// [s] in the present step: minus that of the integrator, where it is not to act on the part.
    double ownRayleighStiffness() const { return hasPart() ? forces().rayleigh_stiffness() : 0; }
    double wholeRayleighStiffness() const override
    {
        return this->rayleighStiffness.getValue() + ownRayleighStiffness();
    }

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

    /// Lets addTo(first) add to the blocks: of the nodes of the first state, from `first` on those of the second one,
    /// or of one state with itself. Adds them to SOFA's derivatives of the forces on one state by what another does.
    template <class AddTo, class Derivative>
    void addBlocks(BlockMatrix& blocks, const AddTo& addTo, const Derivative& derivative)
    {
        if (!works()) return;
        const std::array of = states();
        const std::size_t numStates = of[0] == of[1] ? 1 : 2;
        const int numFirst = static_cast<int>(of[0]->getSize());
        const std::array ranges = {NodeRange{0, numFirst},
                                   NodeRange{numFirst, numStates == 1 ? 0 : static_cast<int>(of[1]->getSize())}};
        clear(blocks, numFirst + ranges[1].count);
        attempt(*this,
                [&]
                {
                    addTo({0, numStates == 1 ? 0 : numFirst});
                    blocks.drop_unused();  // contacts are others in each step
                    for (std::size_t k = 0; k < numStates; ++k)
                        for (std::size_t l = 0; l < numStates; ++l)
                            add(blocks, ranges[k], ranges[l], derivative(of[k], of[l]));
                });
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
    BlockMatrix m_stiffness, m_damping;
};

}  // namespace hexaplast::sofa_plugin
