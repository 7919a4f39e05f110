// SPDX-License-Identifier: LGPL-2.1-or-later
// Springs between two mechanical states.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/solve/energy_balance.hpp"
#include "support/compare.hpp"
#include "support/two_states.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::both;
using support::errors_of;
using support::go_on_in;
using support::node;
using support::positions;
using support::read_and_init;

const std::string kElastic = "<HexahedronElastoplasticFEMForceField youngModulus='3000' poissonRatio='.4'/>",
                  kPlastic =
                      "<HexahedronElastoplasticFEMForceField youngModulus='3000' poissonRatio='.4' "
                      "yieldStress='60' plasticFlowRate='4'/>",
                  kJoined =
                      "<HexahedronElastoplasticFEMForceField youngModulus='3000' poissonRatio='.4' "
                      "yieldStress='60' plasticFlowRate='4' restShape='joined'/>";
const std::string kVertexMass = "<UniformMass vertexMass='.004'/>";

/// Two blocks that springs join across a gap.
struct Blocks {
  std::string integrator = "<EulerImplicitSolver rayleighMass='.1' rayleighStiffness='.02'/>";
  std::string solver = "<SparseLDLSolver/>";
  std::string springs = kSprings;
  std::string gravity = "1 0 -9.81";
  std::string material = kPlastic;
  double dt = .01;
  bool is_anchored = false;   // by springs: free to turn about its springs, nothing would hold the second block
  bool is_one_state = false;  // the slow way: all nodes in one state, whose springs have the numbers of that

  static constexpr std::array<int, 3> kCells{2, 2, 2}, kOtherCells{1, 2, 2};
  static constexpr int kFirstNodes = 27;
  static const std::string kSprings;

  std::string of_mesh(const PointArray& x, const std::vector<Hexahedron>& cells) const {
    std::string positions, hexahedra;
    for (Eigen::Index n = 0; n < x.rows(); ++n) positions += fmt::format("{} {} {}  ", x(n, 0), x(n, 1), x(n, 2));
    for (const Hexahedron& cell : cells)
      for (const int corner : cell) hexahedra += fmt::format("{} ", corner);
    return "<MeshTopology position='" + positions + "' hexahedra='" + hexahedra +
           "'/><MechanicalObject name='state'/>" + kVertexMass + material;
  }

  std::string text() const {
    const HexMesh first = regular_grid(kCells, {0, 0, 0}, {.04, .04, .04}),
                  second = regular_grid(kOtherCells, {.05, 0, .01}, {.07, .04, .04});
    const std::string held = "<FixedProjectiveConstraint indices='0 3 6 9 12 15 18 21 24'/>";
    const auto anchor = [&](const std::string& points) {
      return is_anchored ? "<RestShapeSpringsForceField points='" + points + "' stiffness='5'/>" : "";
    };
    std::string bodies;
    if (is_one_state) {
      std::vector<Hexahedron> cells = first.hexahedra();
      for (Hexahedron cell : second.hexahedra()) {
        for (int& corner : cell) corner += kFirstNodes;
        cells.push_back(cell);
      }
      PointArray all(first.num_nodes() + second.num_nodes(), 3);
      all << first.positions(), second.positions();
      bodies = node("first", of_mesh(all, cells) + held + springs + anchor("27 31 35"));
    } else {
      bodies = springs + node("first", of_mesh(first.positions(), first.hexahedra()) + held) +
               node("second", of_mesh(second.positions(), second.hexahedra()) + anchor("0 4 8"));
    }
    return fmt::format("<Node dt='{}' gravity='{}'><DefaultAnimationLoop/>", dt, gravity) + integrator + solver +
           bodies + "</Node>";
  }
};
// of nodes at x = .04 and at x = .05
const std::string Blocks::kSprings =
    "<SpringForceField name='springs' object1='@first/state' object2='@second/state' "
    "spring='26 16 40 .1 .008  23 14 30 .2 .009  20 12 30 .1 .006  17 4 60 0 .005'/>";
const std::string kInOneState =
    "<SpringForceField name='springs' spring='26 43 40 .1 .008  23 41 30 .2 .009  20 39 30 .1 .006  17 31 60 0 .005'/>";

PointArray end_of(const Blocks& blocks, int steps) {
  scene::Scene scene = read_and_init(blocks.text());
  support::run(scene, steps);
  return blocks.is_one_state ? positions(scene, "first") : both(scene);
}

// By all integrators, and all ways to solve a system.
TEST(SpringsBetweenStates, MoveBodiesAsIfTheyWereOfOneState) {
  struct Case {
    std::string integrator, solver;
    double dt = .01;
    int steps = 60;
    double tolerance = 1e-10;
    std::string material = kElastic;
  };
  const std::string implicit = Blocks().integrator,
                    exact = "<CGLinearSolver iterations='2000' tolerance='1e-14' threshold='1e-40'/>";
  for (const Case& c :
       {Case{implicit, "<SparseLDLSolver/>"}, Case{implicit, exact},
        // each mesh has an averaging of rest shapes of its own
        Case{implicit, "<SparseLDLSolver/>", .01, 60, 1e-8, kJoined},
        Case{implicit, "<MultigridCGLinearSolver tolerance='1e-13' preconditioner='multigrid'/>"},
        Case{implicit, "<MultigridCGLinearSolver tolerance='1e-13' preconditioner='diagonal'/>"},
        Case{"<EulerImplicitSolver trapezoidalScheme='true' rayleighMass='.1' rayleighStiffness='.02'/>", exact, .004},
        Case{"<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='40' "
             "relativeInitialStoppingThreshold='1e-13'/>",
             "<SparseLDLSolver/>", .01, 3, 1e-8}}) {
    Blocks blocks{.integrator = c.integrator,
                  .solver = c.solver,
                  .gravity = "2 0 -3",
                  .material = c.material,
                  .dt = c.dt,
                  .is_anchored = c.integrator.starts_with("<Static")};
    Blocks one = blocks;
    one.is_one_state = true;
    one.springs = kInOneState;
    SCOPED_TRACE(c.integrator + c.solver);
    const PointArray expected = end_of(one, c.steps);
    EXPECT_TRUE(support::agrees(end_of(blocks, c.steps), expected, c.tolerance));
    blocks.springs.replace(blocks.springs.find("40 .1"), 5, "0 0");
    EXPECT_FALSE(support::agrees(end_of(blocks, c.steps), expected, 1e-5)) << "the springs matter";
  }
}

// The damping of SOFA's solver by the stiffness of a component.
TEST(SpringsBetweenStates, HaveARayleighStiffness) {
  Blocks blocks, one{.springs = kInOneState, .is_one_state = true};
  for (Blocks* each : {&blocks, &one})
    each->springs.replace(each->springs.find("name="), 5, "rayleighStiffness='.05' name=");
  const PointArray damped = end_of(blocks, 40);
  EXPECT_TRUE(support::agrees(damped, end_of(one, 40), 1e-8));
  EXPECT_FALSE(support::agrees(damped, end_of({}, 40), 1e-5));
}

// Ends at embedded points that lie on nodes.
TEST(SpringsBetweenStates, MayLeadToStatesThatFollow) {
  Blocks blocks{.solver = "<CGLinearSolver iterations='2000' tolerance='1e-14' threshold='1e-40'/>"};
  const PointArray expected = end_of(blocks, 40);
  // nodes 26, 23, 20, 17 of the first block, and 16 of the second
  std::string text = blocks.text();
  text.replace(text.find("spring='26 16"), 13, "spring='0 16");
  for (const auto& [from, to] : {std::pair{"  23 14", "  1 14"}, {"  20 12", "  2 12"}, {"  17 4", "  3 4"}})
    text.replace(text.find(from), std::string(from).size(), to);
  text.replace(text.find("@first/state"), 12, "@first/skin/points");
  const std::size_t end = text.find("</Node><Node name='second'>");
  ASSERT_NE(end, std::string::npos);
  const std::string skin =
      "<Node name='skin'><MechanicalObject name='points' position='.04 .04 .04  .04 .02 .04  .04 0 .04  .04 .04 .02'/>"
      "<BarycentricMapping/></Node>";
  text.insert(end, skin);
  scene::Scene scene = read_and_init(text);
  support::run(scene, 40);
  EXPECT_TRUE(support::agrees(both(scene), expected, 1e-9));

  text.replace(text.find("<CGLinearSolver"),
               text.find("/>", text.find("<CGLinearSolver")) + 2 - text.find("<CGLinearSolver"),
               "<SparseLDLSolver name='direct'/>");
  EXPECT_NE(errors_of(text).find("SpringForceField.object1: leads to 'points', which follows another state: no matrix "
                                 "has that, but SparseLDLSolver 'direct' needs one"),
            std::string::npos)
      << errors_of(text);

  // one end follows a state, the other one is at rest: no matrix has that either
  const std::string hooked = R"(<Node name='root' dt='.01'><DefaultAnimationLoop/>
    <Node name='hook'><MechanicalObject name='state' position='.02 .02 .1'/></Node>
    <Node name='body'><EulerImplicitSolver/><SparseLDLSolver/>
      <RegularGridTopology n='3 3 3' min='0 0 0' max='.04 .04 .04'/><MechanicalObject name='state'/>
      <UniformMass vertexMass='.004'/><HexahedronElastoplasticFEMForceField youngModulus='3000' poissonRatio='.4'/>
      <Node name='skin'><MechanicalObject name='points' position='.04 .04 .04'/><BarycentricMapping/></Node>
      <SpringForceField object1='@body/skin/points' object2='@hook/state' spring='0 0 400 .1 .05'/>
    </Node></Node>)";
  EXPECT_NE(errors_of(hooked).find("object1: leads to 'points', which follows another state"), std::string::npos)
      << errors_of(hooked);
}

// A kilogram that hangs on a spring: its upper end in a state that nothing moves, or on a fixed node.
TEST(SpringsBetweenStates, HangOnAStateThatNothingMoves) {
  const auto scene_of = [](const std::string& above, const std::string& hanging) {
    return "<Node dt='.01' gravity='0 0 -9.81'><DefaultAnimationLoop/>" + above +
           "<Node name='hanging'><EulerImplicitSolver/><SparseLDLSolver/>" + hanging + "</Node></Node>";
  };
  scene::Scene scene =
      read_and_init(scene_of(node("hook", "<MechanicalObject name='state' position='7 7 7  0 0 0'/>"),
                             "<MechanicalObject name='state' position='.3 0 -1  9 9 9'/><UniformMass vertexMass='1'/>"
                             "<SpringForceField object1='@/hook/state' spring='1 0 100 2 .9'/>"));
  scene::Scene fixed =
      read_and_init(scene_of("",
                             "<MechanicalObject name='state' position='.3 0 -1  0 0 0'/><UniformMass vertexMass='1'/>"
                             "<FixedProjectiveConstraint indices='1'/><SpringForceField spring='1 0 100 2 .9'/>"));
  support::run(scene, 200);
  support::run(fixed, 200);
  EXPECT_TRUE(support::agrees(positions(scene, "hanging").row(0), positions(fixed, "hanging").row(0), 1e-13));
  EXPECT_EQ(positions(scene, "hook"), support::rows({{7, 7, 7}, {0, 0, 0}}));
}

// Implicit Euler keeps linear momentum, but not the angular one: a step changes it by -h^2 sum v' x f, with the forces
// f at its beginning. Newton's method would have those at its end there.
TEST(SpringsBetweenStates, ChangeAngularMomentumAsImplicitEulerDoes) {
  const double h = .01, stiffness = 200, rest_length = 1;
  scene::Scene scene = read_and_init(
      "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>" +
      node("first",
           "<MechanicalObject name='state' position='0 0 0' velocity='0 -2 0'/><UniformMass vertexMass='1'/>") +
      node("second",
           "<MechanicalObject name='state' position='1.2 0 0' velocity='0 2 0'/><UniformMass vertexMass='1'/>") +
      "<SpringForceField object1='@first' object2='@second' spring='0 0 200 0 1'/></Node>");
  const auto row = [&](const std::string& state, bool velocity) -> Vec3 {
    auto& of = at<scene::MechanicalState>(scene, state + "/state");
    return (velocity ? of.velocities() : of.positions()).row(0).transpose();
  };
  const auto angular = [&]() -> Vec3 {
    return row("first", false).cross(row("first", true)) + row("second", false).cross(row("second", true));
  };
  const Vec3 at_start = angular();
  for (int k = 0; k < 30; ++k) {
    const Vec3 before = angular(), apart = row("second", false) - row("first", false);
    const Vec3 force = stiffness * (apart.norm() - rest_length) * apart.normalized();  // on the first one
    scene.step();
    const Vec3 expected = -h * h * (row("first", true) - row("second", true)).cross(force);
    EXPECT_LT((angular() - before - expected).norm(), 1e-13) << k;
  }
  EXPECT_NEAR((angular() - at_start).norm() / at_start.norm(), .0505, .0005);
}

TEST(SpringsBetweenStates, HaveTheSameBitsForAnyNumberOfThreadsAndAfterACheckpoint) {
  const Blocks blocks{.solver = "<MultigridCGLinearSolver/>"};
  set_num_threads(1);
  const PointArray one = end_of(blocks, 30);
  set_num_threads(3);
  EXPECT_EQ(end_of(blocks, 30), one);
  set_num_threads(1);

  scene::Scene straight = read_and_init(blocks.text()), second = read_and_init(blocks.text());
  support::run(straight, 15);
  go_on_in(straight, second);
  support::run(second, 15);
  EXPECT_EQ(both(second), one);
  second.reset();
  support::run(second, 30);
  EXPECT_EQ(both(second), one);
}

// A hundred times as stiff as the bodies: the preconditioner sees them as it sees contact.
TEST(SpringsBetweenStates, ThatAreStiffCostFewIterations) {
  const auto iterations = [](const std::string& springs, const std::string& preconditioner) {
    scene::Scene scene = read_and_init(
        "<Node dt='.01' gravity='1 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver/>"
        "<MultigridCGLinearSolver tolerance='1e-6' preconditioner='" +
        preconditioner + "'/>" + springs +
        node("first",
             "<RegularGridTopology n='9 9 9' max='.08 .08 .08'/><MechanicalObject name='state'/>"
             "<UniformMass totalMass='.5'/><HexahedronElastoplasticFEMForceField youngModulus='3000'/>"
             "<FixedProjectiveConstraint indices='0-80'/>") +
        node("second",
             "<RegularGridTopology n='9 9 9' min='.09 0 0' max='.17 .08 .08'/><MechanicalObject "
             "name='state'/><UniformMass totalMass='.5'/><HexahedronElastoplasticFEMForceField "
             "youngModulus='2000'/>") +
        "</Node>");
    int all = 0;
    for (int k = 0; k < 5; ++k) all += scene.step().iterations;
    return all / 5.;
  };
  std::string springs = "<SpringForceField object1='@first/state' object2='@second/state' spring='";
  for (int j = 2; j < 7; ++j)
    for (int k = 2; k < 7; ++k) springs += fmt::format("{} {} 3000 0 .01  ", 8 + 9 * (j + 9 * k), 9 * (j + 9 * k));
  springs += "'/>";
  const double with = iterations(springs, "multigrid"), without = iterations("", "multigrid");
  std::cout << without << " iterations without springs, " << with << " with them, " << iterations(springs, "diagonal")
            << " with diagonal\n";
  EXPECT_LT(with, 2.5 * without);
  EXPECT_LT(with, .5 * iterations(springs, "diagonal"));
}

// They count as loads: of what a stretched spring has given, both masses have all but what the integrator takes.
TEST(SpringsBetweenStates, AreLoadsInTheBalanceOfEnergy) {
  scene::Scene scene = read_and_init(
      "<Node dt='1e-3' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver name='euler'/><SparseLDLSolver/>" +
      node("first", "<MechanicalObject name='state' position='0 0 0'/><UniformMass vertexMass='1'/>") +
      node("second", "<MechanicalObject name='state' position='1.5 0 0'/><UniformMass vertexMass='3'/>") +
      "<SpringForceField object1='@first' object2='@second' spring='0 0 200 4 1'/></Node>");
  auto& euler = at<scene::OdeSolver>(scene, "euler");
  euler.keep_energy_balance();
  support::run(scene, 60);
  const EnergyBalance& balance = *euler.energy_balance();
  const double length = positions(scene, "second")(0, 0) - positions(scene, "first")(0, 0);
  const double given = 200 * (.5 * .5 - (length - 1) * (length - 1)) / 2;
  EXPECT_GT(given, 5);
  EXPECT_NEAR(balance.load_work, given, .01 * given);
  EXPECT_GT(balance.damping_loss, .05 * given);
  EXPECT_NEAR(balance.kinetic, given - balance.damping_loss - balance.numerical_loss, .01 * given);
  EXPECT_NEAR(balance.error(), 0, 1e-3 * given);
}

TEST(SpringsBetweenStates, MistakesAreNamed) {
  const auto errors = [](const std::string& springs, const std::string& in_second = "", const std::string& above = "") {
    return errors_of("<Node dt='.01'><DefaultAnimationLoop/>" + above +
                     "<Node name='all'>\n<EulerImplicitSolver name='euler'/><SparseLDLSolver/>\n<Node name='first'>"
                     "<MechanicalObject name='state' position='0 0 0  1 0 0'/>" +
                     kVertexMass + "</Node><Node name='second'>" + in_second +
                     "<MechanicalObject name='state' position='0 0 0'/>" + kVertexMass + "</Node>\n" + springs +
                     "</Node></Node>");
  };
  const auto between = [](const std::string& rest) {
    return "<SpringForceField object1='@first/state' object2='@second/state' " + rest + "/>";
  };
  EXPECT_EQ(errors(between("spring='1 0 1 0 1'")), "");
  for (const auto& [springs, message] : std::vector<std::pair<std::string, std::string>>{
           {between("spring='0 1 1 0 1'"), ".spring: 1 is not a node of 'state', must be a whole number from 0 to 0"},
           {between("spring='2 0 1 0 1'"), ".spring: 2 is not a node of 'state', must be a whole number from 0 to 1"},
           {between("indices1='0' indices2='1'"), ".indices2: 1 must lie in [0, 1)"},
           {between("indices1='0 1' indices2='0'"), ".indices2: 1 nodes given for 2 of indices1, must be as many"},
           {"<SpringForceField object1='@first/state' object2='@third/state'/>", ".object2: link '@third/state' stops"},
           {"<SpringForceField object1='@first/state' object2='@euler'/>",
            ".object2: the link leads to EulerImplicitSolver 'euler', must lead to a MechanicalState"},
           {"<SpringForceField object1='@first/state'/>", ": needs a MechanicalState in its node or above"}})
    EXPECT_TRUE(errors(springs).starts_with("test.scn:4: error: SpringForceField" + message)) << errors(springs);
  EXPECT_EQ(
      errors("", "", "<SpringForceField object1='@all/first' object2='@all/second' spring='0 0 1 0 1'/>"),
      "test.scn:1: error: SpringForceField: stands outside of the node '/all' of EulerImplicitSolver 'euler', which "
      "moves the states: must stand in it or below, as in SOFA");
  const std::string two =
      "<Node dt='.01'><DefaultAnimationLoop/><Node name='a'><EulerImplicitSolver/><SparseLDLSolver/><MechanicalObject "
      "name='state' position='0 0 0'/>" +
      kVertexMass +
      "</Node><Node name='b'><EulerImplicitSolver/><SparseLDLSolver/>"
      "<MechanicalObject name='other' position='0 0 0'/>" +
      kVertexMass +
      "</Node>"
      "<SpringForceField object1='@a' object2='@b' spring='0 0 1 0 1'/></Node>";
  EXPECT_EQ(errors_of(two),
            "test.scn:1: error: SpringForceField.object2: leads to 'other', which another time integrator moves than "
            "'state': both need one time integrator and one linear solver in a node above both");
}

}  // namespace
