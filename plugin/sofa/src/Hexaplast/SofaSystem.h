// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartComponent.h>
#include <Hexaplast/fields.h>
#include <Hexaplast/releases.h>
#include <sofa/component/linearsolver/iterative/MatrixLinearSolver.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/core/behavior/MultiVec.h>

#include <algorithm>
#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/implicit_euler.hpp"

/// What a linear solver of SOFA is asked to solve, as a system of ours.
namespace hexaplast::sofa_plugin
{

using sofa::component::linearsolver::GraphScatteredMatrix;
using sofa::component::linearsolver::GraphScatteredVector;
using sofa::core::MatricesFactors;
using sofa::core::behavior::BaseForceField;
using sofa::core::behavior::BaseMass;
using sofa::core::objectmodel::BaseContext;

/// The states of a system, one behind the other.
class States
{
public:
    struct Entry
    {
        MechanicalState* state;
        int firstNode, numNodes;
    };

    /// Those below that follow no other.
    explicit States(BaseContext& context)
    {
        for (auto* each : allBelow<sofa::core::behavior::BaseMechanicalState>(context))
        {
            if (followsAnother(*each)) continue;
            auto* state = dynamic_cast<MechanicalState*>(each);
            if (!state)
                throw InputError(
                    "the independent MechanicalObjects in its node and below must be of template Vec3, "
                    "which '" +
                    each->getPathName() + "' is not");
            const int numNodes = static_cast<int>(state->getSize());
            m_entries.push_back({state, m_numNodes, numNodes});
            m_numNodes += numNodes;
        }
        if (m_entries.empty()) throw InputError("there is no MechanicalObject in its node and below");
    }

    int numNodes() const { return m_numNodes; }
    const std::vector<Entry>& entries() const { return m_entries; }
    bool areSeveral() const { return m_entries.size() > 1; }

    const Entry* find(const void* state) const
    {
        for (const Entry& entry : m_entries)
            if (entry.state == state) return &entry;
        return nullptr;
    }

    /// field = of(state) of each; to(state) = field.
    template <class Of>
    PointArray read(const Of& of) const
    {
        PointArray field(m_numNodes, 3);
        for (const Entry& entry : m_entries) rows<Points>(field, entry) = view(of(*entry.state));
        return field;
    }
    template <class To>
    void write(ConstPoints field, const To& to) const
    {
        for (const Entry& entry : m_entries)
        {
            sofa::core::objectmodel::Data<Vec3Types::VecDeriv>& data = to(*entry.state);
            Vec3Types::VecDeriv& values = *data.beginEdit();
            values.resize(static_cast<std::size_t>(entry.numNodes));
            view(values) = rows(field, entry);
            data.endEdit();
        }
    }
    PointArray positions() const
    {
        return read([](const MechanicalState& state) -> auto& { return state.readPositions().ref(); });
    }
    PointArray velocities() const
    {
        return read([](const MechanicalState& state) -> auto& { return state.readVelocities().ref(); });
    }

    /// The rows of a field that belong to a state.
    template <class Field>
    static Field rows(Field field, const Entry& entry)
    {
        return Field(field.middleRows(entry.firstNode, entry.numNodes));
    }

private:
    std::vector<Entry> m_entries;
    int m_numNodes = 0;
};

/// The system m M + b B + k K of a SOFA node as a system of ours, over all states that move by themselves. The kernels
/// work on our bodies, lumped masses and what of ours has a diagonal; what else of ours acts, on a state or between
/// two, is asked for its products beside them, and the rest of SOFA.
class SofaSystem final : public LinearSystem, public Projector, private NodalOperator
{
public:
    /// in, out: vectors of SOFA to work with.
    SofaSystem(BaseContext& context, GraphScatteredMatrix& A, GraphScatteredVector& in, GraphScatteredVector& out)
        : m_context(context), m_states(context), m_A(A), m_in(in), m_out(out)
    {
    }

    int num_nodes() const override { return m_states.numNodes(); }

    void apply(ConstPoints p, Points Ap) const override
    {
        write(p, m_in);
        multiply(m_A.mparams.mFactor(), m_A.mparams.bFactor(), m_A.mparams.kFactor());
        m_A.parent->projectResponse(m_out);
        Ap = read(m_out);
    }

    bool matrix_free(MatrixFreeSystem& system) const override
    {
        findConstraints(system.constraints);
        m_massOfOthers = massesAreLumped() ? 0 : m_A.mparams.mFactor();
        if (m_massOfOthers == 0)
            findDiagonal(system.diagonal);
        else
            system.diagonal.setZero(num_nodes(), 3);

        m_ours.clear();
        bool hasOthers = m_massOfOthers != 0;
        for (BaseForceField* field : allBelow<BaseForceField>(m_context))
        {
            if (dynamic_cast<BaseMass*>(field)) continue;
            auto* forces = dynamic_cast<OurForces*>(field);
            if (forces && !forces->isInMatrix()) continue;
            const auto of = forces ? forces->states() : std::array<MechanicalState*, 2>{};
            const auto *first = m_states.find(of[0]), *second = m_states.find(of[1]);
            if (first && second)
                m_ours.push_back({forces, first, second});
            else
                hasOthers = true;
        }
        for (const States::Entry& entry : m_states.entries())
        {
            if (!m_states.areSeveral())
            {
                addOperators(entry, system);
                continue;
            }
            MatrixFreeSystem part;
            part.wants_levels = system.wants_levels;
            part.diagonal.setZero(entry.numNodes, 3);
            addOperators(entry, part);
            system.add_part(part, entry.firstNode);
        }
        m_products = {};
        m_products.b = m_A.mparams.bFactor();
        m_products.k = m_A.mparams.kFactor();
        for (const Ours& ours : m_ours)
            if (!ours.isInKernels) m_products.of.push_back(ours);
        if (!m_products.of.empty()) system.others.emplace_back(&m_products);
        if (hasOthers && othersAct()) system.others.emplace_back(static_cast<const NodalOperator*>(this));
        return true;
    }

    /// Lets go of what would pull at the end of the step that dv leads to, and adds to b what that changes. Whether
    /// there was anything: then the system is to be solved again.                                     theory.md eq. 41
    bool release(const PointArray& dv, PointArray& b) const
    {
        if (m_A.mparams.bFactor() == 0) return false;  // not a step of implicit Euler, where it is -h
        const double h = -m_A.mparams.bFactor(), ofProduct = m_A.mparams.kFactor() / m_A.mparams.bFactor();
        const PointArray x = m_states.positions(), v = m_states.velocities();
        const PointArray vEnd = v + dv, xEnd = x + h * vEnd;
        PointArray force = PointArray::Zero(num_nodes(), 3), product = force, scratch;
        bool hasReleased = false;
        for (const Ours& ours : m_ours)
        {
            if (!ours.forces->isOneSided()) continue;
            const auto of = [&](const PointArray& all) { return ours.rows<ConstPoints>(all); };
            const bool pulled = ImplicitEuler::release_from(
                force, scratch, [&](Points f) { ours.forces->addOwnForce(of(x), of(v), ours.rows(f)); },
                [&](double sign) { ours.forces->addOwnProduct(0, sign, of(v), ours.rows<Points>(product)); },
                [&] { return ours.forces->release(of(xEnd), of(vEnd)); });
            hasReleased = hasReleased || pulled;
        }
        if (!hasReleased) return false;
        Constraints constraints;
        findConstraints(constraints);
        ImplicitEuler::add_released(h, ofProduct, force, product, constraints, b);
        return true;
    }

    /// The step ends as it was solved: what is solved after it are other systems with its matrix.
    void acceptStep() const
    {
        for (const Ours& ours : m_ours) ours.forces->acceptStep();
    }

    void project(Points field) const override
    {
        write(field, m_out);
        m_A.parent->projectResponse(m_out);
        field = read(m_out);
    }

    PointArray read(GraphScatteredVector& from) const
    {
        return m_states.read([&](MechanicalState & state) -> auto& {
            return state.read(from.id().getId(&state))->getValue();
        });
    }
    void write(ConstPoints field, GraphScatteredVector& to) const
    {
        m_states.write(
            field, [&](MechanicalState & state) -> auto& { return *state.write(to.id().getId(&state)); });
    }
    const States& states() const { return m_states; }

    /// Whether what the constraints leave of a vector is left by them once more.
    bool constraintsProject() const
    {
        PointArray once = irregular_numbers(num_nodes());
        project(once);
        PointArray twice = once;
        project(twice);
        return (twice - once).norm() <= 1e-9 * once.norm();
    }

private:
    /// Acts on a state, or between two.
    struct Ours
    {
        template <class Field>
        Pair<Field> rows(Field ofAll) const
        {
            return {States::rows(ofAll, *first), States::rows(ofAll, *second)};
        }

        OurForces* forces;
        const States::Entry *first, *second;
        bool isInKernels = false;
    };

    /// Force fields of ours that SOFA's products are without while it lives.
    class LeftOut
    {
    public:
        explicit LeftOut(const SofaSystem& system) : m_system(system) { set(true); }
        ~LeftOut() { set(false); }
        LeftOut(const LeftOut&) = delete;

    private:
        void set(bool leftOut)
        {
            for (const Ours& ours : m_system.m_ours) ours.forces->leaveOutOfProducts(leftOut);
        }
        const SofaSystem& m_system;
    };

    /// SOFA's constraints are known by what they do to vectors alone
    /// (BaseProjectiveConstraintSet::projectResponse): here to one of each axis, with a number of its own at every
    /// node, so that no tie is taken for freedom.
    void findConstraints(Constraints& constraints) const
    {
        constraints.reset(num_nodes());
        const PointArray numbers = irregular_numbers(num_nodes());
        for (int axis = 0; axis < 3; ++axis)
        {
            PointArray one = PointArray::Zero(num_nodes(), 3);
            one.col(axis) = numbers.col(axis);
            project(one);
            for (Eigen::Index n = 0; n < one.rows(); ++n)
                if (one(n, axis) == 0)
                    constraints.free(n, axis) = 0;
                else
                    one(n, axis) -= numbers(n, axis);
            if (!one.isZero(0)) constraints.projector = this;
        }
        for (const States::Entry& entry : m_states.entries())
        {
            if (!constraints.projector || !m_states.areSeveral()) return;
            PointArray one = PointArray::Zero(num_nodes(), 3);
            States::rows<Points>(one, entry) = States::rows<ConstPoints>(numbers, entry);
            project(one);
            for (const States::Entry& other : m_states.entries())
                if (&other != &entry && !States::rows<ConstPoints>(one, other).isZero(0))
                    constraints.ties.push_back({entry.firstNode, other.firstNode});
        }
    }

    /// What of ours acts on one state, as far as the kernels know it.
    void addOperators(const States::Entry& entry, MatrixFreeSystem& system) const
    {
        for (Ours& ours : m_ours)
            if (ours.first == &entry && ours.second == &entry)
                ours.isInKernels = ours.forces->addOperator(m_A.mparams.bFactor(), m_A.mparams.kFactor(), system);
    }

    /// F: what the kernels do not know.
    void add_product(double factor, ConstPoints p, Points Fp) const override
    {
        write(p, m_in);
        const LeftOut leftOut(*this);
        multiply(factor * m_massOfOthers, factor * m_A.mparams.bFactor(), factor * m_A.mparams.kFactor());
        for (const States::Entry& entry : m_states.entries())
            States::rows(Fp, entry) += view(entry.state->read(m_out.id().getId(entry.state))->getValue());
    }

    /// Whether the others have an entry at all, as planes that nothing touches have none: a vector without any
    /// regularity has a product then.
    bool othersAct() const
    {
        PointArray product = PointArray::Zero(num_nodes(), 3);
        add_product(1, irregular_numbers(num_nodes()), product);
        return !product.isZero(0);
    }

    /// Whether all masses are lumped, act on the states themselves, and do not damp.
    bool massesAreLumped() const
    {
        const std::vector<BaseMass*> masses = allBelow<BaseMass>(m_context);
        return std::all_of(masses.begin(), masses.end(),
                           [&](BaseMass* mass)
                           {
                               const auto* field =
                                   dynamic_cast<const sofa::core::behavior::ForceField<Vec3Types>*>(mass);
                               const bool damps = mass->rayleighMass.getValue() != 0 && m_A.mparams.bFactor() != 0;
                               return mass->isDiagonal() && !damps && field && m_states.find(field->getMState());
                           });
    }

    /// Diagonal of m M, from the product with a vector of ones.
    void findDiagonal(PointArray& diagonal) const
    {
        write(PointArray::Ones(num_nodes(), 3), m_in);
        multiply(m_A.mparams.mFactor(), 0, 0);
        diagonal = read(m_out);
    }

    /// out = (m M + b B + k K) in. SOFA keeps the factors of the latest call, so that each call gives its own.
    void multiply(double m, double b, double k) const
    {
        m_A.parent->propagateDxAndResetDf(m_in, m_out);
        m_A.parent->addMBKdx(m_out, MatricesFactors::M(m), MatricesFactors::B(b), MatricesFactors::K(k), false);
    }

    /// What the kernels do not know of ours, without the detour through SOFA's vectors.
    struct Products final : NodalOperator
    {
        void add_product(double factor, ConstPoints p, Points Fp) const override
        {
            for (const Ours& ours : of) ours.forces->addOwnProduct(factor * b, factor * k, ours.rows(p), ours.rows(Fp));
        }
        std::vector<Ours> of;
        double b = 0, k = 0;  // factors of df/dv, df/dx
    };

    BaseContext& m_context;
    States m_states;
    GraphScatteredMatrix& m_A;
    GraphScatteredVector &m_in, &m_out;
    mutable std::vector<Ours> m_ours;   ///< on the states: SOFA's products are without them
    mutable Products m_products;        ///< of ours that is not in the kernels
    mutable double m_massOfOthers = 0;  ///< factor of the masses in what the kernels do not know
};

}  // namespace hexaplast::sofa_plugin
