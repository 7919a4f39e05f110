// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbers beyond all bounds end a run in the step that makes them, and no file ever holds one; so does what a component
// refuses; a solver that comes to no end is stopped, counted and reported.
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

class Overflow : public Command {
 protected:
  /// The run fails with that message; what it has written are numbers.
  Outcome fails_with(const std::string& overrides, const std::string& message) {
    Outcome outcome = fails("run '" HEXAPLAST_SOURCE_DIR
                            "/scenes/bar_stretch_low.scn' --out run --force --frames 0 --quiet --steps 12 "
                            "--checkpoint every=1 " +
                                overrides,
                            4, message);
    const std::string table = read("run/history.csv");
    EXPECT_FALSE(has(table.substr(table.find('\n')), "n")) << "only nan and inf have letters n";
    return outcome;
  }
};

TEST_F(Overflow, EndsTheRunAndIsNeverWritten) {
  for (const char* overrides :
       {"--set '.gravity=0 0 1e110'", "--set '.gravity=0 0 1e155'", "--set '.gravity=0 0 1e300'",
        "--set 'bar/pullUp.forces=0 0 0 0 0 1e120 0 0 1e120 0 0 0'", "--set bar/material.youngModulus=1e308"})
    fails_with(overrides, "not finite");
}

// The force grows without bounds from step 7 on.
TEST_F(Overflow, LeavesACheckpointOfTheLastGoodStep) {
  const Outcome outcome =
      fails_with("--set 'bar/pullUp.times=-0.01 0.045 0.055' --set 'bar/pullUp.forces=0 0 0 0 0 1 0 0 1e140'", "step ");
  const std::string failed = outcome.err.substr(outcome.err.find("step "), 7);
  EXPECT_NE(failed, "step 1 ") << outcome.err;
  fails("resume run --quiet", 4, failed);
}

class Refusal : public Command {};

// What a scene has warned of by then, here of a step that goes well and of the one that fails, may explain the failure.
// In the first one a component refuses an attribute that changes at the beginning of the fifth step.
TEST_F(Refusal, ComesAfterTheWarningsOfTheRunAndLeavesTheStateOfTheLastGoodStep) {
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
    const Outcome outcome = hexaplast(std::string("run ") + scene + ".scn --steps 40 --out " + scene + " --frames 0");
    EXPECT_EQ(outcome.code, scene == std::string("warns") ? 3 : 4);
    EXPECT_LT(outcome.err.find(warning), outcome.err.find(error)) << outcome.err;
    EXPECT_TRUE(has(outcome.err, error));
    EXPECT_TRUE(has(manifest(scene).at("warnings").dump(), warning));
  }
  EXPECT_TRUE(is_there("warns/mesh_000004.vtu") && is_there("warns/plot.svg"));
}

class Stall : public Command {};

/// A piece of tissue of some grams, held at x = 0, that sags.
std::string tissue(const std::string& solvers) {
  return "<Node dt='.01' gravity='0 0 -9.81'><RunSettings steps='20'/><DefaultAnimationLoop/>" + solvers +
         "<RegularGridTopology n='5 3 3' max='.04 .02 .02'/><MechanicalObject/><DiagonalMass massDensity='1000'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='5000'/><FixedProjectiveConstraint indices='0 5 10 15 20 "
         "25 30 35 40'/></Node>";
}

TEST_F(Stall, IsCountedAndReported) {
  write("stalls.scn", tissue("<EulerImplicitSolver/><CGLinearSolver iterations='2' tolerance='1e-12' threshold='0'/>"));
  const std::string warning = "the linear solver stopped before its tolerance in 7 of 7 steps";
  EXPECT_TRUE(has(succeeds("run stalls.scn --steps 7 --summary summary.json").err, warning));
  EXPECT_EQ(json("summary.json")["stalled_solves"], 7);
  EXPECT_EQ(json("summary.json")["preconditioner"], "none");
  EXPECT_EQ(hexaplast("run stalls.scn --steps 7 --strict --quiet").code, 4);

  // what a quiet run does not show it keeps
  EXPECT_EQ(succeeds("run stalls.scn --steps 7 --out run --frames 0 --quiet").err, "");
  EXPECT_TRUE(has(manifest().at("warnings").dump(), "warning: " + warning));
  EXPECT_TRUE(has(read("run/report.html"), warning));
}

// The default threshold of SOFA's solver is an absolute number, below which steps of tissue lie.
TEST_F(Stall, AtTheThresholdIsNotTakenForASolution) {
  write("plain.scn", tissue("<EulerImplicitSolver/><CGLinearSolver/>"));
  const std::string remedy = ": set threshold=\"0\" or use MultigridCGLinearSolver";
  EXPECT_TRUE(has(succeeds("check plain.scn").err, "stops at its threshold above its tolerance" + remedy));
  const Outcome outcome = succeeds("run plain.scn --summary summary.json");
  const long steps = json("summary.json")["threshold_solves"];
  EXPECT_GE(steps, 10);
  EXPECT_TRUE(has(outcome.err, "the linear solver stopped at its threshold above its tolerance in " +
                                   std::to_string(steps) + " of 20 steps" + remedy));
  EXPECT_TRUE(has(outcome.out, "not solved"));
  EXPECT_EQ(hexaplast("run plain.scn --strict --quiet").code, 4);

  // a threshold is met in silence neither later nor by Newton's iterations
  write("later.scn", tissue("<EulerImplicitSolver/><CGLinearSolver threshold='1e-10'/>"));
  EXPECT_EQ(hexaplast("run later.scn --strict --quiet").code, 4);
  write("static.scn", tissue("<StaticSolver/><NewtonRaphsonSolver absoluteResidualStoppingThreshold='1'/>"
                             "<CGLinearSolver iterations='500' threshold='0'/>"));
  for (const char* command : {"check", "run"})
    EXPECT_TRUE(has(hexaplast(std::string(command) + " static.scn").err, "lie below Newton's "));

  write("solved.scn", tissue("<EulerImplicitSolver/><CGLinearSolver iterations='500' threshold='0'/>"));
  EXPECT_FALSE(has(hexaplast("check solved.scn").err, "threshold"));
  succeeds("run solved.scn --strict --quiet");
}

TEST_F(Stall, OfNewtonIsNotThatOfTheLinearSolver) {
  write("static.scn", tissue("<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='2' "
                             "relativeSuccessiveStoppingThreshold='1e-12' relativeInitialStoppingThreshold='1e-12' "
                             "absoluteResidualStoppingThreshold='1e-12'/><SparseLDLSolver/>"));
  const Outcome outcome = fails("run static.scn --steps 1 --strict", 4,
                                "Newton's iterations stopped before their thresholds in 1 of 1 steps");
  EXPECT_FALSE(has(outcome.err, "linear solver"));
}

}  // namespace
