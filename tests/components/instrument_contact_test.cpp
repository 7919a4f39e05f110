// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/memory.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::nodes;
using support::read_and_init;

// A block of 6 x 6 x 3 cells of 1 cm, held at its bottom.
std::string block(const std::string& instruments, const std::string& solver = "<SparseLDLSolver/>",
                  const std::string& integrator = "<EulerImplicitSolver name='euler'/>") {
  return "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/>" + integrator + solver +
         "<RegularGridTopology n='7 7 4' max='.06 .06 .03'/><MechanicalObject name='nodes'/>"
         "<UniformMass totalMass='.1'/><FixedProjectiveConstraint indices='0-48'/>"
         "<HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' poissonRatio='.3'/>" +
         instruments + "</Node>";
}

Vec3 vector_of(scene::Scene& scene, const std::string& path, const std::string& output) {
  const std::vector<double>& numbers = at<scene::Component>(scene, path).reals(output);
  return {numbers[0], numbers[1], numbers[2]};
}
Vec3 force_on(scene::Scene& scene, const std::string& instrument) { return vector_of(scene, instrument, "force"); }

// A ball that goes 5 mm deep and out again.
constexpr std::string_view kPoke =
    "<InstrumentContactForceField name='probe' radius='.008' keyTimes='0 .3 .5 .8' "
    "positions='.031 .029 .04  .031 .029 .033  .031 .029 .033  .031 .029 .05'/>";

TEST(InstrumentContactForceField, PressesAndNeverPulls) {
  for (const std::string integrator :
       {"<EulerImplicitSolver/>", "<EulerImplicitSolver rayleighStiffness='.1' rayleighMass='.5'/>"}) {
    scene::Scene scene = read_and_init(block(std::string(kPoke), "<SparseLDLSolver/>", integrator));
    double greatest = 0, deepest = 0;
    for (int k = 0; k < 100; ++k) {
      scene.step();
      const double force = force_on(scene, "probe").z();
      EXPECT_GE(force, 0) << integrator << " step " << k;
      greatest = std::max(greatest, force);
      deepest = std::max(deepest, at<scene::Component>(scene, "probe").reals("depth")[0]);
    }
    EXPECT_GT(greatest, 0.05) << integrator;
    EXPECT_LT(deepest, 1.5e-3) << "a seventh of a cell, under a ball smaller than it";
    EXPECT_EQ(force_on(scene, "probe"), Vec3(0, 0, 0));
    EXPECT_EQ(at<scene::Component>(scene, "probe").reals("touching")[0], 0);
  }
}

// Rayleigh damping of the integrator does not act on contact: what rests on an instrument sinks no deeper with it.
TEST(InstrumentContactForceField, RayleighDampingLeavesItAlone) {
  // m v' = h (m g - K h v') from rest, whatever the damping is
  const auto gap_after = [](const std::string& integrator) {
    scene::Scene scene = read_and_init("<Node dt='.01' gravity='0 0 -9.81'><DefaultAnimationLoop/>" + integrator +
                                       "<SparseLDLSolver/><RegularGridTopology n='2 2 2' max='.02 .02 .02'/>"
                                       "<MechanicalObject name='nodes'/><UniformMass totalMass='.01'/>"
                                       "<HexahedronElastoplasticFEMForceField youngModulus='1e7'/>"
                                       "<InstrumentContactForceField name='plate' shape='box' size='1 1 .1' "
                                       "contactStiffness='1e4' keyTimes='0' positions='0 0 -.049999999'/></Node>");
    scene.step();
    return -nodes(scene)(0, 2);
  };
  // nodes at the bottom: area .02^2 and the halves of the four sides
  const double h = 0.01, m = 0.01, K = 1e4 * (0.02 * 0.02 + 4 * 0.02 * 0.01),
               expected = h * h * m * 9.81 / (m + h * h * K);
  EXPECT_NEAR(gap_after("<EulerImplicitSolver/>"), expected, 3e-5 * expected);
  EXPECT_NEAR(gap_after("<EulerImplicitSolver rayleighStiffness='.3'/>"), expected, 3e-5 * expected);
}

// The same whichever way the system is solved, and for any number of threads the same bits.
TEST(InstrumentContactForceField, DoesNotDependOnTheSolver) {
  const std::string stroke =
      "<InstrumentContactForceField shape='capsule' radius='.006' length='.03' friction='.4' keyTimes='0 .2 .6' "
      "positions='.02 .03 .037  .02 .03 .034  .04 .03 .034' orientations='.7071 0 0 .7071  .7071 0 0 .7071  .65 .2 .1 "
      ".7'/>";
  const auto end_with = [&](const std::string& solver) {
    scene::Scene scene = read_and_init(block(stroke, solver));
    support::run(scene, 60);
    return nodes(scene);
  };
  const PointArray direct = end_with("<SparseLDLSolver/>");
  EXPECT_TRUE(support::agrees(end_with("<CGLinearSolver iterations='2000' tolerance='1e-14' threshold='1e-40'/>"),
                              direct, 1e-7));
  for (const std::string preconditioner : {"multigrid", "diagonal"})
    EXPECT_TRUE(support::agrees(
        end_with("<MultigridCGLinearSolver tolerance='1e-12' preconditioner='" + preconditioner + "'/>"), direct, 1e-7))
        << preconditioner;
  set_num_threads(3);
  const PointArray three = end_with("<MultigridCGLinearSolver/>");
  set_num_threads(1);
  EXPECT_EQ(end_with("<MultigridCGLinearSolver/>"), three);
}

// A block on a slope: below the angle of friction it stays, above it slides as a rigid one does.
std::string slope(double degrees, double friction) {
  const double a = degrees * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
  const auto text = [](double number) { return std::to_string(number); };
  // gravity turns, the plate lies
  return "<Node dt='.005' gravity='" + text(9.81 * s) + " 0 " + text(-9.81 * c) +
         "'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
         "<RegularGridTopology n='5 5 3' min='0 0 0' max='.04 .04 .02'/><MechanicalObject name='nodes'/>"
         "<UniformMass totalMass='.032'/><HexahedronElastoplasticFEMForceField youngModulus='20000' poissonRatio='.3'/>"
         "<InstrumentContactForceField name='plate' shape='box' size='100 100 1' friction='" +
         text(friction) + "' keyTimes='0' positions='0 0 -.5'/></Node>";
}

TEST(InstrumentContactForceField, ABlockOnASlopeSticksOrSlides) {
  const auto centre = [](scene::Scene& scene) { return nodes(scene).col(0).mean(); };
  {
    scene::Scene scene = read_and_init(slope(20, 0.4));  // tan 20 deg = .364
    support::run(scene, 400);                            // it comes to rest
    const double rest = centre(scene);
    support::run(scene, 2000);
    EXPECT_LT(std::abs(centre(scene) - rest), 1e-6 * 0.04) << "in 10 s";
  }
  for (const double friction : {0.0, 0.1, 0.3}) {
    scene::Scene scene = read_and_init(slope(20, friction));
    support::run(scene, 200);
    const auto speed = [&] { return at<scene::MechanicalState>(scene, "nodes").velocities().col(0).mean(); };
    const double before = speed();
    support::run(scene, 100);
    const double angle = 20 * std::numbers::pi / 180,
                 expected = 9.81 * (std::sin(angle) - friction * std::cos(angle)) * 0.5;
    EXPECT_NEAR(speed() - before, expected, 0.02 * expected) << friction;
  }
}

// Two jaws close on a block, and pull: friction holds it, or it slips at 2 mu N.
TEST(InstrumentContactForceField, JawsHoldByFriction) {
  const auto pull = [](double friction) {
    const std::string jaw = "<InstrumentContactForceField shape='box' size='.02 .02 .01' friction='" +
                            std::to_string(friction) + "' keyTimes='0 .2 1.2' name='";
    scene::Scene scene = read_and_init(
        "<Node dt='.005' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver "
        "rayleighMass='5'/><SparseLDLSolver/>"
        "<RegularGridTopology n='9 3 3' min='0 -.01 -.01' max='.08 .01 .01'/><MechanicalObject name='nodes'/>"
        "<UniformMass totalMass='.03'/><FixedProjectiveConstraint indices='0 9 18 27 36 45 54 63 72'/>"
        "<HexahedronElastoplasticFEMForceField youngModulus='20000' poissonRatio='.3'/>" +
        jaw + "upper' positions='.07 0 .0155  .07 0 .0148  .078 0 .0148'/>" + jaw +
        "lower' positions='.07 0 -.0155  .07 0 -.0148  .078 0 -.0148'/></Node>");
    support::run(scene, 240);
    return std::pair(force_on(scene, "upper"), force_on(scene, "lower"));
  };
  const auto [upper, lower] = pull(0.3);
  EXPECT_GT(upper.z(), 0.05);
  EXPECT_NEAR(upper.z(), -lower.z(), 1e-6);
  EXPECT_NEAR(-(upper.x() + lower.x()), 2 * 0.3 * upper.z(), 0.03 * 2 * 0.3 * upper.z()) << "it slips";
  const auto [held, other] = pull(20);
  EXPECT_LT(-(held.x() + other.x()), 2 * 20 * held.z()) << "it holds";
  EXPECT_GT(-(held.x() + other.x()), 0.5);
}

TEST(InstrumentContactForceField, AScenesTurnTurnsIt) {
  // a quarter turn about y: z becomes x, x becomes -z
  const std::string plain =
      "<RegularGridTopology n='5 5 5' min='0 0 0' max='.04 .04 .04'/>"
      "<MechanicalObject name='nodes'/><InstrumentContactForceField name='probe' shape='cylinder' radius='.006' "
      "length='.02' friction='.5' keyTimes='0 .3' positions='.021 .019 .052  .025 .019 .047' "
      "orientations='0 0 0 1  0 .1 0 .995'/>";
  const std::string turned =
      "<RegularGridTopology n='5 5 5' min='0 0 -.04' max='.04 .04 0'/>"
      "<MechanicalObject name='nodes'/><InstrumentContactForceField name='probe' shape='cylinder' radius='.006' "
      "length='.02' friction='.5' keyTimes='0 .3' positions='.052 .019 -.021  .047 .019 -.025' "
      "orientations='0 .70710678118654752 0 .70710678118654752  0 .7742722470566705 0 .6328526585531692'/>";
  const auto force_of = [](const std::string& what, const std::string& fixed) {
    scene::Scene scene =
        read_and_init("<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>" +
                      what + "<UniformMass totalMass='.05'/><BoxROI name='end' box='" + fixed +
                      "'/><FixedProjectiveConstraint indices='@end.indices'/>"
                      "<HexahedronElastoplasticFEMForceField youngModulus='5000'/></Node>");
    support::run(scene, 40);
    return force_on(scene, "probe");
  };
  const Vec3 first = force_of(plain, "-1 -1 -.001  1 1 .001"), second = force_of(turned, "-.001 -1 -1  .001 1 1");
  EXPECT_GT(first.norm(), 0.05);
  EXPECT_NEAR(second.x(), first.z(), 1e-6 * first.norm());
  EXPECT_NEAR(second.z(), -first.x(), 1e-6 * first.norm());
  EXPECT_NEAR(second.y(), first.y(), 1e-6 * first.norm());
}

// One that is not active is one that is not there, to the last bit; it may be switched while the scene moves.
TEST(InstrumentContactForceField, CanBeSwitchedOff) {
  for (const std::string solver : {"<SparseLDLSolver/>", "<MultigridCGLinearSolver/>"}) {
    scene::Scene without = read_and_init(block("", solver)), off = support::read(block(std::string(kPoke), solver)),
                 on = read_and_init(block(std::string(kPoke), solver));
    scene::override_attribute(off, "probe.active=false");
    off.init();
    for (scene::Scene* scene : {&without, &off, &on}) support::run(*scene, 35);
    EXPECT_EQ(nodes(off), nodes(without)) << solver;
    EXPECT_EQ(force_on(off, "probe"), Vec3(0, 0, 0));
    EXPECT_NE(nodes(on), nodes(without));
    EXPECT_GT(force_on(on, "probe").z(), 0.05);

    auto& probe = at<scene::Component>(on, "probe");
    const auto switch_to = [&](bool is_active) {
      probe.find_data("active")->set(is_active, {});
      probe.follow_inputs();
      on.step();
    };
    switch_to(false);
    EXPECT_EQ(force_on(on, "probe"), Vec3(0, 0, 0));
    EXPECT_EQ(probe.reals("touching")[0], 0);
    switch_to(true);
    EXPECT_GT(force_on(on, "probe").z(), 0.05);
  }
}

// A needle with millions of samples far away: they are counted, each alone would fit, and are made when it comes near.
TEST(InstrumentContactForceField, MemoryIsCheckedForTheSumOfItsParts) {
  const std::string needle =
      "<InstrumentContactForceField radius='.0005' maxSubdivision='64' keyTimes='0' positions='0 0 5'/>";
  constexpr double kTwoThirdsMore = 150e6;  // [byte] one takes 104
  const GrantedMemory others = grant_memory("others", static_cast<double>(available_memory()) - kTwoThirdsMore);
  EXPECT_EQ(errors_of(block(needle)), "");
  const std::string errors = errors_of(block(needle + needle));
  EXPECT_NE(errors.find("maxSubdivision: contact at points of 144 faces, edges in 40 parts, needs about 0.104 GB"),
            std::string::npos)
      << errors;
}

TEST(InstrumentContactForceField, ContinuesWhereItSticks) {
  const std::string text = block(
      "<InstrumentContactForceField name='probe' radius='.01' friction='.8' keyTimes='0 .1 .4' "
      "positions='.03 .03 .042  .03 .03 .038  .036 .03 .038'/>");
  scene::Scene straight = read_and_init(text), second = read_and_init(text);
  support::run(straight, 20);
  support::go_on_in(straight, second);
  EXPECT_EQ(force_on(second, "probe"), force_on(straight, "probe"));
  EXPECT_GT(at<scene::Component>(second, "probe").reals("touching")[0], 0);
  for (const char* count : {"touching", "slipping"})
    EXPECT_EQ(at<scene::Component>(second, "probe").reals(count), at<scene::Component>(straight, "probe").reals(count));
  support::run(straight, 15);
  support::run(second, 15);
  EXPECT_EQ(nodes(straight), nodes(second));
  EXPECT_GT(std::abs(force_on(second, "probe").x()), 1e-3);

  second.reset();
  support::run(second, 35);
  EXPECT_EQ(nodes(straight), nodes(second));

  // one that was near goes on as one that was not yet
  std::string from_afar = text;
  from_afar.replace(from_afar.find(".03 .03 .042"), 12, ".03 .03 .142");
  scene::Scene far = read_and_init(from_afar), near = read_and_init(from_afar);
  support::run(far, 3);
  support::run(near, 12);
  support::go_on_in(far, near);
  support::run(far, 12);
  support::run(near, 12);
  EXPECT_EQ(nodes(far), nodes(near));
  EXPECT_GT(force_on(near, "probe").z(), 1e-3);
}

// Where it is when it is first active: at the beginning, or later.
TEST(InstrumentContactForceField, WarnsWhereItBecomesActiveWithinTheBody) {
  scene::Scene scene = read_and_init(
      block("<AttributeChange component='@ball' attribute='active' keyTimes='.02 .04 .06' values='true; false; true'/>"
            "<InstrumentContactForceField name='ball' radius='.008' keyTimes='0' active='false' "
            "positions='.03 .03 .032'/>"));
  std::string said;
  for (int k = 0; k < 8; ++k) {
    EXPECT_EQ(said.empty(), k < 3) << k;
    scene.step();
    for (const scene::Message& warning : scene.diagnostics().take_warnings()) said += warning.text;
  }
  EXPECT_EQ(said,
            "InstrumentContactForceField.active: it becomes active 0.006 m deep in the body, which is pushed out");
}

// And again after a reset, as then too it was not active at the beginning.
TEST(InstrumentContactForceField, WarnsInEachRun) {
  scene::Scene scene =
      read_and_init(block("<AttributeChange component='@ball' attribute='active' keyTimes='.02' values='true'/>"
                          "<InstrumentContactForceField name='ball' radius='.008' keyTimes='0' active='false' "
                          "positions='.03 .03 .032'/>"));
  const auto warnings = [&] {
    support::run(scene, 4);
    return scene.diagnostics().take_warnings().size();
  };
  EXPECT_EQ(warnings(), 1U);
  scene.reset();
  EXPECT_EQ(warnings(), 1U);
}

// A box that is pressed straight down, in one step or slowly, is not pushed aside: frictionless, it presses the same.
TEST(InstrumentContactForceField, ABoxThatComesDownFastPressesAsASlowOne) {
  const auto pressed = [](const std::string& arrival) {
    scene::Scene scene = read_and_init(
        "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighStiffness='.01'/>"
        "<SparseLDLSolver/><RegularGridTopology n='9 9 4' min='-.04 -.04 0' max='.04 .04 .03'/>"
        "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
        "<HexahedronElastoplasticFEMForceField youngModulus='5000'/><FixedProjectiveConstraint indices='0-80'/>"
        "<InstrumentContactForceField name='probe' shape='box' size='.02 .02 .02' keyTimes='0 " +
        arrival + "' positions='.001 0 .0405 .001 0 .0355'/></Node>");
    support::run(scene, 60);
    return force_on(scene, "probe");
  };
  const Vec3 fast = pressed(".01"), slow = pressed(".2");
  EXPECT_GT(slow.z(), 0.5);
  EXPECT_LT(std::hypot(fast.x(), fast.y()), 0.01 * fast.z());
  EXPECT_NEAR(fast.z(), slow.z(), 0.01 * slow.z());
}

// What the instrument reports is what changes the momentum of a free body, also where the integrator damps velocities.
TEST(InstrumentContactForceField, ReportsTheForceThatActed) {
  const double h = 0.01, mass = 0.05, decay = std::exp(-20 * h);
  scene::Scene scene = read_and_init(
      "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver vdamping='20'/><SparseLDLSolver/>"
      "<RegularGridTopology n='4 4 3' max='.03 .03 .02'/><MechanicalObject name='nodes'/>"
      "<UniformMass totalMass='.05'/><HexahedronElastoplasticFEMForceField youngModulus='5000' poissonRatio='.3'/>"
      "<InstrumentContactForceField name='probe' radius='.008' damping='2e5' keyTimes='0 .1 .2' "
      "positions='.015 .016 .029  .015 .016 .025  .015 .016 .019'/></Node>");
  const auto momentum = [&] {
    return Vec3(mass * at<scene::MechanicalState>(scene, "nodes").velocities().colwise().mean().transpose());
  };
  double greatest = 0;
  for (int k = 0; k < 20; ++k) {
    const Vec3 before = momentum();
    scene.step();
    const Vec3 acted = (momentum() / decay - before) / h, force = force_on(scene, "probe");
    greatest = std::max(greatest, force.norm());
    EXPECT_LT((acted + force).norm(), 1e-8) << k;
  }
  EXPECT_GT(greatest, 0.01);
}

// Both name what is too much: they end in numbers that no solver has otherwise.
TEST(InstrumentContactForceField, RefusesDampingFarBeyondItsStiffness) {
  const auto first_step = [](const std::string& damping) {
    scene::Scene scene = read_and_init(
        block("<InstrumentContactForceField name='probe' radius='.008' keyTimes='0' positions='0 0 1' damping='" +
              damping + "'/>"));
    scene.step();
  };
  first_step("2e7");
  for (const char* damping : {"1e9", "1e300"})
    EXPECT_TRUE(support::refuses<scene::SceneError>(
        [&] { first_step(damping); },
        {"damping: is 1e+", "must be at most 3e+07 Pa s/m in steps of 0.01 s", "contactStiffness"}));
}

// One that is not active has no stiffness that a body could be too soft for, until it is.
TEST(InstrumentContactForceField, AnInactiveOneMayBeTooStiff) {
  const auto changed = [](const std::string& changes) {
    return read_and_init(
        block("<InstrumentContactForceField name='probe' radius='.008' contactStiffness='1e8' keyTimes='0' "
              "positions='0 0 1'/>")
            .insert(
                std::string("<Node dt='.01' gravity='0 0 0'>").size(),
                "<AttributeChange component='@body' attribute='youngModulus' keyTimes='.02' values='5'/>" + changes));
  };
  scene::Scene scene =
      changed("<AttributeChange component='@probe' attribute='active' keyTimes='.02 .05' values='0; 1'/>");
  support::run(scene, 5);
  EXPECT_TRUE(support::refuses<scene::SceneError>(
      [&] { scene.step(); }, {"contactStiffness: is 1e+08, must be at most ",
                              "the greatest Young's modulus of the body that it touches was 5000 Pa when that was "
                              "accepted, and is 5 Pa now"}));
  // so also where another attribute changes with it
  scene::Scene other = changed("<AttributeChange component='@probe' attribute='friction' keyTimes='.02' values='.5'/>");
  support::run(other, 2);
  EXPECT_TRUE(support::refuses<scene::SceneError>([&] { other.step(); }, {"was 5000 Pa when that was accepted"}));
}

// A stiffness that was accepted is refused for a body that has become much softer: it says what has changed.
TEST(InstrumentContactForceField, SaysThatItsBodyHasBecomeTooSoft) {
  scene::Scene scene = read_and_init(
      block("<InstrumentContactForceField name='probe' radius='.008' contactStiffness='1e8' keyTimes='0' "
            "positions='0 0 1'/>")
          .insert(std::string("<Node dt='.01' gravity='0 0 0'>").size(),
                  "<AttributeChange component='@body' attribute='youngModulus' keyTimes='.02' values='5'/>"));
  support::run(scene, 2);
  EXPECT_TRUE(support::refuses<scene::SceneError>(
      [&] { scene.step(); }, {"InstrumentContactForceField.contactStiffness: is 1e+08, must be at most ",
                              "; the greatest Young's modulus of the body that it touches was 5000 Pa when that was "
                              "accepted, and is 5 Pa now"}));
}

// The default stiffness is that of the body as it is: with a body whose modulus changes in the first step everything is
// as with one that had that modulus, also where the contact stands before both the change and the body.
TEST(InstrumentContactForceField, TheDefaultStiffnessFollowsTheBody) {
  const auto text = [](const std::string& modulus, const std::string& change) {
    return support::in_root("gravity='0 0 0' dt='.01'",
                            "<RegularGridTopology n='7 7 4' max='.06 .06 .03'/><MechanicalObject name='nodes'/>"
                            "<UniformMass totalMass='.1'/><FixedProjectiveConstraint indices='0-48'/>" +
                                std::string(kPoke) + change +
                                "<HexahedronElastoplasticFEMForceField name='body' poissonRatio='.3' youngModulus='" +
                                modulus + "'/>");
  };
  scene::Scene given = read_and_init(text("50000", "")),
               changed = read_and_init(text("5000",
                                            "<AttributeChange component='@body' attribute='youngModulus' keyTimes='0' "
                                            "values='50000'/>"));
  support::run(given, 30);
  support::run(changed, 30);
  EXPECT_GT(force_on(given, "probe").z(), 0.5);
  EXPECT_EQ(force_on(changed, "probe"), force_on(given, "probe"));
  EXPECT_EQ(nodes(changed), nodes(given));
}

// So does a state that goes on from a checkpoint: after a change of the instrument before one of the body, and after
// hexahedra have torn away.
TEST(InstrumentContactForceField, ContinuesAfterChangesOfBoth) {
  const auto text = [](const std::string& change, const std::string& attributes, const std::string& depth) {
    return support::in_root(
        "gravity='0 0 -9.81' dt='.01'",
        "<AttributeChange component='@ball' attribute='friction' keyTimes='0.05' values='0.8'/>" + change +
            "<RegularGridTopology n='9 5 3' min='-.04 -.02 0' max='.04 .02 .02'/><MechanicalObject name='nodes'/>"
            "<DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='3000' "
            "yieldStress='100' plasticFlowRate='5' hardening='.3' " +
            attributes +
            "/><FixedProjectiveConstraint indices='0-44'/><InstrumentContactForceField name='ball' radius='.01' "
            "friction='.3' keyTimes='0 .25' positions='-.03 0 .028  -.01 0 " +
            depth +
            "'/><GraspForceField radius='.012' keyTimes='0 .2' positions='.03 0 .02  .04 0 .05' stiffness='300'/>");
  };
  const std::string modulus =
      "<AttributeChange component='@body' attribute='youngModulus' keyTimes='.1' values='9000'/>";
  const std::string radius = "<AttributeChange component='@ball' attribute='radius' keyTimes='.06' values='.004'/>";
  for (const std::string& one : {text(modulus, "", ".018"), text(radius, "", ".018"),  // which has other samples
                                 text("", "fractureStretch='1.05'", ".024")}) {
    scene::Scene straight = read_and_init(one), second = read_and_init(one);
    support::run(straight, 12);
    const bool has_torn = !at<scene::ForceField>(straight, "body").body()->removed().empty();
    EXPECT_EQ(has_torn, one.find("fracture") != std::string::npos);
    support::go_on_in(straight, second);
    support::run(straight, 14);
    support::run(second, 14);
    EXPECT_EQ(nodes(straight), nodes(second)) << one;
  }
}

TEST(InstrumentContactForceField, TakesASurface) {
  const auto force_of = [](const std::string& shape) {
    scene::Scene scene = read_and_init(block("<InstrumentContactForceField name='tool' " + shape +
                                             " keyTimes='0 .3' positions='.0312 .0288 .042  .0312 .0288 .036'/>"));
    support::run(scene, 40);
    return force_on(scene, "tool");
  };
  const Vec3
      box = force_of("shape='box' size='.02 .02 .02'"),
      surface = force_of(
          "shape='surface' surfacePositions='-.01 -.01 -.01  .01 -.01 -.01  .01 .01 -.01  -.01 .01 -.01  -.01 "
          "-.01 .01  .01 -.01 .01  .01 .01 .01  -.01 .01 .01' surfaceTriangles='0 2 1  0 3 2  4 5 6  4 6 7  0 1 5 "
          " 0 5 4  1 2 6  1 6 5  2 3 7  2 7 6  3 0 4  3 4 7'");
  EXPECT_GT(box.z(), 0.1);
  EXPECT_TRUE(support::agrees(surface, box, 1e-9));
}

// An option that follows one without a value has none either: its default holds.
TEST(InstrumentContactForceField, TakesTheOptionsOfAnotherOne) {
  EXPECT_EQ(errors_of(block("<InstrumentContactForceField name='a' shape='box' size='1 1 1' friction='.3' keyTimes='0' "
                            "positions='0 0 1'/><InstrumentContactForceField name='b' src='@a'/>"
                            "<InstrumentContactForceField name='c' radius='.1' keyTimes='0' positions='0 0 1' "
                            "contactStiffness='@a.contactStiffness' tangentialStiffness='@a.friction'/>")),
            "");
}

TEST(InstrumentContactForceField, SaysWhatIsWrong) {
  const auto errors = [](const std::string& attributes) {
    return errors_of(block("<InstrumentContactForceField keyTimes='0' positions='0 0 1' " + attributes + "/>"));
  };
  const std::string prefix = "test.scn:1: error: InstrumentContactForceField",
                    too_stiff =
                        ": is 1e+14, must be at most 3e+09 Pa/m, 200 times the default of contactStiffness, 30 E / "
                        "edge length";
  const std::string triangle = "shape='surface' surfacePositions='0 0 0  1 0 0  0 1 0' surfaceTriangles=";
  for (const auto& [attributes, message] : std::vector<std::pair<std::string, std::string>>{
           {"", "radius: is not given: a sphere has one"},
           {"radius='0'", "radius: 0 must be > 0"},
           {"radius='1' friction='-.1'", "friction: -0.1 must be >= 0"},
           {"shape='box'", "size: is not given: a box has one"},
           {"shape='capsule' radius='1'", "length: is not given: a capsule has one"},
           {"radius='1' orientations='0 0 0'",
            "orientations: 3 numbers given, must be a quaternion (4) for each of 1 key times"},
           {"radius='1' orientations='0 0 0 0'", "orientations: quaternion 0 is 0 0 0 0, must have a length"},
           {triangle + "'0 1 2'", "surfaceTriangles: closed surface: is open at edge 0 1 of triangle 0"},
           {triangle + "'0 1 9'", "surfaceTriangles: 9 must lie in [0, 3)"},
           {"radius='1' embeddedPositions='0 0 0'",
            "embeddedPositions: given without embeddedTriangles, which make a surface of them"},
           {"radius='1' contactDistance='.006'",
            "contactDistance: is 0.006, must be at most 0.005 m, half of the mean edge"},
           {"radius='1' contactStiffness='1e14'", "contactStiffness" + too_stiff},
           {"radius='1' tangentialStiffness='1e14'", "tangentialStiffness" + too_stiff}})
    EXPECT_EQ(errors(attributes), prefix + "." + message);
  EXPECT_EQ(errors_of(block("<InstrumentContactForceField radius='1' keyTimes='0' positions='0 0 1'/>",
                            "<SparseLDLSolver/>", "<EulerImplicitSolver trapezoidalScheme='true'/>")),
            prefix + ": its EulerImplicitSolver has trapezoidalScheme: contact needs implicit Euler");
  EXPECT_NE(errors("shape='ball' radius='1'").find("'ball'"), std::string::npos);
  EXPECT_EQ(errors_of("<Node><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/><MechanicalObject "
                      "position='0 0 0'/><UniformMass totalMass='1'/><InstrumentContactForceField radius='1' "
                      "keyTimes='0' positions='0 0 0'/></Node>"),
            prefix + ": no body on its state: contact is that of a body's surface");

  scene::Scene thin = read_and_init(
      block("<InstrumentContactForceField radius='1e-4' keyTimes='0' positions='0 0 1' maxSubdivision='4'/>"));
  EXPECT_NE(support::warnings_of(thin).find("slips between them"), std::string::npos);

  // a ball that begins within the block, at its surface and in its middle
  const auto begins_at = [](const std::string& place) {
    scene::Scene scene =
        read_and_init(block("<InstrumentContactForceField radius='.008' keyTimes='0' positions='" + place + "'/>"));
    return support::warnings_of(scene);
  };
  EXPECT_NE(begins_at(".03 .03 .032").find("positions: it begins 0.006 m deep in the body"), std::string::npos);
  EXPECT_NE(begins_at(".03 .03 .015").find("reaches no point of its surface"), std::string::npos);
  EXPECT_EQ(begins_at(".03 .03 .038"), "");
  EXPECT_EQ(begins_at(".03 .03 .0379"), "") << "it touches";
  // in the gap between a surface and its cage
  const std::string surface =
      "' embeddedPositions='.01 .01 .01  .02 .01 .01  .01 .02 .01  .01 .01 .02' "
      "embeddedTriangles='0 2 1  0 1 3  0 3 2  1 2 3";
  EXPECT_EQ(begins_at(".04 .04 .03" + surface), "");
}

}  // namespace
