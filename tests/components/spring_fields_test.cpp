// SPDX-License-Identifier: LGPL-2.1-or-later
// Springs within a mechanical state and between two.
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/solve/energy_balance.hpp"
#include "support/compare.hpp"
#include "support/mesh_text.hpp"
#include "support/shapes.hpp"
#include "support/two_states.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

// Nodes 0 (1, 0, 0) and 1 (0, 2, 0): sqrt(5) m apart, 2 m at rest, 10 N/m.
TEST(SpringForceField, TakesWholeSpringsOrLists) {
  const double tension = 10 * (std::sqrt(5) - 2);
  const Eigen::RowVector3d force = tension / std::sqrt(5) * Eigen::RowVector3d(-1, 2, 0);
  for (const char* springs :
       {"spring='0 1 10 0 2'", "indices1='0' indices2='1' stiffness='10' damping='0' lengths='2'"}) {
    scene::Scene scene = read_and_init(four_nodes(std::string("<SpringForceField name='s' ") + springs + "/>"));
    const PointArray f = force_of(scene, "s", 0);
    EXPECT_LT((f.row(0) - force).norm(), 1e-14) << springs;
    EXPECT_LT((f.row(1) + force).norm(), 1e-14) << springs;
    EXPECT_EQ(f.row(2).norm() + f.row(3).norm(), 0);
  }
}

TEST(SpringForceField, MistakesAreNamed) {
  expect_errors(four_nodes, {{"<SpringForceField spring='0 1 10 0'/>",
                              "SpringForceField.spring: 4 numbers given, must be groups of 5"},
                             {"<SpringForceField spring='0 1.5 10 0 1'/>",
                              "SpringForceField.spring: 1.5 is not a node, must be a whole number from 0 to 3"},
                             {"<SpringForceField spring='0 4 10 0 1'/>",
                              "SpringForceField.spring: 4 is not a node, must be a whole number from 0 to 3"},
                             {"<SpringForceField indices1='0 1' indices2='1'/>",
                              "SpringForceField.indices2: 1 nodes given for 2 of indices1, must be as many"}});
}

TEST(RestShapeSpringsForceField, PullsToWhereAnotherStateIs) {
  const auto text = [](const std::string& attributes) {
    return "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
           "<MechanicalObject name='nodes' position='0 0 0  1 0 0'/><UniformMass vertexMass='1'/>"
           "<RestShapeSpringsForceField name='s' " +
           attributes + "/>" +
           node("hook",
                "<MechanicalObject name='state' position='3 4 0  0 0 2  1 1 0'/><UniformMass vertexMass='1'/>") +
           "</Node>";
  };
  const std::string to_hook = "external_rest_shape='@hook/state' ";
  scene::Scene scene = read_and_init(text(to_hook + "points='1 0' stiffness='10 100' external_points='2 0'"));
  at<scene::MechanicalState>(scene, "nodes").positions().row(0) << 0, 0, 1;
  EXPECT_EQ(force_of(scene, "s", 0), rows({{300, 400, -100}, {0, 10, 0}}));
  at<scene::MechanicalState>(scene, "hook/state").positions()(2, 1) = 3;
  EXPECT_EQ(force_of(scene, "s", 0).row(1), Eigen::RowVector3d(0, 30, 0));
  scene.step();
  EXPECT_EQ(positions(scene, "hook").row(0), Eigen::RowVector3d(3, 4, 0)) << "it feels nothing";

  const std::string field = "RestShapeSpringsForceField.", as_many = " for 2 nodes, must be";
  expect_errors(
      text,
      {{to_hook, field + "external_rest_shape: 3 points of 'state'" + as_many + " as many"},
       {to_hook + "external_points='1'", field + "external_points: 1 points of 'state'" + as_many + " as many"},
       {to_hook + "external_points='1 3'", field + "external_points: 3 must lie in [0, 3)"},
       {"external_points='1 2'", field + "external_points: given without external_rest_shape, the state that has them"},
       {"points='0 1' stiffness='1 2 3'", field + "stiffness: 3 values given" + as_many + " one or as many"}});
}

TEST(RestShapeSpringsForceField, PullsToWhereAnotherStateWasWhicheverMovesFirst) {
  const std::string moves = "<EulerImplicitSolver/><CGLinearSolver/>",
                    hook = node("hook", moves +
                                            "<MechanicalObject name='state' position='1 0 0' velocity='1 0 0'/>"
                                            "<UniformMass vertexMass='1'/>"),
                    body = node("body", moves +
                                            "<MechanicalObject name='state' position='0 0 0'/>"
                                            "<UniformMass vertexMass='1'/><RestShapeSpringsForceField "
                                            "external_rest_shape='@/hook/state' stiffness='10'/>");
  const std::string root = "<Node gravity='0 0 0'><DefaultAnimationLoop/>";
  scene::Scene before = read_and_init(root + hook + body + "</Node>"),
               behind = read_and_init(root + body + hook + "</Node>");
  for (int step = 0; step < 3; ++step) {
    before.step();
    behind.step();
    EXPECT_EQ(positions(before, "body"), positions(behind, "body"));
  }
}

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
  std::string in_first = "";  // behind all else in its node
  bool is_one_state = false;  // the slow way: all nodes in one state, whose springs have the numbers of that

  static constexpr std::array<int, 3> kCells{2, 2, 2}, kOtherCells{1, 2, 2};
  static const std::string kSprings;

  std::string of_mesh(const HexMesh& mesh) const {
    return mesh_topology(mesh) + "<MechanicalObject name='state'/>" + kVertexMass + material;
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
      bodies = node("first", of_mesh(joined(first, second)) + held + springs + anchor("27 31 35"));
    } else {
      bodies =
          springs + node("first", of_mesh(first) + held + in_first) + node("second", of_mesh(second) + anchor("0 4 8"));
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
  run(scene, steps);
  return blocks.is_one_state ? positions(scene, "first") : both(scene);
}

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
    EXPECT_TRUE(agrees(end_of(blocks, c.steps), expected, c.tolerance));
    blocks.springs.replace(blocks.springs.find("40 .1"), 5, "0 0");
    EXPECT_FALSE(agrees(end_of(blocks, c.steps), expected, 1e-5)) << "the springs matter";
  }
}

TEST(SpringsBetweenStates, HaveARayleighStiffness) {
  Blocks blocks, one{.springs = kInOneState, .is_one_state = true};
  for (Blocks* each : {&blocks, &one})
    each->springs.replace(each->springs.find("name="), 5, "rayleighStiffness='.05' name=");
  const PointArray damped = end_of(blocks, 40);
  EXPECT_TRUE(agrees(damped, end_of(one, 40), 1e-8));
  EXPECT_FALSE(agrees(damped, end_of({}, 40), 1e-5));
}

// Ends at embedded points that lie on nodes: 26, 23, 20 and 17 of the first block.
TEST(SpringsBetweenStates, MayLeadToStatesThatFollow) {
  Blocks blocks{.solver = "<CGLinearSolver iterations='2000' tolerance='1e-14' threshold='1e-40'/>"};
  const PointArray expected = end_of(blocks, 40);
  blocks.in_first =
      "<Node name='skin'><MechanicalObject name='points' position='.04 .04 .04  .04 .02 .04  .04 0 .04  .04 .04 .02'/>"
      "<BarycentricMapping/></Node>";
  blocks.springs =
      "<SpringForceField object1='@first/skin/points' object2='@second/state' "
      "spring='0 16 40 .1 .008  1 14 30 .2 .009  2 12 30 .1 .006  3 4 60 0 .005'/>";
  EXPECT_TRUE(agrees(end_of(blocks, 40), expected, 1e-9));

  const std::string refusal =
      "SpringForceField.object1: leads to 'points', which follows another state: no matrix has ";
  blocks.solver = "<SparseLDLSolver name='direct'/>";
  EXPECT_TRUE(has(errors_of(blocks.text()), refusal + "that, but SparseLDLSolver 'direct' needs one"));
  // so also where the other end is at rest
  const std::string hooked =
      "<Node dt='.01'><DefaultAnimationLoop/>" + node("hook", "<MechanicalObject position='0 0 1'/>") +
      node("body",
           "<EulerImplicitSolver/><SparseLDLSolver/><RegularGridTopology/><MechanicalObject/><UniformMass "
           "vertexMass='1'/>" +
               node("skin", "<MechanicalObject name='points' position='.5 .5 .5'/><BarycentricMapping/>") +
               "<SpringForceField object1='@skin' object2='@/hook' spring='0 0 400 .1 .05'/>") +
      "</Node>";
  EXPECT_TRUE(has(errors_of(hooked), refusal));
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
  run(scene, 200);
  run(fixed, 200);
  EXPECT_TRUE(agrees(positions(scene, "hanging").row(0), positions(fixed, "hanging").row(0), 1e-13));
  EXPECT_EQ(positions(scene, "hook"), rows({{7, 7, 7}, {0, 0, 0}}));
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
             "name='state'/><UniformMass totalMass='.5'/><HexahedronElastoplasticFEMForceField youngModulus='2000'/>") +
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
  run(scene, 60);
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
