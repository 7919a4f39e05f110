// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/FollowsNodes.h>
#include <Hexaplast/SavedState.h>
#include <Hexaplast/SofaSystem.h>
#include <Hexaplast/dependencies.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <sofa/component/constraint/lagrangian/correction/LinearSolverConstraintCorrection.h>
#include <sofa/component/linearsolver/iterative/MatrixLinearSolver.h>
#include <sofa/core/ConstraintParams.h>
#include <sofa/linearalgebra/BaseVector.h>
#include <sofa/linearalgebra/SparseMatrix.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/MechanicalOperations.h>
#include <sofa/simulation/mechanicalvisitor/MechanicalGetConstraintJacobianVisitor.h>

#include <algorithm>
#include <optional>

#include "attributes/parts.hpp"
#include "hexaplast/solve/compliance.hpp"
#include "hexaplast/solve/implicit_euler.hpp"
#include "parts/multigrid_cg.hpp"
#include "parts/spread_nodes.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

constexpr double kOfMultipliers = 1e-3;  // tolerance of motions that belong to the multipliers of constraints

using Jacobian = sofa::linearalgebra::SparseMatrix<SReal>;

/// The rows of a Jacobian of SOFA that have entries, and which they are.
struct ConstraintRows
{
    explicit ConstraintRows(const Jacobian& J)
    {
        for (const auto& [number, line] : J)
        {
            if (line.empty()) continue;
            numbers.push_back(number);
            ConstraintRow& row = rows.emplace_back();
            for (const auto& [column, value] : line)
            {
                const int node = static_cast<int>(column / 3);
                if (row.empty() || row.back().first != node) row.emplace_back(node, Vec3::Zero());
                row.back().second[column % 3] += value;
            }
        }
    }
    std::vector<Jacobian::Index> numbers;
    std::vector<ConstraintRow> rows;
};

}  // namespace

/// Preconditioned conjugate gradients that end when the answer is as good as asked for. SOFA's constraint corrections
/// ask it for J A^-1 J^T, and for the motion that belongs to multipliers.
class MultigridCGLinearSolver final
    : public TableComponent<
          sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>>,
      public FollowsNodes
{
public:
    using Inherit = sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>;
    SOFA_CLASS(MultigridCGLinearSolver, SOFA_TEMPLATE(TableComponent, Inherit));

    /// SOFA's constraint corrections refuse solvers that are called GraphScattered, as of its own ones none has
    /// J A^-1 J^T, and they ask for nothing but this name (v26.06: GenericConstraintCorrection.cpp, line 83, and
    /// LinearSolverConstraintCorrection.inl, line 90).
    static std::string GetCustomTemplateName() { return "MatrixFree"; }

    void init() override
    {
        Inherit::init();
        m_constraintsAreChecked = false;
        m_inputs.emplace(*this, description());
        make();
        forget();
    }
    void bwdInit() override
    {
        Inherit::bwdInit();
        attempt(*this, [&] { refuseUnbuiltConstraints(); });
        takeFirstState();
    }
    void reinit() override
    {
        init();
        attempt(*this, [&] { refuseUnbuiltConstraints(); });
    }

    // A step that was lost is forgotten, Data that were refused are not.
    void reset() override
    {
        forget();
        if (!m_solver) return;
        attempt(*this, [&] { refuseUnbuiltConstraints(); });
        takeFirstState();
    }

    void handleEvent(sofa::core::objectmodel::Event* event) override
    {
        if (!sofa::simulation::AnimateBeginEvent::checkEventType(event)) return;
        if (m_inputs && m_inputs->haveChanged() && make())
            d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
        if (m_solver && m_state.isGiven() && isInvalid(*this)) takeGivenState();
        mayStep(*this);
    }

    void nodesChanged(const MechanicalState& state, const SharedBody&, std::span<const int> splitFrom) override
    {
        if (isInvalid(*this)) return;
        const States states(*getContext());
        const States::Entry* entry = states.find(&state);
        if (!entry) return;
        m_knowsCompliance = false;
        m_compliance.reset();
        m_state.hasChanged();
        if (splitFrom.empty()) return m_memory.reset();
        const int numNew = static_cast<int>(splitFrom.size()), end = entry->firstNode + entry->numNodes - numNew;
        if (m_memory.start.rows() == states.numNodes() - numNew)
            parts::insert_rows(m_memory.start, splitFrom, entry->firstNode, end);
        m_memory.radii.clear();  // those of another matrix
    }

    /// SOFA has set up another matrix.
    void invert(GraphScatteredMatrix&) override { m_knowsCompliance = false; }

    void solve(GraphScatteredMatrix& A, GraphScatteredVector& x, GraphScatteredVector& b) override
    {
        typename Inherit::TempVectorContainer vectors(this, sofa::core::execparams::defaultInstance(), A, x, b);
        x.clear();  // no motion, where there is no answer
        if (m_solver && m_state.isGiven()) takeGivenState();
        if (isInvalid(*this) || !m_solver) return;
        const std::unique_ptr<GraphScatteredVector> in(vectors.createTempVector()), out(vectors.createTempVector());
        attempt(*this,
                [&]
                {
                    const SofaSystem system(*getContext(), A, *in, *out);
                    if (m_knowsCompliance) return system.write(motionOf(system, system.read(b)), x);
                    checkConstraints(system);
                    PointArray solution(system.num_nodes(), 3), load = system.read(b);
                    const SolveReport report = ImplicitEuler::solve(
                        m_solver->solver(), system, load, solution, m_memory,
                        [&](const PointArray& dv, PointArray& rhs) { return system.release(dv, rhs); });
                    system.acceptStep();
                    system.write(solution, x);
                    m_state.hasChanged();
                    msg_info() << report.iterations << " iterations, preconditioner " << name_of(report.preconditioner)
                               << ", |r| / |b| = " << report.residual;
                    passOn(*this, m_solver->heed(report));
                    if (!report.converged)
                        msg_warning() << "stopped after " << report.iterations
                                      << " iterations with |r| / |b| = " << report.residual;
                });
    }

    /// result += factor J A^-1 J^T, for LinearSolverConstraintCorrection.
    bool addJMInvJt(sofa::linearalgebra::BaseMatrix* result, sofa::linearalgebra::BaseMatrix* J, SReal factor) override
    {
        return attempt(*this,
                       [&]
                       {
                           const auto* rows = dynamic_cast<const Jacobian*>(J);
                           if (!rows) throw InputError("the Jacobian of the constraints is of another type");
                           addCompliance(*rows, factor, *result);
                       });
    }

    /// The same for GenericConstraintCorrection, which leaves it to the solver to find J. Overrides what the release of
    /// SOFA has: v24.12 has no regularization.
    bool buildComplianceMatrix(const sofa::core::ConstraintParams* cparams, sofa::linearalgebra::BaseMatrix* result,
                               SReal factor)
    {
        return buildComplianceMatrix(cparams, result, factor, 0);
    }
    bool buildComplianceMatrix(const sofa::core::ConstraintParams* cparams, sofa::linearalgebra::BaseMatrix* result,
                               SReal factor, SReal regularization)
    {
        return attempt(*this,
                       [&]
                       {
                           m_jacobian.resize(result->rowSize(),
                                             3 * static_cast<Jacobian::Index>(States(*getContext()).numNodes()));
                           sofa::simulation::mechanicalvisitor::MechanicalGetConstraintJacobianVisitor visitor(
                               cparams, &m_jacobian);
                           visitor.execute(getContext());
                           addCompliance(m_jacobian, factor, *result);
                           for (const auto& [number, line] : m_jacobian)
                               if (!line.empty()) result->add(number, number, regularization);
                       });
    }

    /// The force J^T multipliers of the latest buildComplianceMatrix, and the motion dx that belongs to it.
    void applyConstraintForce(const sofa::core::ConstraintParams* cparams, sofa::core::MultiVecDerivId dx,
                              const sofa::linearalgebra::BaseVector* multipliers) override
    {
        if (isInvalid(*this) || !m_solver) return;
        attempt(*this,
                [&]
                {
                    const States states(*getContext());
                    const ConstraintRows found(m_jacobian);
                    std::vector<double> lambda;
                    for (const Jacobian::Index number : found.numbers) lambda.push_back(multipliers->element(number));
                    PointArray force = PointArray::Zero(states.numNodes(), 3);
                    add_constraint_force(found.rows, lambda, force);
                    const auto write = [&](const PointArray& field, auto id)
                    {
                        states.write(
                            field, [&](MechanicalState & state) -> auto& { return *state.write(id.getId(&state)); });
                    };
                    withSystem([&](const SofaSystem& system) { write(motionOf(system, force), dx); });
                    write(force, cparams->lambda());
                });
    }

protected:
    MultigridCGLinearSolver() : TableComponent(attributes::kMultigridCGLinearSolver)
    {
        f_listening.setValue(true);  // to say in each step that it is invalid, and to take a state
    }

private:
    /// By the Data; false where they cannot be.
    bool make()
    {
        m_solver.reset();
        return attempt(*this,
                       [&]
                       {
                           m_solver.emplace(readOptions<parts::MultigridCGOptions>());
                           const parts::MultigridCGOptions& options = m_solver->options();
                           m_compliance = Compliance(options.preconditioner, options.tolerance);
                           m_knowsCompliance = false;
                       });
    }

    void forget()
    {
        if (m_solver) d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
        m_compliance.reset();
        m_memory.reset();
        m_knowsCompliance = false;
    }

    /// In the step, when bodies have taken theirs: their nodes may have split there.
    void takeGivenState()
    {
        if (attempt(*this, [&] { m_state.take([this](std::istream& in) { load(in); }); }))
            d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
    }

    void takeFirstState()
    {
        if (m_solver && !isInvalid(*this))
            attempt(*this, [&] { m_state.takeFirst([this](std::istream& in) { load(in); }); });
    }

    void save(std::ostream& out) const
    {
        SavedState::write(out, getClassName(),
                          [memory = m_memory](Archive& archive) mutable { memory.serialize(archive); });
    }
    void load(std::istream& in)
    {
        SolverMemory saved;
        SavedState::read(in, getClassName(), [&](Archive& archive) { saved.serialize(archive); });
        const bool isOfSystem = saved.start.rows() == 0 || saved.start.rows() == States(*getContext()).numNodes();
        if (!isOfSystem || !saved.is_valid()) throw InputError("the saved state is that of another system");
        m_memory = std::move(saved);
    }

    /// Solvers of constraints that ask for one constraint after the other need the entries of a factorised matrix. SOFA
    /// would go on without, and crash: they are left without the correction.
    void refuseUnbuiltConstraints()
    {
        using Correction =
            sofa::component::constraint::lagrangian::correction::LinearSolverConstraintCorrection<Vec3Types>;
        const auto corrections = allBelow<Correction>(*getContext());
        const auto unbuilt = unbuiltConstraintSolvers(*getContext()->getRootContext());
        if (corrections.empty() || unbuilt.empty()) return;
        for (auto* solver : unbuilt)
            for (Correction* correction : corrections) solver->removeConstraintCorrection(correction);
        throw InputError(
            "UnbuiltGaussSeidelConstraintSolver asks for single constraints, for which a matrix must be there: use "
            "BlockGaussSeidelConstraintSolver. Constraints do not act on its bodies");
    }

    /// Once, since a scene keeps its constraints.
    void checkConstraints(const SofaSystem& system)
    {
        if (!m_constraintsAreChecked && !system.constraintsProject())
            msg_warning() << "a constraint is not a projection: what it projects twice differs from what it projects "
                             "once, and its nodes leave the places that it should keep them at. "
                             "FixedPlaneProjectiveConstraint needs a direction of length 1";
        m_constraintsAreChecked = true;
    }

    template <class Call>
    void withSystem(const Call& call)
    {
        auto& system = *getLinearSystem();
        GraphScatteredMatrix& A = *system.getSystemMatrix();
        typename Inherit::TempVectorContainer vectors(this, sofa::core::execparams::defaultInstance(), A,
                                                      *system.getSolutionVector(), *system.getRHSVector());
        const std::unique_ptr<GraphScatteredVector> in(vectors.createTempVector()), out(vectors.createTempVector());
        call(SofaSystem(*getContext(), A, *in, *out));
    }

    void addCompliance(const Jacobian& J, SReal factor, sofa::linearalgebra::BaseMatrix& result)
    {
        if (isInvalid(*this) || !m_solver) return;
        const ConstraintRows found(J);
        withSystem(
            [&](const SofaSystem& system)
            {
                if (J.colSize() != 3 * static_cast<Jacobian::Index>(system.num_nodes()))
                    throw InputError(system.states().areSeveral()
                                         ? "LinearSolverConstraintCorrection knows one of its MechanicalObjects: use a "
                                           "GenericConstraintCorrection in the node of the solver"
                                         : "the Jacobian of the constraints is not that of its MechanicalObject");
                const Eigen::MatrixXd& W = m_compliance.find(system, found.rows);
                for (int i = 0; i < static_cast<int>(W.rows()); ++i)
                    for (int j = 0; j < static_cast<int>(W.rows()); ++j)
                        result.add(found.numbers[i], found.numbers[j], factor * W(i, j));
                msg_info() << W.rows() << " rows of constraints, " << m_compliance.iterations() << " iterations";
                if (m_compliance.num_stalled() > 0)
                    msg_warning()
                        << m_compliance.num_stalled() << " of " << W.rows()
                        << " rows of constraints are not solved to the tolerance: their bodies appear stiffer";
            });
        m_knowsCompliance = true;
    }

    /// x of A x = force of multipliers, from the solutions that the compliance is made of.
    PointArray motionOf(const SofaSystem& system, PointArray force)
    {
        PointArray motion(system.num_nodes(), 3);
        system.project(force);
        const parts::MultigridCGOptions& options = m_solver->options();
        PreconditionedConjugateGradients solver(std::min(kOfMultipliers, options.tolerance), options.iterations,
                                                options.preconditioner);
        const bool hasStart = m_compliance.start(force, motion);
        SolverMemory none;
        const SolveReport report =
            hasStart ? solver.solve_from_guess(system, force, motion, none) : solver.solve(system, force, motion);
        msg_info() << report.iterations << " iterations for multipliers, |r| / |b| = " << report.residual;
        return motion;
    }

    std::optional<Inputs> m_inputs;
    std::optional<parts::MultigridCG> m_solver;
    SolverMemory m_memory;
    SavedState m_state{*this, [this](std::ostream& out) { save(out); }};
    Compliance m_compliance;
    bool m_knowsCompliance = false;  ///< of the present matrix
    Jacobian m_jacobian;             ///< of the latest buildComplianceMatrix
    bool m_constraintsAreChecked = false;
};

[[maybe_unused]] const bool kMultigridCGLinearSolverIsRegistered =
    registerComponent<MultigridCGLinearSolver>(attributes::kMultigridCGLinearSolver);

}  // namespace hexaplast::sofa_plugin
