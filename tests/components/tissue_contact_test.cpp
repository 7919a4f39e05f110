// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::read_and_init;

struct Stack {
  std::string contact = "friction='.4'";
  std::string solver = "<SparseLDLSolver/>";
  std::string integrator = "<EulerImplicitSolver rayleighStiffness='.01' rayleighMass='.1'/>";
  std::string gravity = "0 0 -9.81";
  std::string upper = "n='3 3 3' min='.0113 .013 .02' max='.0313 .033 .04'";
  std::string above_solver = "";  // in the node of the upper body

  // A block of 4 x 4 x 2 cells of 1 cm that is held at its bottom, and one of 2 x 2 x 2 on it.
  std::string text() const {
    const auto body = [&](const std::string& name, const std::string& grid, const std::string& rest) {
      return "<Node name='" + name + "'>" + rest + "<RegularGridTopology " + grid +
             "/><MechanicalObject name='state'/><UniformMass totalMass='.02'/>"
             "<HexahedronElastoplasticFEMForceField youngModulus='10000' poissonRatio='.4'/>";
    };
    return "<Node dt='.005' gravity='" + gravity + "'><DefaultAnimationLoop/>" + integrator + solver +
           "<TissueContactForceField name='contact' object1='@lower/state' object2='@upper/state' " + contact + "/>" +
           body("lower", "n='5 5 3' max='.04 .04 .02'", "") + "<FixedProjectiveConstraint indices='0-24'/></Node>" +
           body("upper", upper, above_solver) + "</Node></Node>";
  }
};

PointArray positions(scene::Scene& scene, const std::string& body) {
  return at<scene::MechanicalState>(scene, body + "/state").positions();
}
double number(scene::Scene& scene, const std::string& output) {
  return at<scene::Component>(scene, "contact").reals(output)[0];
}

// What lies on another body presses with its weight, and comes to rest.
TEST(TissueContactForceField, CarriesTheWeight) {
  scene::Scene scene = read_and_init(Stack{}.text());
  support::run(scene, 1000);
  const std::vector<double>& force = at<scene::Component>(scene, "contact").reals("force");
  EXPECT_NEAR(force[2], -0.02 * 9.81, 1e-6 * 0.02 * 9.81);
  EXPECT_LT(std::hypot(force[0], force[1]), 1e-6 * 0.02 * 9.81);
  EXPECT_LT(at<scene::MechanicalState>(scene, "upper/state").velocities().cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(number(scene, "depth"), 1e-4) << "a hundredth of a cell";
  const PointArray before = positions(scene, "upper");
  support::run(scene, 1000);
  EXPECT_LT((positions(scene, "upper") - before).cwiseAbs().maxCoeff(), 1e-8) << "5 s later";
}

// Below the angle of friction the upper block stays.
TEST(TissueContactForceField, ABlockOnABlockSticks) {
  const double a = 15 * std::numbers::pi / 180;
  Stack stack{.gravity = std::to_string(9.81 * std::sin(a)) + " 0 " + std::to_string(-9.81 * std::cos(a))};
  stack.upper = "n='3 3 2' min='.0013 .013 .02' max='.0213 .033 .03'";
  scene::Scene scene = read_and_init(stack.text());
  support::run(scene, 600);
  const double rest = positions(scene, "upper").col(0).mean();
  support::run(scene, 2000);
  EXPECT_LT(std::abs(positions(scene, "upper").col(0).mean() - rest), 1e-6 * 0.04) << "in 10 s";
  EXPECT_EQ(number(scene, "slipping"), 0);
}

// Above it slides, over the samples of a longer one at up to .7 m/s, as a rigid one does: m (g sin a - mu g cos a), and
// no step has much more than mu N.
TEST(TissueContactForceField, ABlockSlidesOnABlockWithFriction) {
  for (const double friction : {0.1, 0.3}) {
    const double h = 0.002, a = 20 * std::numbers::pi / 180, down = 9.81 * std::sin(a), into = 9.81 * std::cos(a);
    const auto body = [](const std::string& name, const std::string& grid) {
      return "<Node name='" + name + "'><RegularGridTopology " + grid +
             "/><MechanicalObject name='state'/><UniformMass totalMass='.02'/>"
             "<HexahedronElastoplasticFEMForceField youngModulus='1e6' poissonRatio='.3'/>";
    };
    scene::Scene scene = read_and_init(
        "<Node dt='" + std::to_string(h) + "' gravity='" + std::to_string(down) + " 0 " + std::to_string(-into) +
        "'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/><TissueContactForceField name='contact' "
        "object1='@lower/state' object2='@upper/state' friction='" +
        std::to_string(friction) + "'/>" + body("lower", "n='21 5 2' max='.2 .04 .01'") +
        "<FixedProjectiveConstraint indices='0-104'/></Node>" +
        body("upper", "n='3 3 2' min='.0013 .013 .01' max='.0213 .033 .02'") + "</Node></Node>");
    const auto speed = [&] { return at<scene::MechanicalState>(scene, "upper/state").velocities().col(0).mean(); };
    support::run(scene, 50);
    const double before = speed();
    const std::vector<double>& force = at<scene::Component>(scene, "contact").reals("force");
    double max = 0;
    for (int step = 0; step < 100; ++step) {
      support::run(scene, 1);
      max = std::max(max, force[0] / (friction * -force[2]));
    }
    EXPECT_NEAR(down - (speed() - before) / (100 * h), friction * into, 0.005 * friction * into);
    EXPECT_LT(max, 1.2);
  }
}

// The same whichever way the system is solved, for any number of threads the same bits, and it turns with the scene.
TEST(TissueContactForceField, DoesNotDependOnTheSolver) {
  Stack stack;
  stack.gravity = "5 1 -9.81";  // it slips
  const auto end_with = [&](const std::string& solver) {
    stack.solver = solver;
    scene::Scene scene = read_and_init(stack.text());
    support::run(scene, 60);
    return positions(scene, "upper");
  };
  const PointArray direct = end_with("<SparseLDLSolver/>");
  for (const std::string solver :
       {"<CGLinearSolver iterations='5000' tolerance='1e-14' threshold='1e-40'/>",
        "<MultigridCGLinearSolver tolerance='1e-12' iterations='2000'/>",
        "<MultigridCGLinearSolver tolerance='1e-12' iterations='2000' preconditioner='diagonal'/>"})
    EXPECT_TRUE(support::agrees(end_with(solver), direct, 1e-7)) << solver;
  set_num_threads(3);
  const PointArray three = end_with("<MultigridCGLinearSolver/>");
  set_num_threads(1);
  EXPECT_EQ(end_with("<MultigridCGLinearSolver/>"), three);
}

// Nothing from outside: the momentum of two free bodies that meet stays, and they part again.
TEST(TissueContactForceField, BodiesThatMeetKeepTheirMomentum) {
  Stack stack{.contact = "friction='.3'", .integrator = "<EulerImplicitSolver/>", .gravity = "0 0 0"};
  stack.upper = "n='3 3 3' min='.0113 .013 .021' max='.0313 .033 .041'";
  std::string text = stack.text();
  const std::string held = "<FixedProjectiveConstraint indices='0-24'/>";
  text.replace(text.find(held), held.size(), "");
  scene::Scene scene = read_and_init(text);
  auto& upper = at<scene::MechanicalState>(scene, "upper/state");
  auto& lower = at<scene::MechanicalState>(scene, "lower/state");
  upper.velocities().rowwise() = Eigen::RowVector3d(0.05, 0.02, -0.3);
  const auto momentum = [&]() -> Eigen::RowVector3d {
    return 0.02 * (upper.velocities().colwise().mean() + lower.velocities().colwise().mean());
  };
  const auto angular = [&] {
    Vec3 sum = Vec3::Zero();
    for (scene::MechanicalState* state : {&upper, &lower})
      for (int n = 0; n < state->num_nodes(); ++n)
        sum += 0.02 / state->num_nodes() *
               Vec3(state->positions().row(n).transpose()).cross(Vec3(state->velocities().row(n).transpose()));
    return sum;
  };
  const Eigen::RowVector3d before = momentum();
  const Vec3 angular_before = angular();
  int touched = 0;
  for (int k = 0; k < 60; ++k) {
    scene.step();
    touched = std::max(touched, static_cast<int>(number(scene, "touching")));
  }
  EXPECT_GT(touched, 20);
  EXPECT_EQ(number(scene, "touching"), 0);
  EXPECT_LT((momentum() - before).norm(), 1e-12 * before.norm());
  EXPECT_LT((angular() - angular_before).norm(), 0.02 * angular_before.norm()) << "linearised steps";
}

// A ball's worth of speed: a corner that meets a face at a cell and more per step does not pass it.
TEST(TissueContactForceField, DoesNotMissWhatIsFast) {
  for (const double speed : {0.5, 2.0, 6.0}) {
    Stack stack;
    stack.upper = "n='3 3 3' min='.0113 .013 .045' max='.0313 .033 .065'";
    scene::Scene scene = read_and_init(stack.text());
    at<scene::MechanicalState>(scene, "upper/state").velocities().col(2).setConstant(-speed);
    int touched = 0;
    for (int k = 0; k < 40; ++k) {
      scene.step();
      touched += number(scene, "touching") > 0;
      ASSERT_GT(positions(scene, "upper").col(2).mean(), 0.01) << speed << " m/s, step " << k;
    }
    EXPECT_GT(touched, 0) << speed;
  }
}

// A strip that falls on itself, bent: the upper end comes to rest on the lower one.
TEST(TissueContactForceField, AStripLiesOnItself) {
  // bent as it is made, along its length
  std::string positions_text, hexahedra;
  const int n = 24;
  const auto add = [](std::string& text, double number) { text += std::to_string(number) + " "; };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= 2; ++j)
      for (int k = 0; k <= 1; ++k) {
        const double along = 0.01 * i - 0.1, up = 0.01 * k, radius = 0.025;
        const double turn = std::clamp(along / 0.06, 0.0, 1.0) * std::numbers::pi;
        const double x = along <= 0 ? along : std::sin(turn) * (radius - up) - std::max(along - 0.06, 0.0);
        const double z = along <= 0 ? up : radius - std::cos(turn) * (radius - up);
        add(positions_text, x);
        add(positions_text, 0.01 * j);
        add(positions_text, z);
      }
  const auto node = [](int i, int j, int k) { return std::to_string(6 * i + 2 * j + k) + " "; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2; ++j)
      hexahedra += node(i, j, 0) + node(i + 1, j, 0) + node(i + 1, j + 1, 0) + node(i, j + 1, 0) + node(i, j, 1) +
                   node(i + 1, j, 1) + node(i + 1, j + 1, 1) + node(i, j + 1, 1);
  const auto text = [&](const std::string& contact) {
    return "<Node dt='.005' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver rayleighStiffness='.02' "
           "rayleighMass='.5'/><SparseLDLSolver/>" +
           contact + "<HexahedronSetTopologyContainer position='" + positions_text + "' hexahedra='" + hexahedra +
           "'/><MechanicalObject name='nodes'/><UniformMass totalMass='.05'/>"
           "<BoxROI name='ground' box='-1 -1 -1 1 1 .0095'/><FixedProjectiveConstraint indices='@ground.indices'/>"
           "<HexahedronElastoplasticFEMForceField youngModulus='2500' poissonRatio='.3'/></Node>";
  };
  const auto lowest_of_end = [](scene::Scene& scene) {
    const PointArray& x = support::nodes(scene);
    return x.bottomRows(6 * 5).col(2).minCoeff();
  };
  scene::Scene without = read_and_init(text(""));
  support::run(without, 400);
  EXPECT_LT(lowest_of_end(without), 0.005) << "it falls into itself";
  scene::Scene with = read_and_init(text("<TissueContactForceField name='contact' friction='.3' object1='@nodes'/>"));
  support::run(with, 400);
  EXPECT_GT(lowest_of_end(with), 0.009);
  EXPECT_GT(at<scene::Component>(with, "contact").reals("touching")[0], 5);
}

// Two that do not touch fall through each other as they do without the component, to the last bit.
TEST(TissueContactForceField, CanBeSwitchedOff) {
  for (const std::string solver : {"<SparseLDLSolver/>", "<MultigridCGLinearSolver/>"}) {
    Stack off{.contact = "friction='.4' active='false'", .solver = solver}, on{.solver = solver};
    std::string without = off.text();
    without.erase(without.find("<TissueContact"),
                  without.find("/>", without.find("<TissueContact")) + 2 - without.find("<TissueContact"));
    scene::Scene first = read_and_init(off.text()), second = read_and_init(without), third = read_and_init(on.text());
    for (scene::Scene* scene : {&first, &second, &third}) support::run(*scene, 20);
    for (const char* body : {"lower", "upper"}) EXPECT_EQ(positions(first, body), positions(second, body)) << solver;
    EXPECT_EQ(number(first, "touching"), 0);
    EXPECT_LT(positions(first, "upper").col(2).minCoeff(), 0.01) << "10 mm below the surface";
    EXPECT_GT(positions(third, "upper").col(2).minCoeff(), 0.019);
  }
}

// Contact, an instrument and a pressure that stand before a body have the surface that is left of it.
TEST(TissueContactForceField, ContinuesOnABodyThatHasTorn) {
  Stack stack;
  std::string text = stack.text();
  const auto insert = [&](std::string_view before, const std::string& what) {
    text.insert(text.find(before, text.find("<Node name='upper'>")), what);
  };
  insert(
      "<HexahedronElasto",
      "<InstrumentContactForceField name='tool' radius='.01' friction='.5' keyTimes='0 .2' positions='.021 .023 .06  "
      ".021 .023 .04'/><SurfacePressureForceField pressure='20' min='0 0 .035' max='.04 .04 .045'/>");
  insert("youngModulus", "yieldStress='20' plasticFlowRate='20' hardening='1' fractureStress='60' ");
  scene::Scene straight = read_and_init(text), second = read_and_init(text);
  const auto num_removed = [](scene::Scene& scene) {
    return at<scene::MechanicalState>(scene, "upper/state")
        .node()
        .all<scene::ForceField>()
        .back()
        ->body()
        ->removed()
        .size();
  };
  for (int step = 0; step < 60 && num_removed(straight) == 0; ++step) support::run(straight, 1);
  ASSERT_GT(num_removed(straight), 0u);
  ASSERT_LT(num_removed(straight), 8u) << "something is left";
  support::go_on_in(straight, second);
  support::run(straight, 5);
  support::run(second, 5);
  for (const char* body : {"lower", "upper"}) EXPECT_EQ(positions(straight, body), positions(second, body)) << body;
}

// The softer body's stiffness as it is, also where the contact stands before it.
TEST(TissueContactForceField, TheDefaultStiffnessFollowsTheBodies) {
  std::string changed = Stack{}.text();
  changed.insert(changed.find("<HexahedronElasto"),
                 "<AttributeChange component='@body' attribute='youngModulus' keyTimes='0' values='1000'/>");
  std::string given = Stack{}.text();
  const std::string modulus = "youngModulus='10000'";
  given.replace(given.find(modulus), modulus.size(), "youngModulus='1000'");
  changed.insert(changed.find(modulus), "name='body' ");
  scene::Scene first = read_and_init(given), second = read_and_init(changed);
  support::run(first, 30);
  support::run(second, 30);
  EXPECT_LT(at<scene::Component>(first, "contact").reals("force")[2], -0.05);
  EXPECT_EQ(positions(first, "upper"), positions(second, "upper"));
}

// One that lies deep in another, and a pair that touches twice.
TEST(TissueContactForceField, WarnsOfWhatIsHardlyMeant) {
  const auto warnings_of = [](const std::string& text) {
    scene::Scene scene = read_and_init(text);
    return support::warnings_of(scene);
  };
  const std::string of_object2 = "test.scn:1: warning: TissueContactForceField.object2: ";
  EXPECT_EQ(warnings_of(Stack{}.text()), "");
  Stack deep;
  deep.upper = "n='3 3 3' min='.0113 .013 .005' max='.0213 .023 .015'";
  EXPECT_EQ(warnings_of(deep.text()), of_object2 + "the bodies begin 0.01 m deep in each other\n");
  deep.contact = "active='false'";
  EXPECT_EQ(warnings_of(deep.text()), "");

  std::string twice = Stack{}.text();
  twice.insert(twice.find("<TissueContact"),
               "<TissueContactForceField name='other' object1='@upper/state' object2='@lower/state'/>");
  EXPECT_EQ(warnings_of(twice),
            of_object2 + "'other' is between the same bodies: both act, and their stiffnesses add up\n");
}

// The same in the step in which it becomes active, once, by whichever of the two becomes active last.
TEST(TissueContactForceField, WarnsWhenItBecomesActive) {
  Stack deep;
  deep.upper = "n='3 3 3' min='.0113 .013 .005' max='.0213 .023 .015'";
  deep.contact = "active='false'";
  std::string text = deep.text();
  text.insert(text.find("<EulerImplicit"),
              "<AttributeChange component='@contact' attribute='active' keyTimes='.01 .02 .03' values='1;0;1'/>");
  text.insert(text.find("</Node></Node>") + 7,
              "<TissueContactForceField name='other' object1='@upper/state' object2='@lower/state'/>");
  scene::Scene scene = read_and_init(text);
  scene.diagnostics().take_warnings();  // of the other one
  std::string said;
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(said.empty(), k < 3) << k;
    scene.step();
    for (const scene::Message& warning : scene.diagnostics().take_warnings())
      said += warning.text.substr(0, warning.text.find(" m deep")) + "\n";
  }
  EXPECT_EQ(said.find("TissueContactForceField.object2: 'other' is between the same bodies: both act, and their "
                      "stiffnesses add up\nTissueContactForceField.object2: the bodies begin to touch 0.0"),
            0U)
      << said;
  EXPECT_EQ(std::ranges::count(said, '\n'), 2) << said;
}

TEST(TissueContactForceField, SaysWhichBodyHasBecomeTooSoft) {
  Stack stiff;
  stiff.contact = "contactStiffness='1e8'";
  std::string text = stiff.text();
  text.insert(text.find("<EulerImplicit"),
              "<AttributeChange component='@upper/body' attribute='youngModulus' keyTimes='.01' values='5'/>");
  const std::string of_upper = "youngModulus='10000'";
  text.insert(text.rfind(of_upper), "name='body' ");
  scene::Scene scene = read_and_init(text);
  support::run(scene, 2);
  EXPECT_TRUE(support::refuses<scene::SceneError>(
      [&] { scene.step(); }, {"contactStiffness: is 1e+08, must be at most ",
                              "the greatest Young's modulus of the body of object2 was 10000 Pa when that was "
                              "accepted, and is 5 Pa now"}));
}

TEST(TissueContactForceField, AnInactiveOneMayBeTooStiff) {
  Stack stiff;
  stiff.contact = "contactStiffness='1e8'";
  std::string text = stiff.text();
  text.insert(text.find("<EulerImplicit"),
              "<AttributeChange component='@upper/body' attribute='youngModulus' keyTimes='.01' values='5'/>"
              "<AttributeChange component='@contact' attribute='active' keyTimes='.01 .03' values='0; 1'/>");
  text.insert(text.rfind("youngModulus='10000'"), "name='body' ");
  scene::Scene scene = read_and_init(text);
  support::run(scene, 6);
  EXPECT_TRUE(support::refuses<scene::SceneError>(
      [&] { scene.step(); },
      {"contactStiffness: is 1e+08, must be at most ", "was 10000 Pa when that was accepted, and is 5 Pa now"}));

  scene::Scene damped = read_and_init(Stack{.contact = "damping='1e300'"}.text());
  EXPECT_TRUE(support::refuses<scene::SceneError>([&] { damped.step(); }, {"damping: is 1e+300, must be at most "}));
}

TEST(TissueContactForceField, RefusesWhatCannotBe) {
  Stack two;
  two.above_solver = "<EulerImplicitSolver/><SparseLDLSolver/>";
  EXPECT_NE(errors_of(two.text()).find("need one EulerImplicitSolver"), std::string::npos) << errors_of(two.text());
  for (const auto& [contact, message] :
       {std::pair("friction='-1'", "friction"), std::pair("contactStiffness='0'", "contactStiffness"),
        std::pair("contactStiffness='1e14'", "contactStiffness"),
        std::pair("tangentialStiffness='1e14'", "tangentialStiffness"),
        std::pair("maxSubdivision='0'", "maxSubdivision"), std::pair("contactDistance='.006'", "contactDistance")})
    EXPECT_NE(errors_of(Stack{.contact = contact}.text()).find(message), std::string::npos) << contact;
  EXPECT_NE(
      errors_of(Stack{.integrator = "<EulerImplicitSolver trapezoidalScheme='true'/>"}.text()).find("trapezoidal"),
      std::string::npos);
  EXPECT_NE(
      errors_of("<Node><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
                "<MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/><TissueContactForceField/></Node>")
          .find("no body"),
      std::string::npos);
}

}  // namespace
