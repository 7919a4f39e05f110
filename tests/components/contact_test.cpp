// SPDX-License-Identifier: LGPL-2.1-or-later
// What both kinds of contact have in common: that with an instrument, and that between two bodies.
#include <cmath>
#include <numbers>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"
#include "support/two_states.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// A block, "upper/body", that a tool strokes or that lies on another block.
struct Contact {
  bool is_of_tissues;
  std::string attributes = "friction='.4'";
  std::string solver = "<SparseLDLSolver/>";
  std::string integrator = "<EulerImplicitSolver rayleighStiffness='.01' rayleighMass='.1'/>";
  std::string changes = "";
  std::string modulus = "10000";
  std::string gravity = "5 1 -9.81";
  bool is_there = true;
  bool is_deep = false;  // at the beginning

  std::string class_name() const { return is_of_tissues ? "TissueContactForceField" : "InstrumentContactForceField"; }
  std::string path() const { return is_of_tissues ? "contact" : "upper/contact"; }

  std::string text() const {
    const auto body = [&](const std::string& name, const std::string& grid, const std::string& rest) {
      return "<Node name='" + name + "'><RegularGridTopology " + grid +
             "/><MechanicalObject name='state'/><UniformMass totalMass='.02'/>" + rest +
             "<HexahedronElastoplasticFEMForceField name='body' poissonRatio='.4' youngModulus='" + modulus +
             "'/></Node>";
    };
    const std::string contact = is_there ? "<" + class_name() + " name='contact' " + attributes : "",
                      held = "<FixedProjectiveConstraint indices='0-24'/>", large = "n='5 5 3' max='.04 .04 .02'";
    std::string inside;
    if (is_of_tissues) {
      inside = (is_there ? contact + " object1='@lower/state' object2='@upper/state'/>" : "") +
               body("lower", large, held) +
               body("upper",
                    is_deep ? "n='3 3 3' min='.0113 .013 .005' max='.0213 .023 .015'"
                            : "n='3 3 3' min='.0113 .013 .02' max='.0313 .033 .04'",
                    "");
    } else {
      const std::string way = is_deep
                                  ? "keyTimes='0' positions='.02 .02 .022'"
                                  : "keyTimes='0 .05 .4' positions='.021 .019 .029  .021 .019 .025  .026 .019 .025'";
      inside = body("upper", large, held + (is_there ? contact + " radius='.008' " + way + "/>" : ""));
    }
    return "<Node dt='.005' gravity='" + gravity + "'><DefaultAnimationLoop/>" + changes + integrator + solver +
           inside + "</Node>";
  }
};

PointArray all_positions(scene::Scene& scene) {
  std::vector<double> all;
  for (scene::MechanicalState* state : scene.root().all<scene::MechanicalState>())
    all.insert(all.end(), state->positions().data(), state->positions().data() + state->positions().size());
  return Eigen::Map<PointArray>(all.data(), static_cast<Eigen::Index>(all.size()) / 3, 3);
}

class ContactFields : public testing::TestWithParam<bool> {
 protected:
  /// [N] along z, on what the block touches.
  double pressure(scene::Scene& scene) const { return at<scene::Component>(scene, contact.path()).reals("force")[2]; }

  Contact contact{.is_of_tissues = GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Both, ContactFields, testing::Bool(),
                         [](const auto& test) { return test.param ? "Tissues" : "Instrument"; });

TEST_P(ContactFields, DoNotDependOnTheSolver) {
  const auto end_with = [&](const std::string& solver) {
    contact.solver = solver;
    scene::Scene scene = read_and_init(contact.text());
    run(scene, 30);
    EXPECT_GT(at<scene::Component>(scene, contact.path()).reals("slipping")[0], 0);
    return all_positions(scene);
  };
  const PointArray direct = end_with("<SparseLDLSolver/>");
  for (const std::string solver :
       {"<CGLinearSolver iterations='5000' tolerance='1e-14' threshold='1e-40'/>",
        "<MultigridCGLinearSolver tolerance='1e-12' iterations='2000' preconditioner='multigrid'/>",
        "<MultigridCGLinearSolver tolerance='1e-12' iterations='2000' preconditioner='diagonal'/>"})
    EXPECT_TRUE(agrees(end_with(solver), direct, 1e-7)) << solver;
  set_num_threads(3);
  const PointArray three = end_with("<MultigridCGLinearSolver/>");
  set_num_threads(1);
  EXPECT_EQ(end_with("<MultigridCGLinearSolver/>"), three);
}

TEST_P(ContactFields, CanBeSwitchedOff) {
  for (const std::string solver : {"<SparseLDLSolver/>", "<MultigridCGLinearSolver/>"}) {
    contact.solver = solver;
    Contact is_off = contact, is_not_there = contact;
    is_off.attributes = "friction='.4' active='false'";
    is_not_there.is_there = false;
    scene::Scene on = read_and_init(contact.text()), off = read_and_init(is_off.text()),
                 without = read_and_init(is_not_there.text());
    for (scene::Scene* scene : {&on, &off, &without}) run(*scene, 20);
    EXPECT_EQ(all_positions(off), all_positions(without)) << solver;
    EXPECT_EQ(pressure(off), 0);
    EXPECT_NE(all_positions(on), all_positions(without));
    EXPECT_NE(pressure(on), 0);

    auto& field = at<scene::Component>(on, contact.path());
    for (const bool is_active : {false, true}) {
      field.find_data("active")->set(is_active, {});
      field.follow_inputs();
      on.step();
      EXPECT_EQ(pressure(on) != 0, is_active);
      EXPECT_EQ(field.reals("touching")[0] > 0, is_active);
    }
  }
}

// A state that was loaded tells what touched, goes on with the same bits, and returns to the beginning, also after
// changes: of the contact before one of the body, and of the samples.
TEST_P(ContactFields, ContinueWhereTheyTouch) {
  for (const std::string& changes : {std::string(),
                                     attribute_change(contact.path(), "friction", ".03", ".8") +
                                         attribute_change("upper/body", "youngModulus", ".06", "9000"),
                                     attribute_change(contact.path(), "maxSubdivision", ".05", "3")}) {
    contact.changes = changes;
    scene::Scene straight = read_and_init(contact.text()), second = read_and_init(contact.text());
    run(straight, 20);
    go_on_in(straight, second);
    EXPECT_NE(pressure(second), 0);
    for (const char* output : {"force", "touching", "slipping"})
      EXPECT_EQ(at<scene::Component>(second, contact.path()).reals(output),
                at<scene::Component>(straight, contact.path()).reals(output));
    run(straight, 15);
    run(second, 15);
    EXPECT_EQ(all_positions(straight), all_positions(second)) << changes;
    second.reset();
    run(second, 35);
    EXPECT_EQ(all_positions(straight), all_positions(second)) << changes;
  }
}

// The default stiffness is that of the softer body as it is: with one whose modulus changes in the first step
// everything is as with one that had that modulus, though the contact stands before it.
TEST_P(ContactFields, TheDefaultStiffnessFollowsTheBody) {
  contact.gravity = "0 0 -9.81";
  Contact changed = contact;
  contact.modulus = "1000";
  changed.changes = attribute_change("upper/body", "youngModulus", "0", "1000");
  if (contact.is_of_tissues) changed.changes += attribute_change("lower/body", "youngModulus", "0", "1000");
  scene::Scene first = read_and_init(contact.text()), second = read_and_init(changed.text());
  run(first, 30);
  run(second, 30);
  EXPECT_GT(std::abs(pressure(first)), 0.02);
  EXPECT_EQ(pressure(first), pressure(second));
  EXPECT_EQ(all_positions(first), all_positions(second));
}

// A stiffness that was accepted is refused for a body that has become much softer, unless the contact is not active:
// it says what has changed. Neither may damping hold more than the greatest stiffness.
TEST_P(ContactFields, RefuseWhatHasBecomeTooStiff) {
  const std::string softened = attribute_change("upper/body", "youngModulus", ".01", "5"),
                    body = contact.is_of_tissues ? "the body of object2" : "the body that it touches";
  contact.attributes = "contactStiffness='1e8'";
  for (const auto& [changes, steps] : {std::pair(softened, 2),
                                       {softened + attribute_change(contact.path(), "friction", ".01", ".5"), 2},
                                       {softened + attribute_change(contact.path(), "active", ".01 .03", "0; 1"), 6}}) {
    contact.changes = changes;
    scene::Scene scene = read_and_init(contact.text());
    run(scene, steps);
    EXPECT_TRUE(refuses<scene::SceneError>(
        [&] { scene.step(); },
        {contact.class_name() + ".contactStiffness: is 1e+08, must be at most ",
         "; the greatest Young's modulus of " + body + " was 10000 Pa when that was accepted, and is 5 Pa now"}))
        << changes;
  }
  contact.changes = "";
  for (const char* damping : {"2e7", "1e9", "1e300"}) {
    contact.attributes = std::string("damping='") + damping + "'";
    scene::Scene scene = read_and_init(contact.text());
    if (std::string_view(damping) == "2e7")
      scene.step();
    else
      EXPECT_TRUE(refuses<scene::SceneError>([&] { scene.step(); },
                                             {"damping: is 1e+", "must be at most 3e+07 Pa s/m in steps of 0.005 s"}));
  }
}

TEST_P(ContactFields, WarnWhereTheyBecomeActiveWithinABody) {
  contact.is_deep = true;
  contact.attributes = "active='false'";
  contact.changes = attribute_change(contact.path(), "active", ".01 .02 .03", "1; 0; 1");
  scene::Scene scene = read_and_init(contact.text());
  EXPECT_EQ(warnings_of(scene), "");
  for (int round = 0; round < 2; ++round) {
    std::string said;
    for (int k = 0; k < 10; ++k) {
      EXPECT_EQ(said.empty(), k < 3) << k;
      scene.step();
      said += warnings_of(scene);
    }
    EXPECT_TRUE(has(
        said, contact.is_of_tissues ? ".object2: the bodies begin to touch 0.0" : ".active: it becomes active 0.0"));
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
    scene.reset();
  }
}

TEST_P(ContactFields, RefuseWhatCannotBe) {
  const std::string too_stiff =
      ": is 1e+14, must be at most 6e+09 Pa/m, 200 times the default of contactStiffness, 30 E / edge length";
  for (const auto& [attributes, message] :
       {std::pair("contactStiffness='1e14'", ".contactStiffness" + too_stiff),
        std::pair("tangentialStiffness='1e14'", ".tangentialStiffness" + too_stiff),
        std::pair("contactDistance='.006'",
                  std::string(".contactDistance: is 0.006, must be at most 0.005 m, half of the mean edge"))}) {
    contact.attributes = attributes;
    EXPECT_EQ(errors_of(contact.text()), "test.scn:1: error: " + contact.class_name() + message);
  }
  contact.attributes = "";
  contact.integrator = "<EulerImplicitSolver trapezoidalScheme='true'/>";
  EXPECT_EQ(errors_of(contact.text()),
            "test.scn:1: error: " + contact.class_name() +
                ": its EulerImplicitSolver has trapezoidalScheme: contact needs implicit Euler");
}

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
  EXPECT_TRUE(has(errors_of(two.text()), "need one EulerImplicitSolver"));
  EXPECT_TRUE(has(errors_of(four_nodes("<TissueContactForceField object1='@nodes'/>")), "no body"));
}

}  // namespace
