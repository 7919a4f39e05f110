// SPDX-License-Identifier: LGPL-2.1-or-later
// What is doubtful is said: before a run, in the terminal, the summary and the report, and by exit codes. Numbers
// beyond all bounds end a run in the step that makes them, and no file ever holds one; so does what a component
// refuses; a solver that comes to no end is stopped, counted and reported.
#include <cmath>
#include <regex>

#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

// Two cubes of 0.5 m, held at x = 0 and pulled at x = 1; total mass 2 kg.
std::string bar(const std::string& constraint, const std::string& material = "") {
  return "<Node gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings steps='100'/><EulerImplicitSolver/>"
         "<SparseLDLSolver/>\n<RegularGridTopology n='3 2 2' max='1 .5 .5'/><MechanicalObject/><DiagonalMass "
         "totalMass='2'/>\n<HexahedronElastoplasticFEMForceField name='body' youngModulus='2000' poissonRatio='0' " +
         material + "/>\n" + constraint +
         "<LinearForceField points='2 5' times='0 0.5 0.9' forces='0 0 0  3 0 0  1 0 0'/></Node>";
}

const std::string kHeld = "<FixedProjectiveConstraint indices='0 3 6'/>";

TEST_F(Command, CheckSaysWhatASceneMeans) {
  write("bar.scn", bar(kHeld, "yieldStress='100' plasticFlowRate='2' restShape='joined' volumeRestitution='3'"));
  const Outcome json = succeeds("check bar.scn --json");
  EXPECT_EQ(json.err, "");
  const Json found = Json::parse(json.out);
  EXPECT_EQ(found["nodes"], 12);
  EXPECT_EQ(found["hexahedra"], 2);
  EXPECT_EQ(found["held_nodes"], 3);
  EXPECT_EQ(found["partly_held_nodes"], 0);
  EXPECT_EQ(found["loaded_nodes"], 2);
  EXPECT_NEAR(found["load"][0], 6, 1e-9);  // two nodes at the greatest force, t = 0.5 s
  EXPECT_NEAR(found["load_time"], 0.5, 1e-9);
  EXPECT_EQ(found["steps"], 100);
  EXPECT_EQ(found["warnings"], Json::array());
  EXPECT_GT(found["memory_bytes"], 1e6);
  const Json& body = found["body"];
  EXPECT_NEAR(body["mass"], 2, 1e-12);
  EXPECT_NEAR(body["density"], 8, 1e-12);
  EXPECT_NEAR(body["least_scaled_jacobian"], 1, 1e-12);
  EXPECT_NEAR(body["wave_speed"], std::sqrt(2000 / 8.0), 1e-9);  // nu = 0: E = lambda + 2 mu
  EXPECT_NEAR(body["yield_strain"], 0.05, 1e-12);
  EXPECT_NEAR(body["flow_per_step"], 0.02, 1e-12);
  EXPECT_NEAR(body["restitution_per_step"], 0.03, 1e-12);

  const Outcome text = succeeds("check bar.scn");
  for (const char* part : {"bar: can run", "12, of which 3 are fixed", "stress 100 Pa, strain 0.05", "flow 0.02",
                           "2 kg, 8 kg/m^3", "on 2 nodes, together (6, 0, 0) N at t = 0.5 s", "100 of 0.01 s"})
    EXPECT_TRUE(has(text.out, part));
}

// A point at the middle of the bar, with 3 kg and 8 N.
TEST_F(Command, CheckSeesLoadsAndMassesOfPointsThatFollow) {
  std::string scene = bar(kHeld);
  scene.insert(scene.rfind("</Node>"),
               "<Node name='point'><MechanicalObject position='.5 .25 .25'/><BarycentricMapping/><UniformMass "
               "totalMass='3'/><ConstantForceField forces='0 8 0'/></Node>");
  write("bar.scn", scene);
  const Json found = Json::parse(succeeds("check bar.scn --json").out);
  EXPECT_NEAR(found["load"][0], 6, 1e-9);
  EXPECT_NEAR(found["load"][1], 8, 1e-9);
  EXPECT_NEAR(found["body"]["mass"], 5, 1e-9);
}

// The loader skips all cells of the file: what it says explains why the topology has no hexahedra.
TEST_F(Command, WarningsStandBeforeTheErrorsThatTheyExplain) {
  write("second_order.msh", content(HEXAPLAST_TEST_DATA "/meshes/second_order.msh"));
  write("bar.scn",
        "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>\n<MeshGmshLoader name='l' "
        "filename='second_order.msh'/><MeshTopology src='@l'/><MechanicalObject/><UniformMass totalMass='1'/>\n"
        "<HexahedronElastoplasticFEMForceField/></Node>");
  for (const char* verb : {"check", "run"}) {
    const Outcome outcome = hexaplast(verb + std::string(" bar.scn"));
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err,
              "bar.scn:2: warning: MeshGmshLoader.filename: 1 cells are skipped: neither edges, triangles, quads nor "
              "hexahedra of first order: 1 hexahedra of 20 nodes\n"
              "bar.scn:3: error: HexahedronElastoplasticFEMForceField: its topology has no hexahedra\n");
  }
}

TEST_F(Command, CheckShowsRotationFlowOfABodyThatNeverYields) {
  write("bar.scn", bar(kHeld, "restShape='joined' rotationYield='0.15' rotationFlowRate='3'"));
  const Outcome text = hexaplast("check bar.scn");
  for (const char* part : {"yield               never", "rotation yield      0.15 rad", "rotation flow 0.03"})
    EXPECT_TRUE(has(text.out, part));
  EXPECT_EQ(Json::parse(hexaplast("check bar.scn --json").out)["body"]["rotation_yield"], 0.15);

  const Outcome never = hexaplast("check bar.scn --set body.rotationFlowRate=0");
  EXPECT_TRUE(has(never.out, "rotation yield      never"));
  EXPECT_FALSE(has(never.out, "rates times dt"));
}

/// A file with a scene, and what is said of it, once.
struct Doubtful {
  std::string scene, options, warning;
};

// What there is to say is ModelCheck's and FractureAdvice's.
TEST_F(Command, CheckAndRunWarnOfWhatIsHardlyMeant) {
  const std::string body = "bar.scn:4: warning: HexahedronElastoplasticFEMForceField",
                    trapezoidal = "<EulerImplicitSolver rayleighStiffness='0.1' trapezoidalScheme='true'";
  for (const auto& [scene, options, warning] :
       {Doubtful{replaced(bar(kHeld), "max='1 .5 .5'", "max='100 50 50'"), "",
                 body + ": the body is 100 m long: are its coordinates in millimetres? They are read as metres"},
        // the second cube's corner at (1, .5, .5) is pushed behind the plane of its three neighbours
        {replaced(bar(kHeld), "<RegularGridTopology n='3 2 2' max='1 .5 .5'/>",
                  "<MeshTopology position='0 0 0 .5 0 0 1 0 0 0 .5 0 .5 .5 0 1 .5 0 0 0 .5 .5 0 .5 1 0 .5 0 .5 .5 .5 "
                  ".5 .5 .8 .3 .3' hexahedra='0 1 4 3 6 7 10 9 1 2 5 4 7 8 11 10'/>"),
         "", body + ": 1 of the hexahedra is inverted at a corner; the worst is hexahedron 1: its scaled Jacobian is "},
        // cubes of 0.5 m with E / density = 250 m^2/s^2 and nu = 0: 2 sqrt(250) / 0.5 rad/s
        {replaced(bar(kHeld, "bending='blended' volumetric='sample'"), "<EulerImplicitSolver", trapezoidal),
         " --set .dt=0.04",
         "bar.scn:2: warning: EulerImplicitSolver.trapezoidalScheme: vibrations of up to 63.2 rad/s times dt = 0.04 "
         "s is 2.53"},
        {bar(kHeld, "restShape='joined' rotationFlowRate='2' fractureStress='400'"), "",
         "fractureStress has no effect: without yieldStress"}}) {
    write("bar.scn", scene);
    const Outcome checked = succeeds("check bar.scn" + options),
                  ran = succeeds("run bar.scn --steps 1 --out run --force --frames 0 --summary sum" + options);
    for (const std::string& said : {checked.err, ran.err, read("run/report.html")}) {
      EXPECT_TRUE(has(said, warning));
      EXPECT_EQ(said.find(warning), said.rfind(warning));
    }
    if (!options.empty()) {
      EXPECT_EQ(hexaplast("check bar.scn --set .dt=0.03").err, "");
    }
    const Json found = Json::parse(hexaplast("check bar.scn --json" + options).out);
    const auto is_of_mesh = [](const Json& said) {
      return has(said.get<std::string>(), "millimetres") || has(said.get<std::string>(), "inverted at a corner");
    };
    EXPECT_EQ(std::ranges::count_if(found["warnings"], is_of_mesh), has(warning, body + ": ") ? 1 : 0);
    EXPECT_EQ(found["body"]["inside_out"] == 1, json("sum")["least_scaled_jacobian"] < 0);
  }
  expect_refused({{"check bar.scn --set body.plasticFlowRate=2 --set body.hardening=.1 --set body.yieldStress=500", 3,
                   "fractureStress = 400: must lie in [500, inf] Pa"}});
}

TEST_F(Command, CheckAndRunNameTheRegionsOfTheBody) {
  std::string scene = bar(kHeld, "yieldStress='90' plasticFlowRate='1'");
  scene.insert(scene.rfind("</Node>"),
               "<MaterialRegion name='hard' indices='1' youngModulus='8000' yieldStress='300'/><Node name='inner'>"
               "<MaterialRegion name='all' indices='0 1' yieldStress='80 100' hardening='0.5'/></Node>");
  write("bar.scn", scene);
  const std::string hard = "1 hexahedron, youngModulus 8000 Pa, yieldStress 300 Pa",
                    all = "2 hexahedra, yieldStress 80 to 100 Pa, hardening 0.5";
  const std::string checked = hexaplast("check bar.scn").out;
  EXPECT_TRUE(has(checked, "  region              hard: " + hard + "\n"));
  EXPECT_TRUE(has(checked, "  region              inner/all: " + all + "\n"));
  const Json regions = Json::parse(hexaplast("check bar.scn --json --set inner/all.hardening=2").out)["regions"];
  EXPECT_EQ(regions, Json::parse(R"([
    {"path": "hard", "hexahedra": 1, "values": {"youngModulus": [8000.0, 8000.0], "yieldStress": [300.0, 300.0]}},
    {"path": "inner/all", "hexahedra": 2, "values": {"yieldStress": [80.0, 100.0], "hardening": [2.0, 2.0]}}])"));

  const Outcome ran = succeeds("run bar.scn --steps 1 --out results --frames 0");
  EXPECT_TRUE(has(ran.out, "  region hard         " + hard + "\n"));
  EXPECT_TRUE(has(read("results/report.html"), all));
}

TEST_F(Command, CheckTakesNoStep) {
  write("bar.scn", bar(kHeld));
  succeeds("check bar.scn --set LinearForceField1.forces='1e308 0 0 1e308 0 0 1e308 0 0'");
}

// The row of a matrix is 0 for a node that no cell has.
TEST_F(Command, CheckFindsTheNodeForWhichNoStepCanBeSolved) {
  write("node.scn",
        "<Node dt='.01' gravity='9.81 0 0'>\n<DefaultAnimationLoop/><EulerImplicitSolver/>\n<SparseLDLSolver/>"
        "<MeshTopology hexahedra='0-7' position='0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  1 1 1.5'/>"
        "<MechanicalObject/><DiagonalMass massDensity='100'/><HexahedronElastoplasticFEMForceField youngModulus='1e5'/>"
        "<FixedProjectiveConstraint indices='0 3 4 7'/></Node>");
  const std::string why = "Cholesky: the matrix is not positive definite (node 8 of 9 has no positive pivot along ";
  const Outcome checked = fails("check node.scn", 3, why);
  EXPECT_TRUE(checked.err.starts_with("node.scn:3: error: SparseLDLSolver")) << checked.err;
  EXPECT_EQ(checked.out, "");
  fails("run node.scn --steps 1", 4, why);
}

TEST_F(Command, CheckWarnsOfUnwiseChoices) {
  write("bar.scn", bar(""));
  const Outcome unsupported = succeeds("check bar.scn");
  EXPECT_EQ(unsupported.err, "bar.scn: warning: no node is fixed, and the loads do not balance: the body moves away\n");
  // what hangs on another state may stay
  const auto weight = [](const std::string& name) {
    return "<Node name='" + name + "'><MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/>";
  };
  for (const std::string spring : {"", "<SpringForceField object1='@a' object2='@b/point' spring='0 0 1 0 1'/>"}) {
    write("joined.scn", "<Node gravity='0 0 -1'><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/>" +
                            spring + weight("a") + "<FixedProjectiveConstraint indices='0'/></Node>" + weight("b") +
                            "<Node name='point'><MechanicalObject position='0 0 0'/><IdentityMapping/></Node></Node>"
                            "</Node>");
    EXPECT_EQ(hexaplast("check joined.scn").err.find("moves away") == std::string::npos, !spring.empty());
  }
  write("springs.scn", bar("<RestShapeSpringsForceField points='0' stiffness='9'/>"));
  EXPECT_EQ(succeeds("check springs.scn").err, "");
  write("held.scn", bar(kHeld));
  EXPECT_EQ(hexaplast("check held.scn --set body.poissonRatio=0.495 --set body.volumetric=sample").err,
            "held.scn: warning: poissonRatio = 0.495: above 0.49 hexahedra lock in bending unless volumetric is "
            "volumeRatio\n");
}

class Results : public Command {
 protected:
  Json summary() { return json("summary.json"); }
};

/// Four cubes of 0.1 m, held at x = 0; a force of `load` at each of the four nodes at the other end, over times.
std::string bar(const std::string& solver, const std::string& times, const std::string& forces,
                const std::string& dt = "0.01") {
  return "<Node dt='" + dt +
         "' gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings steps='100'/><EulerImplicitSolver " + solver +
         "/><SparseLDLSolver/>\n<RegularGridTopology n='5 2 2' max='.4 .1 .1'/><MechanicalObject/><DiagonalMass "
         "massDensity='1000'/>\n<HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' "
         "poissonRatio='.3' bending='blended' volumetric='sample' recovery='none'/>\n<FixedProjectiveConstraint "
         "indices='0 5 10 15'/><LinearForceField points='4 9 14 19' times='" +
         times + "' forces='" + forces + "'/></Node>";
}

const std::string kDamped = "rayleighMass='2' rayleighStiffness='0.1'", kLong = "0 100";
const std::string kPulled = bar(kDamped, kLong, "1 0 0  1 0 0");                           // to a fifth more
const std::string kCrushed = bar(kDamped, kLong, "-20 0 0  -20 0 0");                      // through its support
const std::string kPassing = bar(kDamped, "0 .3 .6 100", "0 0 0  -20 0 0  0 0 0  0 0 0");  // and back
const std::string kTornAway = bar("", kLong, "100 0 0  100 0 0");  // by its own length in a few steps
const std::string kGrowing = bar("trapezoidalScheme='true'", kLong, "1 0 0  1 0 0", "0.05");

TEST_F(Results, AreNotDoubtedWithoutReason) {
  write("bar.scn", kPulled);
  const Outcome outcome = succeeds("run bar.scn --strict --summary summary.json");
  EXPECT_EQ(outcome.err, "");
  EXPECT_FALSE(has(outcome.out, "inverted"));
  EXPECT_EQ(summary().at("inverted"), 0);
  EXPECT_EQ(summary().at("most_inverted"), 0);
  EXPECT_EQ(summary().at("doubts"), Json::array());
}

// In the terminal, in the record of the run, in its report, and in the summary for programs.
TEST_F(Results, OfABodyThatIsInsideOutAreDoubted) {
  write("bar.scn", kCrushed);
  const std::string end = "4 of 4 hexahedra are inverted at the end";
  const Outcome outcome = succeeds("run bar.scn --out run --frames 0 --summary summary.json");
  EXPECT_TRUE(has(outcome.err, "warning: " + end));
  EXPECT_TRUE(has(outcome.out, "inverted            4 at the end, at most 4 in step "));
  const Json warnings = manifest().at("warnings");
  EXPECT_EQ(std::count(warnings.begin(), warnings.end(), Json("warning: " + end)), 1) << warnings;
  EXPECT_EQ(manifest().at("state"), "finished");
  EXPECT_TRUE(has(read("run/report.html"), end));
  EXPECT_EQ(summary().at("doubts").at(0), end);
  EXPECT_EQ(summary().at("inverted"), 4);
  EXPECT_EQ(history().number(100, "inverted"), 4);
}

TEST_F(Results, OfABodyThatWasInsideOutAreDoubted) {
  write("bar.scn", kPassing);
  const Outcome outcome = succeeds("run bar.scn --out run --frames 0 --summary summary.json --checkpoint every=30");
  const std::vector<double> inverted = history().numbers("inverted");
  const auto most = std::ranges::max_element(inverted);
  const auto step = most - inverted.begin();
  ASSERT_EQ(inverted.at(100), 0);
  ASSERT_GT(*most, 1);
  ASSERT_LT(step, 90);
  const std::string doubt =
      "warning: " + std::to_string(int(*most)) + " of 4 hexahedra were inverted in step " + std::to_string(step) + "\n";
  EXPECT_EQ(outcome.err, doubt);

  // a run that goes on remembers
  fails("resume run/checkpoint_000000090.hxc --strict", 4, doubt);
}

TEST_F(Results, ThatTheEnergyBalanceDoesNotExplainAreDoubted) {
  write("bar.scn", kTornAway);
  const Outcome outcome = succeeds("run bar.scn --out run --frames 0");
  EXPECT_GT(std::abs(history().number(100, "energy_error")), 0.2 * history().number(100, "load_work"));
  EXPECT_TRUE(has(outcome.err, "warning: the energy balance misses "));
  // also of a run that writes no files
  EXPECT_EQ(hexaplast("run bar.scn").err, outcome.err);
}

// The files are written all the same, and a quiet run says why it ended so.
TEST_F(Results, ThatAreDoubtedEndAStrictRunWith4) {
  write("bar.scn", kCrushed);
  fails("run bar.scn --strict --quiet --out run --frames 0 --final last.json", 4,
        "bar.scn: error: 4 of 4 hexahedra are inverted at the end");
  EXPECT_EQ(manifest().at("state"), "failed");
  EXPECT_EQ(manifest().at("steps").at("done"), 100);
  const std::string reason = manifest().at("exit_reason");
  EXPECT_TRUE(reason.starts_with("4 of 4 hexahedra are inverted at the end")) << reason;
  EXPECT_TRUE(is_there("last.json"));
}

// With a directory and without one: energy out of nothing is a failure, not a doubt.
TEST_F(Results, OfABlowUpAreAFailure) {
  write("bar.scn", kGrowing);
  for (const char* files : {"", " --out run --frames 0"}) {
    const Outcome ended = fails(std::string("run bar.scn --steps 400 --quiet") + files, 4, "the motion has blown up");
    EXPECT_TRUE(ended.err.starts_with("bar.scn: error: step ")) << ended.err;
  }
  EXPECT_EQ(manifest().at("state"), "failed");
}

/// A bar of 0.1 x 0.1 x 0.4 m, without damping and gravity unless the others say otherwise.
std::string undamped_bar(const std::string& scheme, const std::string& others, const std::string& gravity = "0 0 0",
                         const std::string& state = "", const std::string& place = "0 0 0") {
  return "<Node dt='0.01' gravity='" + gravity +
         "'><DefaultAnimationLoop/><RunSettings steps='150'/><EulerImplicitSolver " + scheme +
         "/><SparseLDLSolver/><RegularGridTopology n='3 3 9' max='.1 .1 .4'/><MechanicalObject translation='" + place +
         "' " + state +
         "/><DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField youngModulus='5000' "
         "poissonRatio='.3'/>" +
         others + "</Node>";
}

/// It is a quarter longer and thicker than at rest.
std::string stretched() {
  std::string rest;
  for (int n = 0; n < 81; ++n)
    for (const int cells : {n % 3, n / 3 % 3, n / 9}) rest += std::to_string(cells * 0.04) + " ";
  return "rest_position='" + rest + "'";
}

// Loads that do no work, begin late or take back what they gave; energy that was there before; nothing at all.
TEST_F(Results, OfSlowAndStillAndFreeBodiesAreNoBlowUp) {
  const std::string held = "<FixedProjectiveConstraint indices='0-8'/>";
  const std::pair<const char*, std::string> scenes[] = {
      {"at rest, far away", undamped_bar("", "", "0 0 0", "", "1000 0 0")},
      {"thrown", undamped_bar("", "", "-9.81 0 0", "velocity='" + repeated("3 0 0 ", 81) + "'")},
      {"let go of a stretch, with decaying velocities", undamped_bar("vdamping='40'", "", "0 0 0", stretched())},
      {"drawn out and led back",
       undamped_bar("rayleighMass='5'",
                    held + "<GraspForceField keyTimes='0 .3 .6 9' positions='.05 .05 .4  .05 .05 .5  .05 "
                           ".05 .4  .05 .05 .4' radius='.08' stiffness='2000'/>")},
      {"hit after a second",
       undamped_bar(
           "",
           held +
               "<LinearForceField points='80' times='0 1 1.01 1.02 9' forces='0 0 0  0 0 0  3 0 0  0 0 0  0 0 0'/>")},
      {"by the trapezoidal scheme", undamped_bar("trapezoidalScheme='true'", held, "0 0 -1")},
      {"without a body",
       "<Node gravity='0 0 -9.81'><DefaultAnimationLoop/><RunSettings steps='50'/><EulerImplicitSolver/>"
       "<SparseLDLSolver/><MechanicalObject position='0 0 0  1 0 0'/><UniformMass vertexMass='1'/>"
       "<FixedProjectiveConstraint indices='0'/></Node>"}};
  for (const auto& [name, scene] : scenes) {
    write("bar.scn", scene);
    EXPECT_EQ(succeeds("run bar.scn --strict").err, "") << name;
  }
}

class Overflow : public Command {
 protected:
  /// The run fails with that message; what it has written are numbers.
  Outcome fails_with(const std::string& overrides, const std::string& message) {
    Outcome outcome =
        fails("run '" HEXAPLAST_SOURCE_DIR
              "/scenes/bar_stretch_low.scn' --out run --force --frames 0 --quiet --steps 12 --checkpoint every=1 " +
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

// What a scene has warned of by then may explain the failure. Here a component refuses an attribute that changes at the
// beginning of the fifth step.
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
  const std::string warning = "becomes active ", error = "plasticFlowRate";
  const Outcome outcome = hexaplast("run warns.scn --steps 40 --out warns --frames 0");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_LT(outcome.err.find(warning), outcome.err.find(error)) << outcome.err;
  EXPECT_TRUE(has(outcome.err, error));
  EXPECT_TRUE(has(manifest("warns").at("warnings").dump(), warning));
  EXPECT_TRUE(is_there("warns/mesh_000004.vtu") && is_there("warns/report.html"));
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
