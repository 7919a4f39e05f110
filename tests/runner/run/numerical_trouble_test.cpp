// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbers beyond all bounds end a run in the step that makes them, and no file ever holds one; so does what a component
// refuses; a solver that comes to no end is stopped, counted and reported.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace {

using namespace hexaplast;

class Overflow : public support::Command {
 protected:
  support::Outcome run(const std::string& overrides) {
    return hexaplast("run '" HEXAPLAST_SOURCE_DIR
                     "/scenes/bar_stretch_low.scn' --out run --force --frames 0 --quiet "
                     "--steps 12 --checkpoint every=1 " +
                     overrides);
  }

  /// Every number that the run has left as text; only "nan" and "inf" have letters n.
  std::string numbers() const {
    const std::string table = support::content(directory_ / "run/history.csv");
    return table.substr(table.find('\n'));
  }
};

TEST_F(Overflow, EndsTheRunAndIsNeverWritten) {
  for (const char* overrides :
       {"--set '.gravity=0 0 1e110'", "--set '.gravity=0 0 1e155'", "--set '.gravity=0 0 1e300'",
        "--set 'bar/pullUp.forces=0 0 0 0 0 1e120 0 0 1e120 0 0 0'", "--set bar/material.youngModulus=1e308"}) {
    const support::Outcome outcome = run(overrides);
    EXPECT_EQ(outcome.code, 4) << overrides << ": " << outcome.err;
    EXPECT_NE(outcome.err.find("not finite"), std::string::npos) << overrides << ": " << outcome.err;
    EXPECT_EQ(numbers().find('n'), std::string::npos) << overrides;
  }
}

// The force grows without bounds from step 7 on.
TEST_F(Overflow, LeavesACheckpointOfTheLastGoodStep) {
  const support::Outcome outcome =
      run("--set 'bar/pullUp.times=-0.01 0.045 0.055' --set 'bar/pullUp.forces=0 0 0 0 0 1 0 0 1e140'");
  EXPECT_EQ(outcome.code, 4);
  const std::string failed = outcome.err.substr(outcome.err.find("step "), 7);
  EXPECT_NE(failed, "step 1 ") << outcome.err;
  EXPECT_EQ(numbers().find('n'), std::string::npos);
  const support::Outcome resumed = hexaplast("resume run --quiet");
  EXPECT_EQ(resumed.code, 4);
  EXPECT_NE(resumed.err.find(failed), std::string::npos) << resumed.err << outcome.err;
}

class Refusal : public support::Command {};

// A component refuses an attribute that changes at the beginning of the third step.
TEST_F(Refusal, LeavesTheStateOfTheLastGoodStep) {
  write("refuses.scn", R"(<Node dt="0.1" gravity="0 0 -5"><DefaultAnimationLoop/>
  <EulerImplicitSolver/><SparseLDLSolver/>
  <AttributeChange component="@body" attribute="plasticFlowRate" keyTimes="0.2" values="1000"/>
  <RegularGridTopology n="4 2 2" max="3 1 1"/><MechanicalObject/><DiagonalMass massDensity="10"/>
  <HexahedronElastoplasticFEMForceField name="body" youngModulus="5000" yieldStress="10" plasticFlowRate="1"
      restShape="joined"/>
  <FixedProjectiveConstraint indices="0 4 8 12"/>
</Node>)");
  const support::Outcome outcome = hexaplast("run refuses.scn --steps 6 --out run --frames 0 --quiet");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("plasticFlowRate"), std::string::npos) << outcome.err;
  EXPECT_TRUE(exists(directory_ / "run/mesh_000002.vtu"));
  EXPECT_TRUE(exists(directory_ / "run/plot.svg"));
}

// What a scene has warned of by then, here of a step that goes well and of the one that fails, may explain the failure.
TEST_F(Refusal, ComesAfterTheWarningsOfTheRun) {
  write("warns.scn", R"(<Node dt="0.01" gravity="0 0 -9.81"><DefaultAnimationLoop/>
  <EulerImplicitSolver/><MultigridCGLinearSolver/>
  <AttributeChange component="@ball" attribute="active" keyTimes="0.02" values="1"/>
  <AttributeChange component="@body" attribute="plasticFlowRate" keyTimes="0.04" values="1000"/>
  <RegularGridTopology n="4 2 2" max="0.03 0.01 0.01"/><MechanicalObject/><DiagonalMass massDensity="1000"/>
  <HexahedronElastoplasticFEMForceField name="body" youngModulus="5000" yieldStress="1e9" plasticFlowRate="1"
      restShape="joined"/>
  <FixedProjectiveConstraint indices="0 4 8 12"/>
  <InstrumentContactForceField name="ball" active="0" radius="0.01" keyTimes="0" positions="0.03 0.005 0.012"/>
</Node>)");
  write("damped.scn", R"(<Node dt="0.5" gravity="0 0 -9"><DefaultAnimationLoop/>
  <EulerImplicitSolver/><CGLinearSolver threshold="0"/>
  <RegularGridTopology n="4 2 2" max="3 1 1"/><MechanicalObject/><DiagonalMass massDensity="10"/>
  <HexahedronElastoplasticFEMForceField youngModulus="500"/><FixedProjectiveConstraint indices="0 4 8 12"/>
  <SpringForceField indices1="7 15" indices2="3 11" stiffness="1" damping="1000" lengths="1"/>
</Node>)");
  for (const auto& [scene, warning, error] :
       {std::tuple("warns", "becomes active ", "plasticFlowRate"),
        std::tuple("damped", "SpringForceField.damping: throws nodes back", ": error: step ")}) {
    const support::Outcome outcome =
        hexaplast("run " + std::string(scene) + ".scn --steps 40 --out " + scene + " --frames 0");
    EXPECT_NE(outcome.code, 0);
    EXPECT_LT(outcome.err.find(warning), outcome.err.find(error)) << outcome.err;
    EXPECT_NE(outcome.err.find(error), std::string::npos) << outcome.err;
    const nlohmann::json warnings =
        nlohmann::json::parse(support::content(directory_ / scene / "manifest.json")).at("warnings");
    EXPECT_NE(warnings.dump().find(warning), std::string::npos) << warnings;
  }
}

class Stall : public support::Command {};

TEST_F(Stall, IsCountedAndReported) {
  std::string scene = support::content(HEXAPLAST_SOURCE_DIR "/scenes/bar_stretch_low.scn");
  const std::string direct = "<SparseLDLSolver template=\"CompressedRowSparseMatrixMat3x3d\"/>";
  ASSERT_NE(scene.find(direct), std::string::npos);
  scene.replace(scene.find(direct), direct.size(), "<CGLinearSolver iterations='2' tolerance='1e-12' threshold='0'/>");
  write("stalls.scn", scene);
  const support::Outcome outcome = succeeds("run stalls.scn --steps 7 --summary summary.json");
  EXPECT_NE(outcome.err.find("the linear solver stopped before its tolerance in 7 of 7 steps"), std::string::npos)
      << outcome.err;
  std::ifstream in(directory_ / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(in);
  EXPECT_EQ(summary["stalled_solves"], 7);
  EXPECT_EQ(hexaplast("run stalls.scn --steps 7 --strict --quiet").code, 4);
  EXPECT_EQ(summary["preconditioner"], "none");
}

/// A piece of tissue of some grams, held at x = 0, that sags.
std::string tissue(const std::string& solvers) {
  return "<Node dt='.01' gravity='0 0 -9.81'><RunSettings steps='20'/><DefaultAnimationLoop/>" + solvers +
         "<RegularGridTopology n='5 3 3' max='.04 .02 .02'/><MechanicalObject/><DiagonalMass massDensity='1000'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='5000'/><FixedProjectiveConstraint indices='0 5 10 15 20 "
         "25 30 35 40'/></Node>";
}

// The default threshold of SOFA's solver is an absolute number, below which steps of tissue lie.
TEST_F(Stall, AtTheThresholdIsNotTakenForASolution) {
  write("plain.scn", tissue("<EulerImplicitSolver/><CGLinearSolver/>"));
  const support::Outcome checked = succeeds("check plain.scn");
  EXPECT_NE(checked.err.find("stops at its threshold above its tolerance: set threshold=\"0\" or use "
                             "MultigridCGLinearSolver"),
            std::string::npos)
      << checked.err;
  const support::Outcome outcome = succeeds("run plain.scn --summary summary.json");
  std::ifstream in(directory_ / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(in);
  const long steps = summary["threshold_solves"];
  EXPECT_GE(steps, 10);
  EXPECT_NE(
      outcome.err.find("the linear solver stopped at its threshold above its tolerance in " + std::to_string(steps) +
                       " of 20 steps: set threshold=\"0\" or use MultigridCGLinearSolver"),
      std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.out.find("not solved"), std::string::npos) << outcome.out;
  EXPECT_EQ(hexaplast("run plain.scn --strict --quiet").code, 4);

  // a threshold is met in silence neither later nor by Newton's iterations
  write("later.scn", tissue("<EulerImplicitSolver/><CGLinearSolver threshold='1e-10'/>"));
  EXPECT_EQ(hexaplast("run later.scn --strict --quiet").code, 4);
  write("static.scn", tissue("<StaticSolver/><NewtonRaphsonSolver absoluteResidualStoppingThreshold='1'/>"
                             "<CGLinearSolver iterations='500' threshold='0'/>"));
  for (const char* command : {"check", "run"})
    EXPECT_NE(hexaplast(std::string(command) + " static.scn").err.find("lie below Newton's "), std::string::npos);

  write("solved.scn", tissue("<EulerImplicitSolver/><CGLinearSolver iterations='500' threshold='0'/>"));
  EXPECT_EQ(hexaplast("check solved.scn").err.find("threshold"), std::string::npos);
  succeeds("run solved.scn --strict --quiet");
}

TEST_F(Stall, OfNewtonIsNotThatOfTheLinearSolver) {
  write("static.scn", tissue("<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='2' "
                             "relativeSuccessiveStoppingThreshold='1e-12' relativeInitialStoppingThreshold='1e-12' "
                             "absoluteResidualStoppingThreshold='1e-12'/><SparseLDLSolver/>"));
  const support::Outcome outcome = hexaplast("run static.scn --steps 1 --strict");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_NE(outcome.err.find("Newton's iterations stopped before their thresholds in 1 of 1 steps"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.err.find("linear solver"), std::string::npos) << outcome.err;
}

}  // namespace
