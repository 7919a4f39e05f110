// SPDX-License-Identifier: LGPL-2.1-or-later
// What both kinds of contact have in common: that with an instrument, and that between two bodies.
#include <gtest/gtest.h>

#include "hexaplast/base/parallel.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

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

// Whichever way the system is solved, and for any number of threads the same bits.
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

// One that is not active is one that is not there, to the last bit; it may be switched while the scene moves.
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

// In the step in which they become active first, in each run.
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
    EXPECT_NE(
        said.find(contact.is_of_tissues ? ".object2: the bodies begin to touch 0.0" : ".active: it becomes active 0.0"),
        std::string::npos)
        << said;
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

}  // namespace
