// SPDX-License-Identifier: LGPL-2.1-or-later
// Results that are worthless are said to be: in the terminal, the summary and the report, and by exit codes.
#include <algorithm>
#include <cmath>

#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

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
         "indices='0 5 10 15'/><LinearForceField points='4 9 14 19' "
         "times='" +
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

/// Velocities of its nodes: `spin` [rad/s] about an axis along y through its middle, and `speed` [m/s] along x.
std::string moving(double spin, double speed) {
  std::string velocities;
  for (int n = 0; n < 81; ++n) {
    const double x = n % 3 * 0.05 - 0.05, z = n / 9 * 0.05 - 0.2;
    velocities += std::to_string(spin * z + speed) + " 0 " + std::to_string(-spin * x) + " ";
  }
  return "velocity='" + velocities + "'";
}

// Loads that do no work, begin late or take back what they gave; energy that was there before; nothing at all.
TEST_F(Results, OfSlowAndStillAndFreeBodiesAreNoBlowUp) {
  const std::string held = "<FixedProjectiveConstraint indices='0-8'/>", weight = "0 0 -1";
  const std::pair<const char*, std::string> scenes[] = {
      {"at rest", undamped_bar("", "")},
      {"at rest, far away", undamped_bar("", "", "0 0 0", "", "1000 0 0")},
      {"at rest, in the smallest of motions", undamped_bar("", "", "0 0 0", moving(0, 1e-6))},
      {"in free fall", undamped_bar("", "", weight)},
      {"thrown", undamped_bar("", "", "-9.81 0 0", moving(0, 3))},
      {"all held", undamped_bar("", "<FixedProjectiveConstraint indices='0-80'/>", weight)},
      {"spinning", undamped_bar("", "", "0 0 0", moving(2, 0))},
      {"let go of a stretch", undamped_bar("", "", "0 0 0", "restScale='.8'")},
      {"let go of a stretch, with decaying velocities", undamped_bar("vdamping='40'", "", "0 0 0", "restScale='.8'")},
      {"led out and back",
       undamped_bar(
           "rayleighStiffness='.02'",
           held + "<LinearMovementProjectiveConstraint indices='72-80' keyTimes='0 .3 .6 99' movements='0 0 0  0 0 "
                  ".1  0 0 0  0 0 0'/>")},
      {"drawn out and led back",
       undamped_bar("rayleighMass='5'",
                    held + "<GraspForceField keyTimes='0 .3 .6 9' positions='.05 .05 .4  .05 .05 .5  .05 "
                           ".05 .4  .05 .05 .4' radius='.08' stiffness='2000'/>")},
      {"hit after a second",
       undamped_bar("", held + "<LinearForceField points='80' times='0 1 1.01 1.02 9' forces='0 0 0  0 "
                               "0 0  3 0 0  0 0 0  0 0 0'/>")},
      {"onto an obstacle", undamped_bar("", "<PlaneForceField normal='0 0 1' d='-.2' stiffness='300'/>", weight)},
      {"by the trapezoidal scheme", undamped_bar("trapezoidalScheme='true'", held, weight)},
      {"without inertia", undamped_bar("firstOrder='true'", held, weight)},
      {"without a body",
       "<Node gravity='0 0 -9.81'><DefaultAnimationLoop/><RunSettings steps='50'/><EulerImplicitSolver/>"
       "<SparseLDLSolver/><MechanicalObject position='0 0 0  1 0 0'/><UniformMass vertexMass='1'/>"
       "<FixedProjectiveConstraint indices='0'/></Node>"}};
  for (const auto& [name, scene] : scenes) {
    write("bar.scn", scene);
    EXPECT_EQ(succeeds("run bar.scn --strict").err, "") << name;
  }
}

}  // namespace
