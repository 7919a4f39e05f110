// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/PartForceField.h>
#include <Hexaplast/TissueContactForceField.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <sofa/component/linearsolver/iterative/MatrixLinearSolver.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/ConstraintParams.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/core/behavior/MultiVec.h>
#include <sofa/linearalgebra/BaseVector.h>
#include <sofa/linearalgebra/SparseMatrix.h>
#include <sofa/simulation/MechanicalOperations.h>
#include <sofa/simulation/mechanicalvisitor/MechanicalGetConstraintJacobianVisitor.h>

#include <algorithm>
#include <optional>

#include "attributes/parts.hpp"
#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/solve/compliance.hpp"
#include "hexaplast/solve/implicit_euler.hpp"
#include "parts/multigrid_cg.hpp"

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
using OurForceField = PartForceField<Vec3Types>;
using OurInteraction = TissueContactForceField<Vec3Types>;

constexpr double kOfMultipliers = 1e-3;  // tolerance of motions that belong to the multipliers of constraints

using Jacobian = sofa::linearalgebra::SparseMatrix<SReal>;

/// The states of a system, one behind the other.
class States
{
public:
    struct Entry
    {
        MechanicalState* state;
        int first_node, num_nodes;
    };

    /// Those below that follow no other.
    explicit States(BaseContext& context)
    {
        std::vector<sofa::core::behavior::BaseMechanicalState*> found;
        context.get<sofa::core::behavior::BaseMechanicalState>(&found, BaseContext::SearchDown);
        for (auto* each : found)
        {
            if (each->getContext()->get<sofa::core::BaseMapping>(BaseContext::Local)) continue;
            auto* state = dynamic_cast<MechanicalState*>(each);
            if (!state)
                throw InputError(
                    "the independent MechanicalObjects in its node and below must be of template Vec3, "
                    "which '" +
                    each->getPathName() + "' is not");
            const int num_nodes = static_cast<int>(state->getSize());
            m_entries.push_back({state, m_num_nodes, num_nodes});
            m_num_nodes += num_nodes;
        }
        if (m_entries.empty()) throw InputError("there is no MechanicalObject in its node and below");
    }

    int num_nodes() const { return m_num_nodes; }
    const std::vector<Entry>& entries() const { return m_entries; }
    bool are_several() const { return m_entries.size() > 1; }

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
        PointArray field(m_num_nodes, 3);
        for (const Entry& entry : m_entries) rows<Points>(field, entry) = view(of(*entry.state));
        return field;
    }
    template <class To>
    void write(ConstPoints field, const To& to) const
    {
        for (const Entry& entry : m_entries)
        {
            Data<Vec3Types::VecDeriv>& data = to(*entry.state);
            Vec3Types::VecDeriv& values = *data.beginEdit();
            values.resize(static_cast<std::size_t>(entry.num_nodes));
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
        return Field(field.middleRows(entry.first_node, entry.num_nodes));
    }

private:
    std::vector<Entry> m_entries;
    int m_num_nodes = 0;
};

/// The system m M + b B + k K of a SOFA node as a system of ours, over all states that move by themselves. The kernels
/// work on our bodies, lumped masses and what of ours has a diagonal; what else of ours acts, on a state or between
/// two, is asked for its products beside them, and the rest of SOFA.
class SofaSystem final : public LinearSystem, private NodalOperator
{
public:
    /// in, out: vectors of SOFA to work with.
    SofaSystem(BaseContext& context, GraphScatteredMatrix& A, GraphScatteredVector& in, GraphScatteredVector& out)
        : m_context(context), m_states(context), m_A(A), m_in(in), m_out(out)
    {
    }

    int num_nodes() const override { return m_states.num_nodes(); }

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

    bool describe(MatrixFreeSystem& system) const override
    {
        system.diagonal_version = 0;
        system.find_free(num_nodes(), [&](Points field) { project(field); });
        m_mass_of_others = masses_are_lumped() ? 0 : m_A.mparams.mFactor();
        if (m_mass_of_others == 0)
            find_diagonal(system.diagonal);
        else
            system.diagonal.setZero(num_nodes(), 3);

        m_ours.clear();
        m_besides.clear();
        m_besides.reserve(m_states.entries().size());  // referred to by the system
        m_between.pairs.clear();
        bool has_others = m_mass_of_others != 0;
        std::vector<BaseForceField*> fields;
        m_context.get<BaseForceField>(&fields, BaseContext::SearchDown);
        for (const States::Entry& entry : m_states.entries())
        {
            if (!m_states.are_several())
            {
                describe(entry, fields, system);
                continue;
            }
            MatrixFreeSystem part;
            part.wants_coarse = system.wants_coarse;
            part.diagonal.setZero(entry.num_nodes, 3);
            describe(entry, fields, part);
            system.add_part(part, entry.first_node);
        }
        for (BaseForceField* field : fields)
        {
            if (dynamic_cast<BaseMass*>(field) || has_no_stiffness(*field)) continue;
            if (auto* ours = dynamic_cast<OurInteraction*>(field))
            {
                const auto *first = m_states.find(ours->getMState1()), *second = m_states.find(ours->getMState2());
                if (ours->isInMatrix() && first && second) m_between.pairs.push_back({ours, first, second});
                continue;
            }
            const auto* ours = dynamic_cast<OurForceField*>(field);
            if (ours ? ours->hasPart() && ours->isInMatrix() && !m_states.find(ours->getMState()) : true)
                has_others = true;
        }
        m_between.b = m_A.mparams.bFactor();
        m_between.k = m_A.mparams.kFactor();
        if (!m_between.pairs.empty()) system.others.emplace_back(&m_between);
        if (has_others && others_act()) system.others.emplace_back(static_cast<const NodalOperator*>(this));
        return true;
    }

    /// Lets go of what would pull at the end of the step that dv leads to, and adds to b what that changes. Whether
    /// there was anything: then the system is to be solved again.                                     theory.md eq. 41
    bool release(ConstPoints dv, Points b) const
    {
        if (m_A.mparams.bFactor() == 0) return false;  // not a step of implicit Euler, where it is -h
        const double h = -m_A.mparams.bFactor(), ofProduct = m_A.mparams.kFactor() / m_A.mparams.bFactor();
        const PointArray x = m_states.positions(), v = m_states.velocities();
        const PointArray v_end = v + dv, x_end = x + h * v_end;
        PointArray force = PointArray::Zero(num_nodes(), 3), product = force;
        bool has_released = false;

        // what `let_go` takes out of the forces and products that `add` adds
        const auto change_by = [&](const auto& add_force, const auto& add_product, const auto& let_go)
        {
            const auto add = [&](double sign)
            {
                PointArray change = PointArray::Zero(num_nodes(), 3);
                add_force(change);
                force += sign * change;
                add_product(sign);
            };
            add(-1);
            has_released = let_go() || has_released;
            add(1);
        };
        for (const Beside& beside : m_besides)
            for (OurForceField* field : beside.fields)
            {
                if (!field->isOneSided()) continue;
                const auto of = [&](const PointArray& all) { return States::rows<ConstPoints>(all, beside.entry); };
                const auto in = [&](PointArray& all) { return States::rows<Points>(all, beside.entry); };
                change_by([&](PointArray& f) { field->addOwnForce(of(x), of(v), in(f)); },
                          [&](double sign) { field->addOwnProduct(0, sign, of(v), in(product)); },
                          [&] { return field->release(of(x_end), of(v_end)); });
            }
        for (const Between::Pair& pair : m_between.pairs)
        {
            if (!pair.field->isOneSided()) continue;
            const auto of = [&](const PointArray& all) { return pair.rows<ConstPoints>(all); };
            const auto in = [&](PointArray& all) { return pair.rows<Points>(all); };
            change_by([&](PointArray& f) { pair.field->addOwnForce(of(x), of(v), in(f)); },
                      [&](double sign) { pair.field->addOwnProduct(0, sign, of(v), in(product)); },
                      [&] { return pair.field->release(of(x_end), of(v_end)); });
        }
        if (!has_released) return false;
        force = h * (force + ofProduct * product);
        project(force);
        b += force;
        return true;
    }

    /// The step ends as it was solved: what is solved after it are other systems with its matrix.
    void settle() const
    {
        for (const Beside& beside : m_besides)
            for (OurForceField* field : beside.fields) field->settle();
        for (const Between::Pair& pair : m_between.pairs) pair.field->settle();
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
    bool constraints_project() const
    {
        PointArray once = irregular_numbers(num_nodes());
        project(once);
        PointArray twice = once;
        project(twice);
        return (twice - once).norm() <= 1e-9 * once.norm();
    }

private:
    /// Loads that SOFA's scenes prescribe.
    static bool has_no_stiffness(const BaseForceField& field)
    {
        const std::string name = field.getClassName();
        return name == "ConstantForceField" || name == "LinearForceField";
    }

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
            for (OurForceField* field : m_system.m_ours) field->leaveOutOfProducts(leftOut);
            for (const Between::Pair& pair : m_system.m_between.pairs) pair.field->leaveOutOfProducts(leftOut);
        }
        const SofaSystem& m_system;
    };

    /// What of ours acts on one state.
    void describe(const States::Entry& entry, const std::vector<BaseForceField*>& fields,
                  MatrixFreeSystem& system) const
    {
        Beside& beside = m_besides.emplace_back(entry);
        beside.b = m_A.mparams.bFactor();
        beside.k = m_A.mparams.kFactor();
        for (BaseForceField* field : fields)
        {
            auto* ours = dynamic_cast<OurForceField*>(field);
            if (!ours || ours->getMState() != entry.state || !ours->hasPart() || !ours->isInMatrix()) continue;
            m_ours.push_back(ours);
            if (ours->describe(beside.k + beside.b * ours->rayleighStiffness.getValue(), system))
                ours->addDampingDiagonal(beside.b, system.diagonal);
            else
                beside.fields.push_back(ours);
        }
        if (!beside.fields.empty()) system.others.emplace_back(&beside);
    }

    /// Fp += F p of what the kernels do not know.
    void add_product(ConstPoints p, Points Fp) const override
    {
        write(p, m_in);
        const LeftOut leftOut(*this);
        multiply(m_mass_of_others, m_A.mparams.bFactor(), m_A.mparams.kFactor());
        for (const States::Entry& entry : m_states.entries())
            States::rows(Fp, entry) += view(entry.state->read(m_out.id().getId(entry.state))->getValue());
    }

    /// Whether the others have an entry at all, as planes that nothing touches have none: a vector without any
    /// regularity has a product then.
    bool others_act() const
    {
        PointArray product = PointArray::Zero(num_nodes(), 3);
        add_product(irregular_numbers(num_nodes()), product);
        return !product.isZero(0);
    }

    /// Whether all masses are lumped, act on the states themselves, and do not damp.
    bool masses_are_lumped() const
    {
        std::vector<BaseMass*> masses;
        m_context.get<BaseMass>(&masses, BaseContext::SearchDown);
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

    /// What of ours on a state the kernels do not know, without the detour through SOFA's vectors.
    struct Beside final : NodalOperator
    {
        explicit Beside(const States::Entry& of) : entry(of) {}
        void add_product(ConstPoints p, Points Fp) const override
        {
            for (const OurForceField* field : fields) field->addOwnProduct(b, k, p, Fp);
        }
        States::Entry entry;
        std::vector<OurForceField*> fields;
        double b = 0, k = 0;  // factors of df/dv, df/dx
    };

    /// What of ours acts between two states, or within one as if it were two.
    struct Between final : NodalOperator
    {
        struct Pair
        {
            template <class Field>
            OfTwo<Field> rows(Field of_all) const
            {
                return {States::rows(of_all, *first), States::rows(of_all, *second)};
            }
            OurInteraction* field;
            const States::Entry *first, *second;
        };
        void add_product(ConstPoints p, Points Fp) const override
        {
            for (const Pair& pair : pairs) pair.field->addOwnProduct(b, k, pair.rows(p), pair.rows(Fp));
        }
        std::vector<Pair> pairs;
        double b = 0, k = 0;
    };

    BaseContext& m_context;
    States m_states;
    GraphScatteredMatrix& m_A;
    GraphScatteredVector &m_in, &m_out;
    mutable std::vector<OurForceField*> m_ours;  // on the states: SOFA's products are without them
    mutable std::vector<Beside> m_besides;       // one per state
    mutable Between m_between;                   // SOFA's products are without it as well
    mutable double m_mass_of_others = 0;         // factor of the masses in what the kernels do not know
};

}  // namespace

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

/// Preconditioned conjugate gradients that end when the answer is as good as asked for. SOFA's constraint corrections
/// ask it for J A^-1 J^T, and for the motion that belongs to multipliers.
class MultigridCGLinearSolver final
    : public sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>
{
public:
    using Inherit = sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>;
    SOFA_CLASS(MultigridCGLinearSolver, SOFA_TEMPLATE2(sofa::component::linearsolver::MatrixLinearSolver,
                                                       GraphScatteredMatrix, GraphScatteredVector));

    DataWord d_preconditioner;  ///< auto, multigrid or diagonal
    Data<SReal> d_tolerance;    ///< on |r| / |b|
    Data<int> d_iterations;     ///< at most

    /// SOFA's constraint corrections refuse solvers that are called GraphScattered, of which none has J A^-1 J^T.
    static std::string GetCustomTemplateName() { return "MatrixFree"; }

    void init() override
    {
        Inherit::init();
        m_solver.reset();
        m_constraints_are_checked = false;
        const auto make = [&]
        {
            parts::OptionErrors errors;
            parts::MultigridCGOptions options{.tolerance = d_tolerance.getValue(),
                                              .iterations = d_iterations.getValue()};
            errors.collect([&] { options.preconditioner = parts::preconditioner_of(d_preconditioner.given()); });
            errors.collect([&] { m_solver.emplace(options); });
            errors.throw_all();
            m_compliance = Compliance(options.preconditioner);
        };
        if (!attempt(*this, make)) m_solver.reset();
        reset();
    }
    void bwdInit() override
    {
        Inherit::bwdInit();
        attempt(*this, [&] { refuseUnbuiltConstraints(); });
    }
    void reinit() override
    {
        init();
        attempt(*this, [&] { refuseUnbuiltConstraints(); });
    }

    // A step that was lost is forgotten, Data that were refused are not.
    void reset() override
    {
        if (m_solver) d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
        m_compliance.reset();
        m_knowsCompliance = false;
        if (m_solver) attempt(*this, [&] { refuseUnbuiltConstraints(); });
    }

    /// SOFA has set up another matrix.
    void invert(GraphScatteredMatrix&) override { m_knowsCompliance = false; }

    void solve(GraphScatteredMatrix& A, GraphScatteredVector& x, GraphScatteredVector& b) override
    {
        if (!may_step(*this) || !m_solver) return;
        typename Inherit::TempVectorContainer vectors(this, sofa::core::execparams::defaultInstance(), A, x, b);
        const std::unique_ptr<GraphScatteredVector> in(vectors.createTempVector()), out(vectors.createTempVector());
        attempt(*this,
                [&]
                {
                    const SofaSystem system(*getContext(), A, *in, *out);
                    if (m_knowsCompliance) return system.write(motionOf(system, system.read(b)), x);
                    check_constraints(system);
                    PointArray solution(system.num_nodes(), 3), load = system.read(b);
                    SolveReport report = m_solver->solver().solve(system, load, solution);
                    for (int k = 0; k < ImplicitEuler::kMostReleases && system.release(solution, load); ++k)
                    {
                        const SolveReport again = m_solver->solver().solve_from_guess(system, load, solution);
                        report.iterations += again.iterations;
                        report.residual = again.residual;
                        report.converged = again.converged;
                    }
                    system.settle();
                    system.write(solution, x);
                    msg_info() << report.iterations << " iterations, preconditioner " << name_of(report.preconditioner)
                               << ", |r| / |b| = " << report.residual;
                    pass_on(*this, m_solver->heed(report));
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

    /// The same for GenericConstraintCorrection, which leaves it to the solver to find J.
    bool buildComplianceMatrix(const sofa::core::ConstraintParams* cparams, sofa::linearalgebra::BaseMatrix* result,
                               SReal factor, SReal regularization) override
    {
        return attempt(*this,
                       [&]
                       {
                           m_jacobian.resize(result->rowSize(),
                                             3 * static_cast<Jacobian::Index>(States(*getContext()).num_nodes()));
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
        attempt(*this,
                [&]
                {
                    const States states(*getContext());
                    PointArray force = PointArray::Zero(states.num_nodes(), 3);
                    for (const auto& [number, line] : m_jacobian)
                        for (const auto& [column, value] : line)
                            force(column / 3, column % 3) += value * multipliers->element(number);
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
    MultigridCGLinearSolver()
        : d_preconditioner(
              from_table(*this, d_preconditioner, row(attributes::kMultigridCGLinearSolver, "preconditioner"))),
          d_tolerance(from_table(*this, d_tolerance, row(attributes::kMultigridCGLinearSolver, "tolerance"))),
          d_iterations(from_table(*this, d_iterations, row(attributes::kMultigridCGLinearSolver, "iterations")))
    {
    }

private:
    /// Solvers of constraints that ask for one constraint after the other need the entries of a factorised matrix. SOFA
    /// would go on without, and crash.
    void refuseUnbuiltConstraints()
    {
        const auto find = [](BaseContext* context, BaseContext::SearchDirection where, const std::string& name)
        {
            std::vector<SofaComponent*> components;
            context->get<SofaComponent>(&components, where);
            return std::find_if(components.begin(), components.end(),
                                [&](const SofaComponent* component)
                                { return component->getClassName() == name; }) != components.end();
        };
        if (find(getContext(), BaseContext::Local, "LinearSolverConstraintCorrection") &&
            find(getContext()->getRootContext(), BaseContext::SearchDown, "UnbuiltGaussSeidelConstraintSolver"))
            throw InputError(
                "UnbuiltGaussSeidelConstraintSolver asks for single constraints, for which a matrix must be there: "
                "use BlockGaussSeidelConstraintSolver");
    }

    /// Once, since a scene keeps its constraints.
    void check_constraints(const SofaSystem& system)
    {
        if (!m_constraints_are_checked && !system.constraints_project())
            msg_warning() << "a constraint is not a projection: what it projects twice differs from what it projects "
                             "once, and its nodes leave the places that it should keep them at. "
                             "FixedPlaneProjectiveConstraint needs a direction of length 1";
        m_constraints_are_checked = true;
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
        if (!may_step(*this) || !m_solver) return;
        const ConstraintRows found(J);
        withSystem(
            [&](const SofaSystem& system)
            {
                if (J.colSize() != 3 * static_cast<Jacobian::Index>(system.num_nodes()))
                    throw InputError(system.states().are_several()
                                         ? "LinearSolverConstraintCorrection knows one of its MechanicalObjects: use a "
                                           "GenericConstraintCorrection in the node of the solver"
                                         : "the Jacobian of the constraints is not that of its MechanicalObject");
                const Eigen::MatrixXd& W = m_compliance.find(system, found.rows);
                for (int i = 0; i < static_cast<int>(W.rows()); ++i)
                    for (int j = 0; j < static_cast<int>(W.rows()); ++j)
                        result.add(found.numbers[i], found.numbers[j], factor * W(i, j));
                msg_info() << W.rows() << " rows of constraints, " << m_compliance.iterations() << " iterations";
            });
        m_knowsCompliance = true;
    }

    /// x of A x = force of multipliers, from the solutions that the compliance is made of.
    PointArray motionOf(const SofaSystem& system, PointArray force)
    {
        PointArray motion(system.num_nodes(), 3);
        system.project(force);
        PreconditionedConjugateGradients solver(std::min(kOfMultipliers, d_tolerance.getValue()),
                                                d_iterations.getValue(),
                                                parts::preconditioner_of(d_preconditioner.given()));
        const bool has_start = m_compliance.start(force, motion);
        const SolveReport report =
            has_start ? solver.solve_from_guess(system, force, motion) : solver.solve(system, force, motion);
        msg_info() << report.iterations << " iterations for multipliers, |r| / |b| = " << report.residual;
        return motion;
    }

    std::optional<parts::MultigridCG> m_solver;
    Compliance m_compliance;
    bool m_knowsCompliance = false;  // of the present matrix
    Jacobian m_jacobian;             // of the latest buildComplianceMatrix
    bool m_constraints_are_checked = false;
};

void registerMultigridCGLinearSolver(sofa::core::ObjectFactory* factory)
{
    register_component<MultigridCGLinearSolver>(factory, attributes::kMultigridCGLinearSolver);
}

}  // namespace hexaplast::sofa_plugin
