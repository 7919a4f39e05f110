// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/GuestForceField.h>
#include <Hexaplast/registration.h>
#include <sofa/component/linearsolver/iterative/MatrixLinearSolver.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/core/behavior/MultiVec.h>
#include <sofa/simulation/MechanicalOperations.h>

#include <algorithm>
#include <cmath>

#include "attributes/hexaplast.hpp"
#include "hexaplast/base/linear_system.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

using sofa::component::linearsolver::GraphScatteredMatrix;
using sofa::component::linearsolver::GraphScatteredVector;
using sofa::core::MatricesFactors;
using sofa::core::behavior::BaseForceField;
using sofa::core::behavior::BaseMass;
using sofa::core::objectmodel::BaseContext;

/// The system m M + b B + k K of a SOFA node as a system of ours. Where it consists of one body, lumped masses, loads
/// without stiffness and constraints on coordinates, the kernels work on it; anything else is asked of SOFA product by
/// product.
class SofaSystem final : public LinearSystem
{
public:
    /// in, out: vectors of SOFA to work with.
    SofaSystem(BaseContext& context, MechanicalState& state, GraphScatteredMatrix& A, GraphScatteredVector& in,
               GraphScatteredVector& out)
        : m_context(context), m_state(state), m_A(A), m_in(in), m_out(out)
    {
    }

    int num_nodes() const override { return static_cast<int>(m_state.getSize()); }

    void apply(ConstPoints p, Points Ap) const override
    {
        write(p, m_in);
        multiply(m_A.mparams.mFactor(), m_A.mparams.bFactor(), m_A.mparams.kFactor());
        m_A.parent->projectResponse(m_out);
        Ap = read(m_out);
    }

    void assemble(BlockMatrix&) const override
    {
        throw InputError("MultigridCGLinearSolver asks for products, not for a matrix");
    }

    bool to_kernels(KernelSystem& system) const override
    {
        system.double_operator = nullptr;
        system.single_operator = nullptr;
        if (!find_masses() || !find_free(system.free)) return false;
        find_diagonal(system.diagonal);

        std::vector<BaseForceField*> fields;
        m_context.get<BaseForceField>(&fields, BaseContext::SearchDown);
        for (BaseForceField* field : fields)
        {
            if (dynamic_cast<BaseMass*>(field) || has_no_stiffness(*field)) continue;
            auto* ours = dynamic_cast<GuestForceField*>(field);
            if (!ours || !ours->guest() || ours->getMState() != &m_state) return false;
            const double factor = m_A.mparams.kFactor() + m_A.mparams.bFactor() * ours->rayleighStiffness.getValue();
            if (!ours->guest()->to_kernels(factor, system)) return false;
            ours->guest()->add_damping_diagonal(m_A.mparams.bFactor(), system.diagonal);
        }
        return system.double_operator || system.single_operator;
    }

    PointArray read(GraphScatteredVector& from) const
    {
        return view(m_state.read(from.id().getId(&m_state))->getValue());
    }
    void write(ConstPoints field, GraphScatteredVector& to) const
    {
        auto* data = m_state.write(to.id().getId(&m_state));
        view(*data->beginEdit()) = field;
        data->endEdit();
    }

private:
    /// Loads that SOFA's scenes prescribe.
    static bool has_no_stiffness(const BaseForceField& field)
    {
        const std::string name = field.getClassName();
        return name == "ConstantForceField" || name == "LinearForceField";
    }

    /// Whether all masses are lumped, act on this state, and do not damp by themselves.
    bool find_masses() const
    {
        std::vector<BaseMass*> masses;
        m_context.get<BaseMass>(&masses, BaseContext::SearchDown);
        return std::all_of(masses.begin(), masses.end(),
                           [&](BaseMass* mass)
                           {
                               const auto* field =
                                   dynamic_cast<const sofa::core::behavior::ForceField<DataTypes>*>(mass);
                               const bool damps = mass->rayleighMass.getValue() != 0 && m_A.mparams.bFactor() != 0;
                               return mass->isDiagonal() && !damps && field && field->getMState() == &m_state;
                           });
    }

    /// 1 where a degree of freedom is free, 0 where it is fixed; false where constraints couple coordinates or nodes.
    /// Asked with a number of its own for every entry: equal ones lie in some oblique planes.
    bool find_free(PointArray& free) const
    {
        constexpr double golden_ratio = 1.6180339887498949;  // its multiples have no regularity modulo 1
        PointArray numbers(num_nodes(), 3);
        for (Eigen::Index i = 0; i < numbers.size(); ++i)
            numbers.data()[i] = 0.5 + std::fmod(static_cast<double>(i + 1) * golden_ratio, 1.0);
        write(numbers, m_out);
        m_A.parent->projectResponse(m_out);
        const PointArray projected = read(m_out);
        free = (projected.array() == numbers.array()).cast<double>();
        return (projected.array() == free.array() * numbers.array()).all();
    }

    /// Diagonal of m M, from the product with a vector of ones.
    void find_diagonal(PointArray& diagonal) const
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

    BaseContext& m_context;
    MechanicalState& m_state;
    GraphScatteredMatrix& m_A;
    GraphScatteredVector &m_in, &m_out;
};

class MultigridCGLinearSolver final
    : public sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>
{
public:
    using Inherit = sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>;
    SOFA_CLASS(MultigridCGLinearSolver, SOFA_TEMPLATE2(sofa::component::linearsolver::MatrixLinearSolver,
                                                       GraphScatteredMatrix, GraphScatteredVector));

    void init() override
    {
        Inherit::init();
        m_guest.reset();
        attempt(*this,
                [&] { m_guest.emplace(*this, attributes::kMultigridCGLinearSolver, m_attributes, nullptr, nullptr); });
    }
    void reinit() override { init(); }

    void solve(GraphScatteredMatrix& A, GraphScatteredVector& x, GraphScatteredVector& b) override
    {
        if (!may_step(*this) || !m_guest) return;
        typename Inherit::TempVectorContainer vectors(this, sofa::core::execparams::defaultInstance(), A, x, b);
        const std::unique_ptr<GraphScatteredVector> in(vectors.createTempVector()), out(vectors.createTempVector());
        attempt(*this,
                [&]
                {
                    const SofaSystem system(*getContext(), onlyState(), A, *in, *out);
                    PointArray solution(system.num_nodes(), 3);
                    const SolveReport report =
                        m_guest->as<scene::LinearSolver>().method().solve(system, system.read(b), solution);
                    system.write(solution, x);
                    if (!report.converged)
                        msg_warning() << "stopped after " << report.iterations
                                      << " iterations with |r| / |b| = " << report.residual;
                });
    }

protected:
    MultigridCGLinearSolver() : m_attributes(*this, attributes::kMultigridCGLinearSolver) {}

private:
    /// The one state below that follows no other.
    MechanicalState& onlyState()
    {
        std::vector<sofa::core::behavior::BaseMechanicalState*> states;
        getContext()->get<sofa::core::behavior::BaseMechanicalState>(&states, BaseContext::SearchDown);
        MechanicalState* found = nullptr;
        for (auto* state : states)
        {
            if (state->getContext()->get<sofa::core::BaseMapping>(BaseContext::Local)) continue;
            if (found || !dynamic_cast<MechanicalState*>(state))
                throw InputError(
                    "there must be one independent MechanicalObject, of template Vec3, in its node and below");
            found = dynamic_cast<MechanicalState*>(state);
        }
        if (!found) throw InputError("there is no MechanicalObject in its node and below");
        return *found;
    }

    AttributeData m_attributes;
    std::optional<Guest> m_guest;
};

}  // namespace

void register_solver(sofa::core::ObjectFactory* factory)
{
    register_component<MultigridCGLinearSolver>(factory, attributes::kMultigridCGLinearSolver);
}

}  // namespace hexaplast::sofa_plugin
