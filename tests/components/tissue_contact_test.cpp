// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hexaplast/body.hpp"
#include "support/two_states.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// A block that is held at its bottom, "first", and one on it, "second", of 20 g each.
struct Stack {
  std::string contact = "friction='.4'";
  std::string gravity = "0 0 -9.81";
  std::string lower = "n='5 5 3' max='.04 .04 .02'";
  std::string upper = "n='3 3 3' min='.0113 .013 .02' max='.0313 .033 .04'";
  std::string held = "0-24";
  std::string material = "youngModulus='10000' poissonRatio='.4'";
  std::string integrator = "<EulerImplicitSolver rayleighStiffness='.01' rayleighMass='.1'/>";
  std::string above = "", above_upper = "";  // the contact, in the root; the upper body, in its node
  std::string inside_upper = "";
  double dt = 0.005;

  std::string text() const {
    const auto body = [&](const std::string& name, const std::string& grid, const std::string& before,
                          const std::string& behind) {
      return node(name, before + "<RegularGridTopology " + grid +
                            "/><MechanicalObject name='state'/><UniformMass totalMass='.02'/>" + behind +
                            "<HexahedronElastoplasticFEMForceField name='body' " + material + "/>");
    };
    return "<Node dt='" + std::to_string(dt) + "' gravity='" + gravity + "'><DefaultAnimationLoop/>" + integrator +
           "<SparseLDLSolver/>" + above +
           "<TissueContactForceField name='contact' object1='@first/state' object2='@second/state' " + contact + "/>" +
           body("first", lower, "", "<FixedProjectiveConstraint indices='" + held + "'/>") +
           body("second", upper, above_upper, inside_upper) + "</Node>";
  }
};

/// On a slope of so many degrees.
std::string gravity_at(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return std::to_string(9.81 * std::sin(angle)) + " 0 " + std::to_string(-9.81 * std::cos(angle));
}

// Below the angle of friction: it presses with its weight, and comes to rest.
TEST(TissueContactForceField, ABlockOnABlockSticks) {
  Stack stack{.gravity = gravity_at(15)};
  stack.upper = "n='3 3 2' min='.0013 .013 .02' max='.0213 .033 .03'";
  scene::Scene scene = read_and_init(stack.text());
  auto& contact = at<scene::Component>(scene, "contact");
  run(scene, 1000);
  const double weight = 0.02 * 9.81, angle = 15 * std::numbers::pi / 180;
  EXPECT_LT((contact.vector3("force") - weight * Vec3(std::sin(angle), 0, -std::cos(angle))).norm(), 1e-5 * weight);
  EXPECT_LT(at<scene::MechanicalState>(scene, "second/state").velocities().cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(contact.reals("depth")[0], 1e-4) << "a hundredth of a cell";
  EXPECT_EQ(contact.reals("slipping")[0], 0);
  const PointArray before = positions(scene, "second");
  run(scene, 2000);
  EXPECT_LT((positions(scene, "second") - before).cwiseAbs().maxCoeff(), 1e-8) << "10 s later";
}

// Above it slides, over the samples of a longer one at up to .7 m/s, as a rigid one does: m (g sin a - mu g cos a), and
// no step has much more than mu N.
TEST(TissueContactForceField, ABlockSlidesOnABlockWithFriction) {
  for (const double friction : {0.1, 0.3}) {
    const double h = 0.002, a = 20 * std::numbers::pi / 180, down = 9.81 * std::sin(a), into = 9.81 * std::cos(a);
    scene::Scene scene = read_and_init(Stack{.contact = "friction='" + std::to_string(friction) + "'",
                                             .gravity = gravity_at(20),
                                             .lower = "n='21 5 2' max='.2 .04 .01'",
                                             .upper = "n='3 3 2' min='.0013 .013 .01' max='.0213 .033 .02'",
                                             .held = "0-104",
                                             .material = "youngModulus='1e6' poissonRatio='.3'",
                                             .integrator = "<EulerImplicitSolver/>",
                                             .dt = h}
                                           .text());
    const auto speed = [&] { return at<scene::MechanicalState>(scene, "second/state").velocities().col(0).mean(); };
    run(scene, 50);
    const double before = speed();
    const std::vector<double>& force = at<scene::Component>(scene, "contact").reals("force");
    double max = 0;
    for (int step = 0; step < 100; ++step) {
      run(scene, 1);
      max = std::max(max, force[0] / (friction * -force[2]));
    }
    EXPECT_NEAR(down - (speed() - before) / (100 * h), friction * into, 0.005 * friction * into);
    EXPECT_LT(max, 1.2);
  }
}

// Contact, an instrument and a pressure that stand before a body have the surface that is left of it.
TEST(TissueContactForceField, ContinuesOnABodyThatHasTorn) {
  Stack stack;
  stack.material += " yieldStress='20' plasticFlowRate='20' hardening='1' fractureStress='60'";
  stack.inside_upper =
      "<InstrumentContactForceField name='tool' radius='.01' friction='.5' keyTimes='0 .2' positions='.021 .023 .06  "
      ".021 .023 .04'/><SurfacePressureForceField pressure='20' min='0 0 .035' max='.04 .04 .045'/>";
  scene::Scene straight = read_and_init(stack.text()), second = read_and_init(stack.text());
  const auto num_removed = [&] { return at<scene::ForceField>(straight, "second/body").body()->removed().size(); };
  for (int step = 0; step < 60 && num_removed() == 0; ++step) run(straight, 1);
  ASSERT_GT(num_removed(), 0u);
  ASSERT_LT(num_removed(), 8u) << "something is left";
  go_on_in(straight, second);
  run(straight, 5);
  run(second, 5);
  EXPECT_EQ(both(straight), both(second));
}

// One that lies deep in another, and a pair that touches twice.
TEST(TissueContactForceField, WarnsOfWhatIsHardlyMeant) {
  const auto warnings_in = [](const std::string& text, int steps = 0) {
    scene::Scene scene = read_and_init(text);
    run(scene, steps);
    return warnings_of(scene);
  };
  const std::string of_object2 = "test.scn:1: warning: TissueContactForceField.object2: ";
  EXPECT_EQ(warnings_in(Stack{}.text()), "");
  Stack deep;
  deep.upper = "n='3 3 3' min='.0113 .013 .005' max='.0213 .023 .015'";
  EXPECT_EQ(warnings_in(deep.text()), of_object2 + "the bodies begin 0.01 m deep in each other\n");
  deep.contact = "active='false'";
  EXPECT_EQ(warnings_in(deep.text()), "");

  // once, by the one that becomes active last
  Stack twice;
  twice.above = "<TissueContactForceField name='other' object1='@second/state' object2='@first/state'/>";
  const std::string same = of_object2 + "'other' is between the same bodies: both act, and their stiffnesses add up\n";
  EXPECT_EQ(warnings_in(twice.text()), same);
  twice.contact = "active='false'";
  twice.above += "<AttributeChange component='@contact' attribute='active' keyTimes='.01' values='1'/>";
  EXPECT_EQ(warnings_in(twice.text()), "");
  EXPECT_EQ(warnings_in(twice.text(), 5), same);
}

TEST(TissueContactForceField, RefusesWhatCannotBe) {
  Stack two;
  two.above_upper = "<EulerImplicitSolver/><SparseLDLSolver/>";
  EXPECT_NE(errors_of(two.text()).find("need one EulerImplicitSolver"), std::string::npos) << errors_of(two.text());
  EXPECT_NE(errors_of(four_nodes("<TissueContactForceField object1='@nodes'/>")).find("no body"), std::string::npos);
}

}  // namespace
