// SPDX-License-Identifier: LGPL-2.1-or-later
// MultigridCGLinearSolver on the vectors of a SOFA graph: by our kernels what they know of the system, by the products
// of the graph what acts beside it.
#include <sofa/component/linearsolver/iterative/MatrixLinearSolver.h>
#include <sofa/core/behavior/BaseMass.h>
#include <sofa/core/behavior/MixedInteractionForceField.h>
#include <sofa/linearalgebra/SparseMatrix.h>
#include <sofa/simulation/mechanicalvisitor/MechanicalGetConstraintJacobianVisitor.h>

#include <Eigen/Dense>
#include <cmath>

#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

using sofa::component::linearsolver::GraphScatteredMatrix;
using sofa::component::linearsolver::GraphScatteredVector;
using sofa::component::linearsolver::MatrixLinearSolver;
using sofa::core::MechanicalParams;
using sofa::core::MultiVecDerivId;
using DataVecCoord = Data<DataTypes::VecCoord>;
using DataVecDeriv = Data<DataTypes::VecDeriv>;

/// Node n weighs 0.01 + 0.001 n kg.
class Weights final : public sofa::core::behavior::Mass<DataTypes> {
 public:
  SOFA_CLASS(Weights, sofa::core::behavior::Mass<DataTypes>);

  static double of(int node) { return 0.01 + 0.001 * node; }
  bool isDiagonal() const override { return is_lumped; }
  void addMDx(const MechanicalParams*, DataVecDeriv& f, const DataVecDeriv& dx, SReal factor) override {
    ++num_products;
    auto to = view(*f.beginEdit());
    const auto from = view(dx.getValue());
    for (int n = 0; n < to.rows(); ++n) to.row(n) += factor * of(n) * from.row(n);
  }

  bool is_lumped = true;
  int num_products = 0;
};

/// Ties node 7 to the ground; nothing of ours.
class Spring : public sofa::core::behavior::ForceField<DataTypes> {
 public:
  SOFA_CLASS(Spring, sofa::core::behavior::ForceField<DataTypes>);

  void addForce(const MechanicalParams*, DataVecDeriv&, const DataVecCoord&, const DataVecDeriv&) override {}
  void addDForce(const MechanicalParams* params, DataVecDeriv& df, const DataVecDeriv& dx) override {
    ++num_products;
    view(*df.beginEdit()).row(7) -= params->kFactor() * stiffness * view(dx.getValue()).row(7);
  }
  void addKToMatrix(sofa::linearalgebra::BaseMatrix*, SReal, unsigned int&) override {}
  void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix*) override {}
  void buildDampingMatrix(sofa::core::behavior::DampingMatrix*) override {}
  SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord&) const override { return 0; }

  double stiffness = 300;  // [N/m]
  int num_products = 0;
};

/// A load that SOFA's scenes prescribe, known by its name.
class ConstantForceField final : public Spring {
 public:
  SOFA_CLASS(ConstantForceField, Spring);
  ConstantForceField() { stiffness = 0; }
};

/// Holds nodes 0 to 3; with a slope, node 4 slides on a plane.
class Held final : public sofa::core::behavior::BaseProjectiveConstraintSet {
 public:
  SOFA_CLASS(Held, sofa::core::behavior::BaseProjectiveConstraintSet);

  void projectResponse(const MechanicalParams*, MultiVecDerivId dx) override {
    auto* state = getContext()->get<MechanicalState>();
    auto v = view(*state->write(dx.getId(state))->beginEdit());
    v.topRows(4).setZero();
    if (!has_slope) return;
    v.row(4) -= v.row(4).dot(slope) * slope;
  }

  bool has_slope = false;
  Eigen::RowVector3d slope{0, 0.6, 0.8};  // its normal
};

class MultigridSolver : public Adapter {
 protected:
  static constexpr double kStiffnessFactor = -0.0004, kDampingFactor = -0.02, kRayleighStiffness = 0.1;

  MultigridSolver() {
    weights.init();
    tissue.add(New<Held>::make(), "held");
    force(body, deformed);
    PointArray load = random.field(mesh.num_nodes(), 1);
    load.topRows(4).setZero();
    view(*nodes.write(1)->beginEdit()) = load;
  }

  Field& solver_needs_a_body() {
    return make_body({{"youngModulus", "7000"}, {"poissonRatio", "0.3"}, {"rayleighStiffness", "0.1"}});
  }

  /// x of (M + b B + k K) x = b, as SOFA asks for it.
  PointArray solve(const Attributes& attributes = {{"tolerance", "1e-11"}, {"iterations", "500"}}) {
    auto& made = make("MultigridCGLinearSolver", attributes);
    solver = &made;
    made.init();
    made.f_printLog.setValue(prints_log);
    GraphScatteredMatrix A;
    A.mparams.setMFactor(1);
    A.mparams.setBFactor(kDampingFactor);
    A.mparams.setKFactor(kStiffnessFactor);
    GraphScatteredVector x(0), b(1);
    dynamic_cast<MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>&>(made).solve(A, x, b);
    return view(nodes.read(0)->getValue());
  }

  /// The same by elimination, with a spring at node 7.
  PointArray expected(double spring = 0) {
    const int size = 3 * mesh.num_nodes();
    DenseMatrix A(size);
    unsigned int offset = 0;
    body.addKToMatrix(&A, kStiffnessFactor + kDampingFactor * kRayleighStiffness, offset);
    for (int i = 0; i < size; ++i) A.values(i, i) += Weights::of(i / 3) - (i / 3 == 7 ? kStiffnessFactor * spring : 0);
    const int num_free = size - 12;  // nodes 0 to 3 are held
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
    x.tail(num_free) = A.values.bottomRightCorner(num_free, num_free)
                           .ldlt()
                           .solve(flat(PointArray(view(nodes.read(1)->getValue()))).tail(num_free));
    return Eigen::Map<const PointArray>(x.data(), mesh.num_nodes(), 3);
  }

  Weights& weights = tissue.add(New<Weights>::make(), "weights");
  Field& body = solver_needs_a_body();
  BaseComponent* solver = nullptr;
  bool prints_log = false;
};

TEST_F(MultigridSolver, SolvesByTheKernelsWhatTheyKnow) {
  auto& load = tissue.add(New<ConstantForceField>::make(), "load");
  load.init();
  EXPECT_TRUE(support::agrees(solve(), expected(), 1e-9)) << said();
  EXPECT_EQ(weights.num_products, 1) << "SOFA is asked for the masses alone";
  EXPECT_EQ(said(), "");
}

TEST_F(MultigridSolver, AsksSofaForWhatTheKernelsDoNotKnow) {
  auto& spring = tissue.add(New<Spring>::make(), "spring");
  spring.init();
  EXPECT_TRUE(support::agrees(solve(), expected(spring.stiffness), 1e-9)) << said();
  EXPECT_GT(spring.num_products, 5);
  EXPECT_EQ(weights.num_products, 1) << "the kernels have the masses";
}

// As with a plane that nothing touches.
TEST_F(MultigridSolver, AsksSofaForNothingThatActsNowhere) {
  const PointArray alone = solve();
  auto& spring = tissue.add(New<Spring>::make(), "spring");
  spring.init();
  spring.stiffness = 0;
  EXPECT_EQ(solve(), alone) << "to the last bit";
  EXPECT_EQ(spring.num_products, 1) << "to see that there is nothing";
}

TEST_F(MultigridSolver, AsksSofaForTheProductWithMassesThatAreNotLumped) {
  weights.is_lumped = false;
  EXPECT_TRUE(support::agrees(solve(), expected(), 1e-9)) << said();
  EXPECT_GT(weights.num_products, 5);
}

TEST_F(MultigridSolver, KeepsToConstraintsThatCoupleCoordinates) {
  tissue.get<Held>()->has_slope = true;
  nodes.write(1)->beginEdit()->at(4) = {0.1, 0.8, -0.6};  // along the slope
  const PointArray x = solve();
  EXPECT_NEAR(0.6 * x(4, 1) + 0.8 * x(4, 2), 0, 1e-13);  // rounding of what it starts from, of order 1
  EXPECT_GT(x.row(4).norm(), 1e-3);
  EXPECT_GT(weights.num_products, 5);
}

// A vector of ones lies in this plane.
TEST_F(MultigridSolver, KeepsToPlanesThroughTheDiagonal) {
  tissue.get<Held>()->has_slope = true;
  tissue.get<Held>()->slope = Eigen::RowVector3d(1, -1, 0) / std::sqrt(2.0);
  nodes.write(1)->beginEdit()->at(4) = {0.8, 0.8, -0.6};
  const PointArray x = solve();
  EXPECT_NEAR(x(4, 0) - x(4, 1), 0, 1e-13);
  EXPECT_GT(x.row(4).norm(), 1e-3);
}

// SOFA takes a direction as it is given: 1 - n n^T reflects where |n|^2 is 2.
TEST_F(MultigridSolver, WarnsOfPlanesThatDoNotProject) {
  tissue.get<Held>()->has_slope = true;
  tissue.get<Held>()->slope = Eigen::RowVector3d(1, -1, 0) / std::sqrt(2.0);
  nodes.write(1)->beginEdit()->at(4) = {0.8, 0.8, -0.6};
  solve();
  EXPECT_EQ(said(), "");
  tissue.get<Held>()->slope = Eigen::RowVector3d(1, -1, 0);
  solve();
  EXPECT_NE(said().find("needs a direction of length 1"), std::string::npos) << said();
}

TEST_F(MultigridSolver, SaysWhenItStopsEarly) {
  auto& spring = tissue.add(New<Spring>::make(), "spring");
  spring.init();
  solve({{"tolerance", "1e-11"}, {"iterations", "2"}});
  EXPECT_NE(said().find("stopped after 2 iterations"), std::string::npos) << said();
}

// This body is too small for coarse meshes.
TEST_F(MultigridSolver, SaysWhichPreconditionerItUsed) {
  solve();
  EXPECT_EQ(said(), "");
  prints_log = true;
  solve();
  EXPECT_NE(said().find("iterations, preconditioner diagonal, |r| / |b| = "), std::string::npos) << said();
  EXPECT_EQ(said().find("lattice"), std::string::npos) << "nobody has asked for multigrid";
  solve({{"tolerance", "1e-11"}, {"preconditioner", "multigrid"}});
  EXPECT_NE(said().find("needs a body whose hexahedra form a lattice"), std::string::npos) << said();
}

/// Rigid frames, which it does not move.
class Frames final : public sofa::core::behavior::BaseMechanicalState {
 public:
  SOFA_CLASS(Frames, sofa::core::behavior::BaseMechanicalState);
  sofa::Size getSize() const override { return 1; }
};

TEST_F(MultigridSolver, MovesTheStatesThatFollowNoOther) {
  BaseContext& points = tissue.add_child("points");
  points.add(New<MechanicalState>::make(), "points");
  points.add(New<sofa::core::BaseMapping>::make(), "mapping");
  EXPECT_TRUE(support::agrees(solve(), expected(), 1e-9)) << said();

  tissue.add_child("tool").add(New<Frames>::make(), "frames");
  solve();
  EXPECT_TRUE(solver->isComponentStateInvalid());
  EXPECT_NE(said().find("must be of template Vec3, which '/tissue/tool/frames' is not"), std::string::npos) << said();
  solver->reset();
  EXPECT_FALSE(solver->isComponentStateInvalid()) << "the step that was lost is forgotten";
}

/// A spring between node 7 of one state and node 2 of another; nothing of ours.
class Joint final : public sofa::core::behavior::MixedInteractionForceField<DataTypes, DataTypes> {
 public:
  SOFA_CLASS(Joint, SOFA_TEMPLATE2(sofa::core::behavior::MixedInteractionForceField, DataTypes, DataTypes));

  void addForce(const MechanicalParams*, DataVecDeriv&, DataVecDeriv&, const DataVecCoord&, const DataVecCoord&,
                const DataVecDeriv&, const DataVecDeriv&) override {}
  void addDForce(const MechanicalParams* params, DataVecDeriv& df1, DataVecDeriv& df2, const DataVecDeriv& dx1,
                 const DataVecDeriv& dx2) override {
    const Eigen::RowVector3d force =
        -params->kFactor() * kStiffness * (view(dx1.getValue()).row(7) - view(dx2.getValue()).row(2));
    view(*df1.beginEdit()).row(7) += force;
    view(*df2.beginEdit()).row(2) -= force;
  }
  void buildStiffnessMatrix(sofa::core::behavior::StiffnessMatrix*) override {}
  void buildDampingMatrix(sofa::core::behavior::DampingMatrix*) override {}
  SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord&, const DataVecCoord&) const override {
    return 0;
  }

  static constexpr double kStiffness = 300;  // [N/m]
};

TEST_F(MultigridSolver, SolvesSeveralStatesAsOneSystem) {
  BaseContext& another = tissue.add_child("another");
  auto& others = another.add(New<MechanicalState>::make(), "nodes");
  for (auto field : {others.writePositions(), others.writeVelocities()}) field.resize(5);
  another.add(New<Weights>::make(), "weights").init();
  const PointArray load = random.field(5, 1);
  view(*others.write(1)->beginEdit()) = load;
  auto& joint = tissue.add(New<Joint>::make(), "joint");
  joint.mstate1.set(&nodes);
  joint.mstate2.set(&others);

  const PointArray found = solve();
  // by elimination of the other state, of which node 2 alone feels the joint
  const double k = -kStiffnessFactor * Joint::kStiffness, m = Weights::of(2);
  view(*nodes.write(1)->beginEdit()).row(7) += k / (m + k) * load.row(2);
  const PointArray x = expected(Joint::kStiffness * m / (m + k));
  EXPECT_TRUE(support::agrees(found, x, 1e-9)) << said();
  for (int n = 0; n < 5; ++n) {
    const Eigen::RowVector3d of_other =
        n == 2 ? Eigen::RowVector3d((load.row(2) + k * x.row(7)) / (m + k)) : load.row(n) / Weights::of(n);
    EXPECT_LE((view(others.read(0)->getValue()).row(n) - of_other).norm(), 1e-8 * of_other.norm()) << n;
  }
}

/// Multipliers, as a solver of constraints passes them on.
struct Multipliers final : sofa::linearalgebra::BaseVector {
  SReal element(long i) const override { return i == 1 ? 2.0 : i == 4 ? -0.5 : 0; }
};

// Of five constraints two act on this body.
TEST_F(MultigridSolver, GivesComplianceAndMotionToConstraintCorrections) {
  const auto fill = [](sofa::linearalgebra::BaseMatrix& J) {
    for (int axis = 0; axis < 3; ++axis) J.add(1, 3 * 9 + axis, 0.3 - axis);
    J.add(4, 3 * 9, 1);
    J.add(4, 3 * 20 + 2, -0.7);
  };
  sofa::linearalgebra::SparseMatrix<SReal> J;
  J.resize(5, 3 * mesh.num_nodes());
  fill(J);
  Eigen::Matrix2d W;
  PointArray motion = PointArray::Zero(mesh.num_nodes(), 3), force = motion, load = motion;
  for (const auto& [i, line] : J) {
    load.setZero();
    for (const auto& [column, value] : line) load(column / 3, column % 3) = value;
    view(*nodes.write(1)->beginEdit()) = load;
    const PointArray x = expected();
    motion += Multipliers().element(i) * x;
    force += Multipliers().element(i) * load;
    for (const auto& [j, other] : J) {
      W(i / 3, j / 3) = 0;
      for (const auto& [column, value] : other) W(i / 3, j / 3) += value * x(column / 3, column % 3);
    }
  }

  solve({{"tolerance", "1e-9"}});
  auto& asked = dynamic_cast<MatrixLinearSolver<GraphScatteredMatrix, GraphScatteredVector>&>(*solver);
  auto& system = *asked.getLinearSystem();
  system.matrix.mparams.setMFactor(1);
  system.matrix.mparams.setBFactor(kDampingFactor);
  system.matrix.mparams.setKFactor(kStiffnessFactor);
  const auto agrees = [&](const DenseMatrix& found, double factor, double on_diagonal) {
    Eigen::Matrix2d of_rows;
    of_rows << found.values(1, 1), found.values(1, 4), found.values(4, 1), found.values(4, 4);
    EXPECT_LE((of_rows - factor * W - on_diagonal * Eigen::Matrix2d::Identity()).norm(), 0.01 * factor * W.norm());
    EXPECT_NEAR(found.values.norm(), of_rows.norm(), 1e-12 * of_rows.norm()) << "the other constraints are not ours";
  };
  DenseMatrix found(5), of_generic(5);
  EXPECT_TRUE(asked.addJMInvJt(&found, &J, 0.02)) << said();
  agrees(found, 0.02, 0);

  // LinearSolverConstraintCorrection goes on with a force
  view(*nodes.write(1)->beginEdit()) = force;
  asked.solve(system.matrix, *system.getSolutionVector(), *system.getRHSVector());
  EXPECT_TRUE(support::agrees(PointArray(view(nodes.read(0)->getValue())), motion, 1e-3)) << said();

  // GenericConstraintCorrection with multipliers
  using Visitor = sofa::simulation::mechanicalvisitor::MechanicalGetConstraintJacobianVisitor;
  Visitor::constraints() = fill;
  sofa::core::ConstraintParams cparams;
  cparams.setLambda(sofa::core::MultiVecDerivId(5));
  EXPECT_TRUE(asked.buildComplianceMatrix(&cparams, &of_generic, 0.02, 7)) << said();
  agrees(of_generic, 0.02, 7);
  const Multipliers multipliers;
  asked.applyConstraintForce(&cparams, sofa::core::MultiVecDerivId(6), &multipliers);
  EXPECT_TRUE(support::agrees(PointArray(view(nodes.read(6)->getValue())), motion, 1e-3)) << said();
  EXPECT_TRUE(support::agrees(PointArray(view(nodes.read(5)->getValue())), force, 1e-12));
  Visitor::constraints() = nullptr;

  J.resize(5, 3);
  J.add(1, 0, 1);
  EXPECT_FALSE(asked.addJMInvJt(&found, &J, 0.02));
  EXPECT_NE(said().find("is not that of its MechanicalObject"), std::string::npos) << said();
}

TEST_F(MultigridSolver, RefusesBadValues) {
  EXPECT_THROW(solve({{"tolerance", "0"}}), std::runtime_error) << "without it there is no motion to go on with";
  EXPECT_TRUE(solver->isComponentStateInvalid());
  EXPECT_NE(said().find("MultigridCGLinearSolver.tolerance"), std::string::npos) << said();
  solver->reset();
  EXPECT_TRUE(solver->isComponentStateInvalid()) << "reset reads no Data";
  solver->findData("tolerance")->read("1e-11");
  solver->reinit();
  EXPECT_FALSE(solver->isComponentStateInvalid());
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
