// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <span>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::in_root;
using support::read_and_init;

// A bar of 2 x 2 x 5 hexahedra, held at one end, pulled aside at the other.
std::string pulled_bar(const std::string& ode_solver, const std::string& linear_solver) {
  return "<Node dt='0.02' gravity='0 -3 0'><DefaultAnimationLoop/>" + ode_solver + linear_solver +
         "<RegularGridTopology n='3 3 6' min='0 0 0' max='0.2 0.2 0.5'/><MechanicalObject name='nodes'/>"
         "<DiagonalMass massDensity='1000'/><BoxROI name='end' box='-1 -1 -.01  1 1 .01'/>"
         "<BoxROI name='far' box='-1 -1 .49  1 1 .51'/><FixedProjectiveConstraint indices='@end.indices'/>"
         "<ConstantForceField indices='@far.indices' totalForce='6 2 -3'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='2e4' poissonRatio='0.4' yieldStress='300' "
         "plasticFlowRate='4' rayleighStiffness='0.01'/></Node>";
}

PointArray end_of_run(const std::string& ode_solver, const std::string& linear_solver, int steps = 25) {
  scene::Scene scene = read_and_init(pulled_bar(ode_solver, linear_solver));
  for (int k = 0; k < steps; ++k) scene.step();
  return at<scene::MechanicalState>(scene, "nodes").positions();
}

const std::vector<std::string> kExactSolvers = {
    "<EigenSimplicialLDLT/>",
    "<EigenSimplicialLLT template='CompressedRowSparseMatrixMat3x3d'/>",
    "<EigenSparseLU/>",
    "<EigenSparseQR/>",
    "<CholeskySolver/>",
    "<SVDLinearSolver/>",
    "<LULinearSolver template='FullMatrix'/>",
    "<AsyncSparseLDLSolver/>",
    "<PrecomputedLinearSolver use_file='false'/>",
    "<MatrixLinearSystem name='system'/><SparsePARDISOSolver linearSystem='@system'/>",
    "<MinResLinearSolver iterations='2000' tolerance='1e-14'/>",
    "<ParallelCGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30'/>",
    "<PCGLinearSolver iterations='2000' tolerance='1e-26' preconditioner='@p'/><JacobiPreconditioner name='p'/>",
    "<PCGLinearSolver iterations='2000' tolerance='1e-26' preconditioner='@p'/><BlockJacobiPreconditioner name='p'/>",
    "<PCGLinearSolver iterations='2000' tolerance='1e-26' preconditioner='@p'/><SSORPreconditioner name='p' "
    "omega='1.2'/>",
    "<PCGLinearSolver iterations='2000' tolerance='1e-26' preconditioner='@p'/><WarpPreconditioner name='p'/>",
    "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30'/>",
    "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30' warmStart='true'/>",
    "<PCGLinearSolver iterations='2000' tolerance='1e-26'/>",
    "<PCGLinearSolver name='pcg' tolerance='1e-26' preconditioner='@direct'/><SparseLDLSolver name='direct'/>"};

// Time integration, equilibrium, and every linear solver: the same trajectory, up to what the solvers leave.
TEST(SolverPairs, GiveTheSameTrajectory) {
  const std::vector<std::string> ode_solvers = {
      "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.1'/>",
      "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.05' trapezoidalScheme='true' vdamping='0.3'/>",
      "<EulerImplicitSolver firstOrder='true'/>",
      "<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='40' maxNbIterationsLineSearch='3' "
      "absoluteResidualStoppingThreshold='1e-9' relativeSuccessiveStoppingThreshold='0' "
      "relativeInitialStoppingThreshold='0'/>"};
  for (const std::string& ode_solver : ode_solvers) {
    const int steps = ode_solver.starts_with("<Static") ? 3 : 25;
    const PointArray reference = end_of_run(ode_solver, "<SparseLDLSolver/>", steps);
    EXPECT_GT(support::max_abs(reference - end_of_run(ode_solver, "<SparseLDLSolver/>", steps - 1)), 1e-5)
        << ode_solver << " does not move";
    for (const std::string& linear_solver : kExactSolvers)
      EXPECT_LE(support::max_abs(end_of_run(ode_solver, linear_solver, steps) - reference), 1e-9)
          << ode_solver << linear_solver;
  }
}

// |r| / |b| of one iteration of conjugate gradients lies well above that of a hundred.
TEST(CGLinearSolver, StopsAtItsIterationsAndSaysSo) {
  scene::Scene scene = read_and_init(
      pulled_bar("<EulerImplicitSolver/>", "<CGLinearSolver iterations='7' tolerance='1e-12' threshold='1e-30'/>"));
  const SolveReport report = scene.step();
  EXPECT_EQ(report.iterations, 7);
  EXPECT_FALSE(report.converged);
  EXPECT_GT(report.residual, 1e-12);
}

TEST(PCGLinearSolver, WithAnExactPreconditionerNeedsOneIteration) {
  const std::string direct = "<SparseLDLSolver name='direct'/>";
  scene::Scene with =
      read_and_init(pulled_bar("<EulerImplicitSolver linearSolver='@pcg'/>",
                               direct + "<PCGLinearSolver name='pcg' tolerance='1e-16' preconditioner='@direct'/>"));
  EXPECT_EQ(with.step().iterations, 1);
  scene::Scene without = read_and_init(
      pulled_bar("<EulerImplicitSolver linearSolver='@pcg'/>",
                 direct + "<PCGLinearSolver name='pcg' tolerance='1e-16' preconditioner='@direct' use_precond='0'/>"));
  EXPECT_GT(without.step().iterations, 10);
  EXPECT_EQ(errors_of(pulled_bar("<EulerImplicitSolver/>",
                                 "<PCGLinearSolver preconditioner='@cg'/><CGLinearSolver name='cg'/>")),
            "test.scn:1: error: PCGLinearSolver.preconditioner: the link leads to CGLinearSolver 'cg', must lead to a "
            "direct solver or a preconditioner");
}

TEST(Preconditioners, TakeAsManyIterationsAsTheyAreGood) {
  const auto iterations = [](const std::string& preconditioner) {
    scene::Scene scene = read_and_init(
        pulled_bar("<EulerImplicitSolver/>",
                   "<PCGLinearSolver iterations='500' tolerance='1e-16' preconditioner='@p'/>" + preconditioner));
    return scene.step().iterations;
  };
  const int of_diagonal = iterations("<JacobiPreconditioner name='p'/>");
  EXPECT_LT(iterations("<SSORPreconditioner name='p'/>"), of_diagonal);
  EXPECT_EQ(iterations("<WarpPreconditioner name='p' linearSolver='@d'/><SparseLDLSolver name='d'/>"), 1);
  EXPECT_EQ(iterations("<WarpPreconditioner name='p' linearSolver='@d'/><JacobiPreconditioner name='d'/>"),
            of_diagonal);
}

TEST(Preconditioners, AreNoSolvers) {
  EXPECT_EQ(errors_of(pulled_bar("<EulerImplicitSolver/>", "<JacobiPreconditioner/>")),
            "test.scn:1: error: JacobiPreconditioner: is a preconditioner, must be linked to by a PCGLinearSolver, "
            "behind which it stands in the node");
  EXPECT_EQ(errors_of(pulled_bar("<EulerImplicitSolver/>",
                                 "<PCGLinearSolver name='pcg' preconditioner='@w'/><WarpPreconditioner name='w' "
                                 "linearSolver='@pcg'/>")),
            "test.scn:1: error: WarpPreconditioner.linearSolver: the link leads to PCGLinearSolver 'pcg', must lead to "
            "a direct solver or a preconditioner");
}

TEST(MatrixLinearSystem, MustBeWhole) {
  EXPECT_EQ(errors_of(pulled_bar("<EulerImplicitSolver/>",
                                 "<MatrixLinearSystem name='K' assembleMass='false'/><SparseLDLSolver "
                                 "linearSystem='@K'/>")),
            "test.scn:1: error: SparseLDLSolver.linearSystem: the link leads to MatrixLinearSystem 'K', which leaves "
            "out a part of the matrix");
}

const std::vector<std::string> kExplicit = {"<EulerExplicitSolver/>", "<EulerExplicitSolver symplectic='false'/>",
                                            "<RungeKutta2Solver/>", "<RungeKutta4Solver/>",
                                            "<CentralDifferenceSolver/>"};

// A plastic body flows once per step, whatever moves it: short steps of all integrators end at the same shape.
TEST(ExplicitSolvers, MovePlasticBodies) {
  const auto end = [](const std::string& integrator) {
    std::string text = pulled_bar(integrator, "");
    const std::string step = "dt='0.02'", damping = " rayleighStiffness='0.01'";
    text.replace(text.find(step), step.size(), "dt='0.0004'");
    text.erase(text.find(damping), damping.size());
    scene::Scene scene = read_and_init(text);
    for (int k = 0; k < 250; ++k) scene.step();
    const std::vector<scene::ForceField*> fields = scene.root().all<scene::ForceField>();
    double dissipated = 0;
    for (const scene::ForceField* field : fields)
      if (field->body()) dissipated += field->body()->dissipated_energy();
    EXPECT_GT(dissipated, 0) << integrator << ": nothing flows";
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  const PointArray reference = end("<RungeKutta4Solver/>");
  for (const std::string& integrator : kExplicit)
    EXPECT_LT(support::max_abs(end(integrator) - reference), 2e-4) << integrator;
}

TEST(ExplicitSolvers, WarnWhereVibrationsGrow) {
  const auto warnings = [](const std::string& integrator, const std::string& dt) {
    std::string text = pulled_bar(integrator, "");
    text.replace(text.find("dt='0.02'"), 9, "dt='" + dt + "'");
    scene::Scene scene = read_and_init(text);
    int count = 0;
    for (const scene::Message& message : scene.diagnostics().take_warnings())
      count += scene::format(message).find("they grow from step to step") != std::string::npos;
    return count;
  };
  for (const std::string integrator :
       {"<EulerExplicitSolver/>", "<CentralDifferenceSolver/>", "<RungeKutta4Solver/>"}) {
    EXPECT_EQ(warnings(integrator, "0.05"), 1) << integrator;
    EXPECT_EQ(warnings(integrator, "0.0005"), 0) << integrator;
  }
  EXPECT_EQ(warnings("<RungeKutta2Solver/>", "0.05"), 0);
}

TEST(ExplicitSolvers, NeedMassesThatDoNotCoupleNodes) {
  const auto errors = [](const std::string& integrator, const std::string& mass) {
    return errors_of("<Node><DefaultAnimationLoop/>" + integrator +
                     "<RegularGridTopology n='2 2 2'/><MechanicalObject/>" + mass + "</Node>");
  };
  for (const std::string& integrator : kExplicit) {
    EXPECT_EQ(errors(integrator, "<MeshMatrixMass lumping='1'/>"), "");
    EXPECT_NE(errors(integrator, "<MeshMatrixMass/>").find("masses couple nodes: needs masses with lumping"),
              std::string::npos)
        << integrator;
    EXPECT_NE(errors(integrator, "").find("no mass on MechanicalObject"), std::string::npos);
  }
  EXPECT_EQ(errors("<EulerExplicitSolver/><SparseLDLSolver/>", "<MeshMatrixMass/>"), "");
}

TEST(NewmarkImplicitSolver, GoesOnFromACheckpointAndBeginsAnew) {
  const std::string text = pulled_bar("<NewmarkImplicitSolver rayleighMass='0.1'/>", "<SparseLDLSolver/>");
  scene::Scene first = read_and_init(text), second = read_and_init(text);
  for (int k = 0; k < 3; ++k) first.step();
  std::vector<std::byte> bytes;
  Archive out([&](const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  });
  first.serialize(out);
  Archive in{std::span<const std::byte>(bytes)};
  second.serialize(in);
  const auto after = [](scene::Scene& scene, int steps) {
    for (int k = 0; k < steps; ++k) scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  EXPECT_EQ(after(first, 3), after(second, 3));
  second.reset();
  EXPECT_EQ(after(second, 6), after(first, 0));
}

TEST(FreeMotionAnimationLoop, IsTheDefaultOneWhereNothingTouches) {
  const auto end = [](const std::string& loop) {
    std::string text = pulled_bar("<EulerImplicitSolver/>", "<SparseLDLSolver/>");
    const std::string written = "<DefaultAnimationLoop/>";
    text.replace(text.find(written), written.size(), loop);
    scene::Scene scene = read_and_init(text);
    for (int k = 0; k < 5; ++k) scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  EXPECT_EQ(end("<FreeMotionAnimationLoop parallelODESolving='true'/>"), end("<DefaultAnimationLoop/>"));
}

// The settings of SOFA before there was a NewtonRaphsonSolver.
TEST(StaticSolver, TakesItsOldSettings) {
  const PointArray old = end_of_run(
      "<StaticSolver newton_iterations='12' absolute_residual_tolerance_threshold='1e-7' "
      "relative_residual_tolerance_threshold='1e-6' absolute_correction_tolerance_threshold='1e-12' "
      "relative_correction_tolerance_threshold='1e-11'/>",
      "<SparseLDLSolver/>", 2);
  const PointArray present = end_of_run(
      "<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='12' absoluteResidualStoppingThreshold='1e-7' "
      "relativeInitialStoppingThreshold='1e-6' absoluteEstimateDifferenceThreshold='1e-12' "
      "relativeEstimateDifferenceThreshold='1e-11'/>",
      "<SparseLDLSolver/>", 2);
  EXPECT_EQ(old, present);
  EXPECT_GT(support::max_abs(old - end_of_run("<StaticSolver/>", "<SparseLDLSolver/>", 2)), 1e-6);
}

double fall(const std::string& attributes, double velocity) {
  scene::Scene scene =
      read_and_init("<Node dt='0.5' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver " + attributes +
                    "/><SparseLDLSolver/><MechanicalObject name='nodes' position='0 0 7' velocity='0 0 " +
                    std::to_string(velocity) + "'/><UniformMass vertexMass='3'/></Node>");
  for (int k = 0; k < 2; ++k) scene.step();
  return at<scene::MechanicalState>(scene, "nodes").positions()(0, 2);
}

// Two steps of h = .5 with v0 = 2, g = -10: v1 = -3, then v decays or not, v2 = v1 - 5.
TEST(EulerImplicitSolver, AFreeMassFollowsTheDiscreteLawOfEachScheme) {
  EXPECT_DOUBLE_EQ(fall("", 2), 7 + 0.5 * (-3 - 8));
  EXPECT_NEAR(fall("vdamping='0.8'", 2), 7 + 0.5 * (-3 + (-3 * std::exp(-0.4) - 5)), 1e-14);
  double v = 2, z = 7;
  for (int k = 0; k < 2; ++k) {
    v += 0.5 * (-10 - 0.4 * v) / (1 + 0.25 * 0.4);
    z += 0.5 * v;
  }
  EXPECT_DOUBLE_EQ(fall("rayleighMass='0.4' trapezoidalScheme='true'", 2), z);
  EXPECT_DOUBLE_EQ(fall("firstOrder='true' rayleighMass='0.4'", 2), 7 - 2 * 0.5 * 10);
}

/// A slab of 10 x 10 x 3 hexahedra, held at one side and falling, and what acts beside it; `mass` and `precision` as in
/// scenes.
std::string slab(const std::string& beside, const std::string& mass = "<DiagonalMass massDensity='1000'/>",
                 const std::string& precision = "double", const std::string& preconditioner = "multigrid") {
  return "<Node dt='0.01' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='0.1' "
         "rayleighStiffness='0.01'/><MultigridCGLinearSolver name='solver' tolerance='1e-6' preconditioner='" +
         preconditioner +
         "'/><RegularGridTopology name='grid' n='11 11 4' min='0 0 0' max='0.1 0.1 0.03'/>"
         "<MechanicalObject name='nodes'/>" +
         mass +
         "<BoxROI name='end' box='-1 -1 -1  1e-6 1 1'/><FixedProjectiveConstraint indices='@end.indices'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='1e5' poissonRatio='0.45' precision='" +
         precision + "'/>" + beside + "</Node>";
}

const std::string kGrip = "<GraspForceField radius='0.02' keyTimes='0 0.1' positions='.1 .05 .03  .12 .06 .06' ";

// The first five steps, in which a grip reaches its greatest force.
int max_iterations(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  int max = 0;
  for (int k = 0; k < 5; ++k) {
    const SolveReport report = scene.step();
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.residual, 1e-6);
    EXPECT_EQ(report.preconditioner, PreconditionedBy::kMultigrid);
    max = std::max(max, report.iterations);
  }
  return max;
}

TEST(MultigridCGLinearSolver, StaysWhateverActsBesideTheBody) {
  for (const std::string precision : {"double", "mixed"}) {
    const std::string lumped = "<DiagonalMass massDensity='1000'/>",
                      consistent = "<MeshMatrixMass massDensity='1000'/>";
    const int alone = max_iterations(slab("", lumped, precision));
    for (const std::string& beside :
         {std::string("<PlaneForceField normal='0 0 1' d='1e-4' stiffness='50'/>"),
          std::string("<PlaneForceField normal='.36 .48 .8' d='.04' stiffness='50'/>"),
          kGrip + "stiffness='50' maxForce='.02'/>", std::string("<UniformVelocityDampingForceField implicit='true'/>"),
          std::string("<Node><MechanicalObject position='.07 .05 .031  .08 .03 .02'/><BarycentricMapping/><UniformMass "
                      "totalMass='.05'/><PlaneForceField normal='0 0 1' d='.1' stiffness='20'/></Node>")})
      EXPECT_LE(max_iterations(slab(beside, lumped, precision)), 1.5 * alone) << precision << beside;
    EXPECT_LE(max_iterations(slab("", consistent, precision)), 1.5 * alone) << precision;
  }
}

TEST(MultigridCGLinearSolver, IsTheSameToTheLastBitBesideWhatActsNowhere) {
  const auto end = [](const std::string& beside) {
    scene::Scene scene = read_and_init(slab(beside));
    support::run(scene, 3);
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  const PointArray alone = end("");
  for (const std::string& beside :
       {std::string("<PlaneForceField normal='.36 .48 .8' d='-10' stiffness='1e5'/>"),
        kGrip + "stiffness='50' graspTime='10'/>",
        std::string("<Node><MechanicalObject position='.07 .05 .031'/><BarycentricMapping/><PlaneForceField d='-10' "
                    "stiffness='1e5'/></Node>")})
    EXPECT_EQ(end(beside), alone) << beside;
}

TEST(MultigridCGLinearSolver, SaysOnceThatABodyHasNoCoarseMeshes) {
  const auto warnings = [](const std::string& preconditioner) {
    std::string text = slab("", "<UniformMass totalMass='1'/>", "double", preconditioner);
    const std::string grid = "n='11 11 4'";
    scene::Scene scene = read_and_init(text.replace(text.find(grid), grid.size(), "n='3 3 3'"));
    scene.diagnostics().take_warnings();
    support::run(scene, 3);
    return scene.diagnostics().take_warnings();
  };
  ASSERT_EQ(warnings("multigrid").size(), 1u);
  EXPECT_TRUE(warnings("auto").empty());
}

TEST(Solvers, DirectAndIterativeAgree) {
  const auto positions = [](const std::string& solver) {
    scene::Scene scene = read_and_init(
        "<Node dt='0.02'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
        "<RegularGridTopology n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='100'/>"
        "<HexahedronElastoplasticFEMForceField/><FixedProjectiveConstraint indices='0 3 6 9'/></Node>");
    for (int i = 0; i < 10; ++i) scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  const PointArray direct = positions("<SparseLDLSolver/>");
  EXPECT_LT((positions("<CGLinearSolver iterations='500' tolerance='1e-14' threshold='1e-40'/>") - direct).norm(),
            1e-10);
  EXPECT_GT((direct - PointArray(PointArray::Zero(12, 3))).norm(), 1);
}

TEST(Solvers, OneStateAndAMassAreNeeded) {
  EXPECT_EQ(errors_of(in_root("", "<MechanicalObject position='0 0 0'/>")),
            "test.scn:1: error: EulerImplicitSolver: no mass on MechanicalObject 'MechanicalObject1' of its node and "
            "below");
  EXPECT_EQ(
      errors_of("<Node><EulerImplicitSolver/><MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/></Node>"),
      "test.scn:1: error: EulerImplicitSolver: needs a LinearSolver in its node or above");
}

}  // namespace
