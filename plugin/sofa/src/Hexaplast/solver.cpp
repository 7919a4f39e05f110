// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/GuestForceField.h>
#include <Hexaplast/init.h>
#include <sofa/component/linearsolver/iterative/MatrixLinearSolver.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/core/behavior/MultiVec.h>
#include <sofa/simulation/MechanicalOperations.h>

#include <algorithm>

#include "attributes/hexaplast.hpp"
#include "hexaplast/base/linear_system.hpp"

namespace hexaplast::sofa_plugin {
namespace {

using sofa::component::linearsolver::GraphScatteredMatrix;
using sofa::component::linearsolver::GraphScatteredVector;
using sofa::core::MatricesFactors;
using sofa::core::behavior::BaseForceField;
using sofa::core::behavior::BaseMass;
using sofa::core::objectmodel::BaseContext;

/// The system m M + b B + k K of a SOFA node as a system of ours. Where it consists of one body, lumped masses, loads
/// without stiffness and constraints on coordinates, the kernels work on it; anything else is asked of SOFA product by
/// product.
class SofaSystem final : public LinearSystem {
 public:
  /// in, out: vectors of SOFA to work with.
  SofaSystem(BaseContext& context, MechanicalState& state, GraphScatteredMatrix& A, GraphScatteredVector& in,
             GraphScatteredVector& out)
      : context_(context), state_(state), A_(A), in_(in), out_(out) {}

  int num_nodes() const override { return static_cast<int>(state_.getSize()); }

  void apply(ConstPoints p, Points Ap) const override {
    write(p, in_);
    multiply(A_.mparams.mFactor(), A_.mparams.bFactor(), A_.mparams.kFactor());
    A_.parent->projectResponse(out_);
    Ap = read(out_);
  }

  void assemble(BlockMatrix&) const override {
    throw InputError("MultigridCGLinearSolver asks for products, not for a matrix");
  }

  bool to_kernels(KernelSystem& system) const override {
    system.double_operator = nullptr;
    system.single_operator = nullptr;
    if (!find_masses() || !find_free(system.free)) return false;
    find_diagonal(system.diagonal);

    std::vector<BaseForceField*> fields;
    context_.get<BaseForceField>(&fields, BaseContext::SearchDown);
    for (BaseForceField* field : fields) {
      if (dynamic_cast<BaseMass*>(field) || has_no_stiffness(*field)) continue;
      auto* ours = dynamic_cast<GuestForceField*>(field);
      if (!ours || !ours->guest() || ours->getMState() != &state_) return false;
      const double factor = A_.mparams.kFactor() + A_.mparams.bFactor() * ours->rayleighStiffness.getValue();
      if (!ours->guest()->to_kernels(factor, system)) return false;
    }
    return system.double_operator || system.single_operator;
  }

  PointArray read(GraphScatteredVector& from) const { return view(state_.read(from.id().getId(&state_))->getValue()); }
  void write(ConstPoints field, GraphScatteredVector& to) const {
    auto* data = state_.write(to.id().getId(&state_));
    view(*data->beginEdit()) = field;
    data->endEdit();
  }

 private:
  /// Loads that SOFA's scenes prescribe.
  static bool has_no_stiffness(const BaseForceField& field) {
    const std::string name = field.getClassName();
    return name == "ConstantForceField" || name == "LinearForceField";
  }

  /// Whether all masses are lumped, act on this state, and do not damp by themselves.
  bool find_masses() const {
    std::vector<BaseMass*> masses;
    context_.get<BaseMass>(&masses, BaseContext::SearchDown);
    return std::all_of(masses.begin(), masses.end(), [&](BaseMass* mass) {
      const auto* field = dynamic_cast<const sofa::core::behavior::ForceField<DataTypes>*>(mass);
      const bool damps = mass->rayleighMass.getValue() != 0 && A_.mparams.bFactor() != 0;
      return mass->isDiagonal() && !damps && field && field->getMState() == &state_;
    });
  }

  /// 1 where a degree of freedom is free, 0 where it is fixed; false where constraints couple coordinates.
  bool find_free(PointArray& free) const {
    const PointArray ones = PointArray::Ones(num_nodes(), 3);
    write(ones, out_);
    A_.parent->projectResponse(out_);
    free = read(out_);
    return (free.array() == 0 || free.array() == 1).all();
  }

  /// Diagonal of m M, from the product with a vector of ones.
  void find_diagonal(PointArray& diagonal) const {
    write(PointArray::Ones(num_nodes(), 3), in_);
    multiply(A_.mparams.mFactor(), 0, 0);
    diagonal = read(out_);
  }

  /// out = (m M + b B + k K) in. SOFA keeps the factors of the latest call, so that each call gives its own.
  void multiply(double m, double b, double k) const {
    A_.parent->propagateDxAndResetDf(in_, out_);
    A_.parent->addMBKdx(out_, MatricesFactors::M(m), MatricesFactors::B(b), MatricesFactors::K(k), false);
  }

  BaseContext& context_;
  MechanicalState& state_;
  GraphScatteredMatrix& A_;
  GraphScatteredVector &in_, &out_;
};

class MultigridCGLinearSolver final
    : public sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector> {
 public:
  using Inherit = sofa::component::linearsolver::MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>;
  SOFA_CLASS(MultigridCGLinearSolver, SOFA_TEMPLATE2(sofa::component::linearsolver::MatrixLinearSolver,
                                                     GraphScatteredMatrix, GraphScatteredVector));

  void init() override {
    Inherit::init();
    guest_.reset();
    attempt(*this, [&] { guest_.emplace(*this, attributes::kMultigridCGLinearSolver, attributes_, nullptr, nullptr); });
  }
  void reinit() override { init(); }

  void solve(GraphScatteredMatrix& A, GraphScatteredVector& x, GraphScatteredVector& b) override {
    if (!guest_) return;
    typename Inherit::TempVectorContainer vectors(this, sofa::core::execparams::defaultInstance(), A, x, b);
    const std::unique_ptr<GraphScatteredVector> in(vectors.createTempVector()), out(vectors.createTempVector());
    attempt(*this, [&] {
      const SofaSystem system(*getContext(), only_state(), A, *in, *out);
      PointArray solution(system.num_nodes(), 3);
      const SolveReport report = guest_->as<scene::LinearSolver>().method().solve(system, system.read(b), solution);
      system.write(solution, x);
      if (!report.converged)
        msg_warning() << "stopped after " << report.iterations << " iterations with |r| / |b| = " << report.residual;
    });
  }

 protected:
  MultigridCGLinearSolver() : attributes_(*this, attributes::kMultigridCGLinearSolver) {}

 private:
  /// The one state below that follows no other.
  MechanicalState& only_state() {
    std::vector<sofa::core::behavior::BaseMechanicalState*> states;
    getContext()->get<sofa::core::behavior::BaseMechanicalState>(&states, BaseContext::SearchDown);
    MechanicalState* found = nullptr;
    for (auto* state : states) {
      if (state->getContext()->get<sofa::core::BaseMapping>(BaseContext::Local)) continue;
      if (found || !dynamic_cast<MechanicalState*>(state))
        throw InputError("there must be one independent MechanicalObject, of template Vec3, in its node and below");
      found = dynamic_cast<MechanicalState*>(state);
    }
    if (!found) throw InputError("there is no MechanicalObject in its node and below");
    return *found;
  }

  AttributeData attributes_;
  std::optional<Guest> guest_;
};

}  // namespace

void register_solver(sofa::core::ObjectFactory* factory) {
  register_component<MultigridCGLinearSolver>(factory, attributes::kMultigridCGLinearSolver);
}

}  // namespace hexaplast::sofa_plugin
