// SPDX-License-Identifier: LGPL-2.1-or-later
// What instruments that touch are held to (docs/reliability.md), and their attributes. HEXAPLAST_POKES says how many
// random pokes there are.
#include <fmt/format.h>

#include <cstdlib>
#include <iostream>

#include "base/memory.hpp"
#include "hexaplast/body.hpp"
#include "scene/visuals.hpp"
#include "support/mesh_text.hpp"
#include "support/random.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

Vec3 force_on(scene::Scene& scene, const std::string& instrument) {
  return at<scene::Component>(scene, instrument).vector3("force");
}
double depth_of(scene::Scene& scene, const std::string& instrument) {
  return at<scene::Component>(scene, instrument).reals("depth")[0];
}

/// A block of 6 x 6 x 3 cells of 1 cm, or of as many more as `finer` says, held at its bottom.
std::string block(const std::string& rest, int finer = 1, double dt = 0.01) {
  const int n = 6 * finer + 1;
  return fmt::format(
      "<Node dt='{}' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='.5'/>"
      "<MultigridCGLinearSolver tolerance='1e-6'/><RegularGridTopology n='{} {} {}' max='.06 .06 .03'/>"
      "<MechanicalObject name='nodes'/><UniformMass totalMass='.1'/><BoxROI name='bottom' box='-1 -1 -1  1 1 .001'/>"
      "<FixedProjectiveConstraint indices='@bottom.indices'/>"
      "<HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' poissonRatio='.3'/>{}</Node>",
      dt, n, n, 3 * finer + 1, rest);
}

// A side load shears the block; a flat plate without friction presses on it.
TEST(InstrumentChecks, APlateFeelsNoShear) {
  std::string top;
  for (int n = 3 * 49; n < 4 * 49; ++n) top += std::to_string(n) + " ";
  scene::Scene scene =
      read_and_init(block("<ConstantForceField indices='" + top +
                          "' totalForce='4 0 0'/>"
                          "<InstrumentContactForceField name='plate' shape='box' size='.2 .2 .02' keyTimes='1 1.5' "
                          "positions='.03 .03 .05  .03 .03 .038'/>"));
  run(scene, 300);
  const PointArray& x = nodes(scene);
  EXPECT_GT(x.bottomRows(49).col(0).mean() - 0.03, 0.5 * 0.028) << "sheared by a half";
  const Vec3 force = force_on(scene, "plate");
  EXPECT_GT(force.z(), 0.1);
  EXPECT_LT(force.head<2>().norm(), 1e-12 * force.z());
}

// A block on a slope: below the angle of friction it stays, above it slides as a rigid one does.
std::string block_on_slope(double degrees, double friction) {
  const double a = degrees * std::numbers::pi / 180;
  // gravity turns, the plate lies
  return fmt::format(
      "<Node dt='.005' gravity='{} 0 {}'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
      "<RegularGridTopology n='5 5 3' min='0 0 0' max='.04 .04 .02'/><MechanicalObject name='nodes'/>"
      "<UniformMass totalMass='.032'/><HexahedronElastoplasticFEMForceField youngModulus='20000' poissonRatio='.3'/>"
      "<InstrumentContactForceField name='plate' shape='box' size='100 100 1' friction='{}' keyTimes='0' positions='0 "
      "0 -.5'/></Node>",
      9.81 * std::sin(a), -9.81 * std::cos(a), friction);
}

TEST(InstrumentChecks, ABlockOnASlopeSticksOrSlides) {
  const auto centre = [](scene::Scene& scene) { return nodes(scene).col(0).mean(); };
  {
    scene::Scene scene = read_and_init(block_on_slope(20, 0.4));  // tan 20 deg = .364
    run(scene, 400);                                              // it comes to rest
    const double rest = centre(scene);
    run(scene, 2000);
    EXPECT_LT(std::abs(centre(scene) - rest), 1e-6 * 0.04) << "in 10 s";
  }
  for (const double friction : {0.0, 0.1, 0.3}) {
    scene::Scene scene = read_and_init(block_on_slope(20, friction));
    run(scene, 200);
    const auto speed = [&] { return at<scene::MechanicalState>(scene, "nodes").velocities().col(0).mean(); };
    const double before = speed();
    run(scene, 100);
    const double angle = 20 * std::numbers::pi / 180,
                 expected = 9.81 * (std::sin(angle) - friction * std::cos(angle)) * 0.5;
    EXPECT_NEAR(speed() - before, expected, 0.02 * expected) << friction;
  }
}

TEST(InstrumentChecks, JawsHoldByFriction) {
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
    run(scene, 240);
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

/// Force on a ball that presses 4 mm and strokes 5 mm, every .05 s.
std::vector<Vec3> stroke(int finer, double dt) {
  scene::Scene scene =
      read_and_init(block("<InstrumentContactForceField name='ball' radius='.03' friction='.3' keyTimes='.1 .4 .9' "
                          "positions='.0275 .03 .061  .0275 .03 .056  .0325 .03 .056'/>",
                          finer, dt));
  std::vector<Vec3> forces;
  const int between = static_cast<int>(std::lround(0.05 / dt));
  for (int k = 0; k < 20; ++k) {
    run(scene, between);
    forces.push_back(force_on(scene, "ball"));
  }
  return forces;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double difference = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    difference = std::max(difference, (a[k] - b[k]).norm());
    largest = std::max(largest, b[k].norm());
  }
  return difference / largest;
}

TEST(InstrumentChecks, ForcesConverge) {
  const std::vector<Vec3> forces = stroke(2, 0.01);
  EXPECT_GT(forces.back().z(), 0.1);
  const double by_step = largest_difference(forces, stroke(2, 0.005)),
               by_mesh = largest_difference(forces, stroke(4, 0.01));
  std::cout << fmt::format("step halved: {:.4f}, mesh refined: {:.4f} of the largest force\n", by_step, by_mesh);
  EXPECT_LT(by_step, 0.02);
  EXPECT_LT(by_mesh, 0.05);
}

// A needle of a quarter of a cell that comes down between nodes, by 2 mm. With the default stiffness the tissue slips
// around its tip: what presses is smaller than the cells that the stiffness is made for.
TEST(InstrumentChecks, ANeedleDoesNotPassBetweenNodes) {
  for (const auto& [x, y] : {std::pair{0.0312, 0.0287}, {0.0344, 0.0265}, {0.0251, 0.0349}, {0.0275, 0.0325}}) {
    scene::Scene scene = read_and_init(block(fmt::format(
        "<InstrumentContactForceField name='needle' shape='capsule' radius='.00125' length='.03' maxSubdivision='16' "
        "contactStiffness='2.4e8' keyTimes='0 .2' positions='{0} {1} .047  {0} {1} .04425'/>",
        x, y)));
    double last = 0;
    for (int k = 0; k < 40; ++k) {
      scene.step();
      last = force_on(scene, "needle").z();
    }
    EXPECT_GT(last, 0.03) << x << " " << y;
  }
}

TEST(InstrumentChecks, BallsArePushedOutOfCornersEdgesAndFaces) {
  const double r = 0.006;
  for (const Vec3& place : {Vec3(0.06, 0.06, 0.03), Vec3(0.06, 0.031, 0.03), Vec3(0.033, 0.031, 0.03)}) {
    const Vec3 outwards = Vec3(place.x() == 0.06, place.y() == 0.06, 1).normalized(), from = place + 10 * r * outwards,
               to = place + 0.8 * r * outwards;
    scene::Scene scene = read_and_init(
        block(fmt::format("<InstrumentContactForceField name='ball' radius='{}' keyTimes='0 .046' positions='{}'/>", r,
                          numbers(rows({from, to})))));
    run(scene, 60);
    EXPECT_GT(force_on(scene, "ball").dot(outwards), 1e-3) << outwards.transpose();
    EXPECT_LT(depth_of(scene, "ball"), 0.1 * 0.01) << outwards.transpose();
  }
}

TEST(InstrumentChecks, BodiesRecoverFromRandomPokes) {
  const char* given = std::getenv("HEXAPLAST_POKES");
  const int num_pokes = given ? std::atoi(given) : 25;
  Random random(11);
  double worst = 0;
  int touched = 0;
  for (int k = 0; k < num_pokes; ++k) {
    const char* shapes[] = {"sphere", "capsule", "cylinder", "box"};
    const double radius = random.uniform(0.002, 0.012);
    const std::string shape = fmt::format(
        "shape='{}' radius='{}' length='{}' size='{} {} {}'", shapes[static_cast<int>(random.uniform(0, 4))], radius,
        random.uniform(0.005, 0.04), 2 * radius, random.uniform(0.005, 0.04), random.uniform(0.005, 0.04));
    // towards a place within the upper third or just above it, at up to five radii in a step
    const Vec3 to(random.uniform(0, 0.06), random.uniform(0, 0.06), random.uniform(0.02, 0.035));
    Vec3 direction = random.direction();
    direction.z() = std::abs(direction.z());
    const Vec3 from = to + 0.1 * direction, away = from + Vec3(0, 0, 0.1);
    const double speed = random.uniform(0.1, 5) * radius / 0.01, way = 0.1 / speed, stay = random.uniform(0, 0.2);
    const Eigen::Quaterniond turned(random.rotation());
    const std::string quaternion = fmt::format(" {} {} {} {} ", turned.x(), turned.y(), turned.z(), turned.w());
    const std::string text = block(fmt::format(
        "<InstrumentContactForceField name='tool' {} friction='{}' maxSubdivision='12' keyTimes='0 {} {} {} {}' "
        "positions='{}' orientations='{}'/>",
        shape, random.uniform(0, 1), way, way + stay + 0.01, 2 * way + stay + 0.01, 2 * way + stay + 0.02,
        numbers(rows({from, to, to, from, away})), repeated(quaternion, 5)));
    scene::Scene scene = read_and_init(text);
    const PointArray before = nodes(scene);
    bool touches = false;
    const int poke = static_cast<int>(std::ceil((2 * way + stay) / 0.01)) + 3;
    for (int step = 0; step < poke; ++step) {
      scene.step();
      ASSERT_TRUE(nodes(scene).allFinite()) << k << " " << text;
      touches = touches || force_on(scene, "tool").norm() > 0;
    }
    touched += touches;
    run(scene, 250);
    const double off = (nodes(scene) - before).rowwise().norm().maxCoeff();
    EXPECT_LT(off, 1e-4 * 0.06) << k << " " << text;
    worst = std::max(worst, off);
  }
  std::cout << fmt::format("{} of {} pokes touched; at the end at most {:.3g} of the length off\n", touched, num_pokes,
                           worst / 0.06);
  EXPECT_GT(touched, num_pokes / 2);
}

TEST(InstrumentChecks, ToolsOfShippedScenesDoNotSinkIn) {
  const auto deepest = [](const std::string& name, int steps, const std::vector<std::string>& tools) {
    scene::Scene scene = shipped(name);
    const Body* body = nullptr;
    for (const scene::ForceField* field : scene.root().all<scene::ForceField>())
      if (field->body()) body = field->body();
    const double cell = std::cbrt(body->initial_volume() / body->mesh().num_elements());
    double depth = 0;
    for (int k = 0; k < steps; ++k) {
      scene.step();
      for (const std::string& tool : tools) depth = std::max(depth, depth_of(scene, tool));
    }
    std::cout << fmt::format("{}: {:.3f} % of a cell\n", name, 100 * depth / cell);
    return depth / cell;
  };
  // tools that are smaller than a cell press with more than the .3 E that the default stiffness is made for
  EXPECT_LT(deepest("probe_liver", 240, {"liver/probe"}), 0.2);
  EXPECT_LT(deepest("forceps_fat", 200, {"strip/left", "strip/right"}), 0.12);
  EXPECT_LT(deepest("slope", 340, {"block/plate"}), 0.01);
}

// A cube of 2 cm, 3 mm deep in a block of cells of 5 mm, is moved along its surface without friction. Where its edges
// are sharp, points that they run over jump from its bottom to its sides. contactDistance rounds edges by as much.
TEST(InstrumentChecks, AContactDistanceRoundsEdges) {
  struct Stroke {
    double greatest_jump = 0, drag = 0;  // between two steps, and on average: in parts of the mean normal force
  };
  const auto stroke = [](double rounding) {
    const double size = 0.02 - 2 * rounding, down = 0.03 - 0.003 + 0.01;
    scene::Scene scene = read_and_init(fmt::format(
        "<Node dt='.005' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighStiffness='.01'/>"
        "<MultigridCGLinearSolver tolerance='1e-4'/><RegularGridTopology n='17 9 7' max='.08 .04 .03'/>"
        "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
        "<BoxROI name='bottom' box='-1 -1 -1  1 1 .001'/><FixedProjectiveConstraint indices='@bottom.indices'/>"
        "<HexahedronElastoplasticFEMForceField youngModulus='5000' poissonRatio='.4'/>"
        "<InstrumentContactForceField name='tool' shape='box' size='{0} {0} {0}' contactDistance='{1}' "
        "keyTimes='0 .3 2' positions='.025 .02 {2}  .025 .02 {3}  .055 .02 {3}'/></Node>",
        size, rounding, down + 0.005, down));
    run(scene, 70);
    Stroke found;
    Vec3 before = force_on(scene, "tool"), sum = Vec3::Zero();
    double jump = 0;
    constexpr int kSteps = 200;
    for (int k = 0; k < kSteps; ++k) {
      scene.step();
      const Vec3 force = force_on(scene, "tool");
      jump = std::max(jump, (force - before).norm());
      sum += force;
      before = force;
    }
    found.greatest_jump = jump * kSteps / sum.z();
    found.drag = -sum.x() / sum.z();
    return found;
  };
  const Stroke sharp = stroke(0), rounded = stroke(0.002);
  std::cout << fmt::format("sharp: jumps of {:.3f}, drag {:.3f}; rounded by 2 mm: {:.3f}, {:.3f} of the normal force\n",
                           sharp.greatest_jump, sharp.drag, rounded.greatest_jump, rounded.drag);
  EXPECT_LT(rounded.greatest_jump, 0.1);
  EXPECT_LT(rounded.drag, 0.1);
  EXPECT_GT(sharp.greatest_jump, 3 * rounded.greatest_jump);
}

// What files and pictures show is the shape that touches: closed, seen from outside, with its volume, where it is.
TEST(InstrumentChecks, ShapesAreThoseThatTouch) {
  constexpr double pi = std::numbers::pi;
  for (const auto& [shape, volume] : {std::pair<std::string, double>{"sphere", 4 * pi / 3 * 8},
                                      {"capsule", 4 * pi / 3 * 8 + pi * 4 * 5},
                                      {"cylinder", pi * 4 * 5},
                                      {"box", 24}}) {
    scene::Scene scene =
        read_and_init(block("<InstrumentContactForceField name='tool' shape='" + shape +
                            "' radius='2' length='5' size='2 3 4' keyTimes='0 1' positions='0 0 9  4 0 9' "
                            "orientations='0 0 0 1  .5 .5 .5 .5'/>"));
    const auto& tool = dynamic_cast<scene::Instrument&>(at<scene::Component>(scene, "tool"));
    const PointArray points = tool.shape_points(1);
    double sum = 0;
    for (const auto& [a, b, c] : tool.shape_triangles())
      sum += Vec3(points.row(a)).dot(Vec3(points.row(b)).cross(Vec3(points.row(c)))) / 6;
    EXPECT_NEAR(sum, volume, 0.02 * volume) << shape;
    const Vec3 size = points.colwise().maxCoeff() - points.colwise().minCoeff(),
               middle = (points.colwise().maxCoeff() + points.colwise().minCoeff()) / 2;
    EXPECT_LT((middle - Vec3(4, 0, 9)).norm(), 1e-9) << shape;
    // a third of a turn: z becomes x, x becomes y, y becomes z
    if (shape == "box") {
      EXPECT_LT((size - Vec3(4, 2, 3)).norm(), 1e-9);
    }
  }
}

// A ball that presses, strokes and leaves: what it did went into the springs of contact, into friction, or into the
// body.
TEST(InstrumentChecks, TheEnergyOfContactCloses) {
  scene::Scene scene = read_and_init(
      block("<InstrumentContactForceField name='ball' radius='.015' friction='.3' keyTimes='.1 .4 .9 1.2' "
            "positions='.0225 .03 .046  .0225 .03 .040  .0375 .03 .040  .0375 .03 .046'/>",
            1, 0.005));
  scene::OdeSolver& integrator = *scene.root().all<scene::OdeSolver>().front();
  integrator.keep_energy_balance();
  const auto& ball = dynamic_cast<scene::Instrument&>(at<scene::Component>(scene, "ball"));
  for (int part = 0; part < 4; ++part) {
    for (int k = 0; k < 70; ++k) {
      scene.step();
      EXPECT_GE(force_on(scene, "ball").z(), 0) << "it presses, and never pulls";
    }
    const scene::ContactEnergy energy = *ball.contact_energy();
    const EnergyBalance& balance = *integrator.energy_balance();
    const double unexplained = energy.work - energy.stored - energy.friction_loss - balance.load_work;
    std::cout << fmt::format(
        "work {:.4g} J: contact {:.4g}, friction {:.4g}, body {:.4g} (elastic {:.4g}); {:.2g} % "
        "unexplained, balance of the body {:.2g} %\n",
        energy.work, energy.stored, energy.friction_loss, balance.load_work, balance.elastic,
        100 * unexplained / energy.work, 100 * balance.error() / energy.work);
    EXPECT_LT(std::abs(unexplained), 0.02 * energy.work);
    EXPECT_LT(std::abs(balance.error()), 0.02 * energy.work);
    EXPECT_GE(energy.stored, 0);
  }
  EXPECT_GT(ball.contact_energy()->friction_loss, 0.2 * ball.contact_energy()->work);
  EXPECT_EQ(ball.contact_energy()->stored, 0);
  EXPECT_EQ(force_on(scene, "ball"), Vec3(0, 0, 0));
}

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

// A needle with millions of samples far away: they are counted, each alone would fit, and are made when it comes near.
TEST(InstrumentContactForceField, MemoryIsCheckedForTheSumOfItsParts) {
  const std::string needle =
      "<InstrumentContactForceField radius='.0005' maxSubdivision='64' keyTimes='0' positions='0 0 5'/>";
  constexpr double kTwoThirdsMore = 150e6;  // [byte] one takes 104
  const GrantedMemory others = grant_memory("others", static_cast<double>(available_memory()) - kTwoThirdsMore);
  EXPECT_EQ(errors_of(block(needle)), "");
  const std::string errors = errors_of(block(needle + needle));
  EXPECT_TRUE(has(errors, "maxSubdivision: contact at points of 144 faces, edges in 40 parts, needs about 0.104 GB"));
}

// An option that follows one without a value has none either: its default holds.
TEST(InstrumentContactForceField, TakesTheOptionsOfAnotherOne) {
  EXPECT_EQ(errors_of(block("<InstrumentContactForceField name='a' shape='box' size='1 1 1' friction='.3' keyTimes='0' "
                            "positions='0 0 1'/><InstrumentContactForceField name='b' src='@a'/>"
                            "<InstrumentContactForceField name='c' radius='.1' keyTimes='0' positions='0 0 1' "
                            "contactStiffness='@a.contactStiffness' tangentialStiffness='@a.friction'/>")),
            "");
}

// What all contact refuses is ContactFields.RefuseWhatCannotBe, and what lies out of a range ExampleScenes.
TEST(InstrumentContactForceField, SaysWhatIsWrong) {
  const auto instrument = [](const std::string& attributes) {
    return block("<InstrumentContactForceField keyTimes='0' positions='0 0 1' " + attributes + "/>");
  };
  const std::string triangle = "shape='surface' surfacePositions='0 0 0  1 0 0  0 1 0' surfaceTriangles=";
  expect_errors(
      instrument,
      {{"", "InstrumentContactForceField.radius: is not given: a sphere has one"},
       {"shape='box'", "InstrumentContactForceField.size: is not given: a box has one"},
       {"shape='capsule' radius='1'", "InstrumentContactForceField.length: is not given: a capsule has one"},
       {"radius='1' orientations='0 0 0'",
        "InstrumentContactForceField.orientations: 3 numbers given, must be a quaternion (4) for each of 1 key times"},
       {"radius='1' orientations='0 0 0 0'",
        "InstrumentContactForceField.orientations: quaternion 0 is 0 0 0 0, must have a length"},
       {triangle + "'0 1 2'",
        "InstrumentContactForceField.surfaceTriangles: closed surface: is open at edge 0 1 of triangle 0"},
       {triangle + "'0 1 9'", "InstrumentContactForceField.surfaceTriangles: 9 must lie in [0, 3)"},
       {"radius='1' embeddedPositions='0 0 0'",
        "InstrumentContactForceField.embeddedPositions: given without embeddedTriangles, which make a surface of "
        "them"}});
  expect_errors(four_nodes,
                {{"<InstrumentContactForceField radius='1' keyTimes='0' positions='0 0 0'/>",
                  "InstrumentContactForceField: no body on its state: contact is that of a body's surface"}});
}

TEST(InstrumentContactForceField, WarnsOfWhatIsHardlyMeant) {
  const auto warnings_along = [](const std::string& path) {
    scene::Scene scene = read_and_init(block("<InstrumentContactForceField " + path + "'/>"));
    return warnings_of(scene);
  };
  const auto warnings = [&](const std::string& attributes) { return warnings_along("keyTimes='0' " + attributes); };
  EXPECT_TRUE(has(warnings("radius='1e-4' maxSubdivision='4' positions='0 0 1"), "slips between them"));
  const std::string ball = "radius='.008' positions='.03 .03 ";
  EXPECT_TRUE(has(warnings(ball + ".032"), "positions: it begins 0.006 m deep in the body"));
  EXPECT_TRUE(has(warnings(ball + ".015"), "reaches no point of its surface")) << "in its middle";
  EXPECT_EQ(warnings(ball + ".038"), "");
  EXPECT_EQ(warnings(ball + ".0379"), "") << "it touches";
  EXPECT_EQ(warnings("embeddedPositions='.01 .01 .01  .02 .01 .01  .01 .02 .01  .01 .01 .02' embeddedTriangles='0 2 1  "
                     "0 1 3  0 3 2  1 2 3' radius='.008' positions='.025 .025 .026"),
            "")
      << "in the gap between a surface and its cage";
  const std::string from_above = "radius='.008' keyTimes='0 1' positions='.03 .03 .1  .03 .03 ";
  EXPECT_EQ(warnings_along(from_above + ".038"), "");
  EXPECT_TRUE(
      has(warnings("embeddedPositions='.01 .01 .01  .02 .01 .01  .01 .02 .01  .01 .01 .02' embeddedTriangles='0 2 1  "
                   "0 1 3  0 3 2  1 2 3' radius='.008' positions='.04 .04 .03"),
          "positions: the path never comes near the body"))
      << "within the cage, and away from the surface";
  EXPECT_TRUE(has(warnings_along(from_above + ".05"), "positions: the path never comes near the body"));

  // pressed deeper than half of its thickness: once
  scene::Scene plate = read_and_init(
      block("<InstrumentContactForceField shape='box' size='.1 .1 .001' contactStiffness='1e6' maxSubdivision='4' "
            "keyTimes='0 .35' positions='.031 .029 .0305  .031 .029 .0255'/>"));
  warnings_of(plate);
  run(plate, 50);
  const std::string said = warnings_of(plate);
  EXPECT_TRUE(has(said, "contactStiffness: "));
  EXPECT_EQ(said.find("contactStiffness: "), said.rfind("contactStiffness: ")) << said;
}

}  // namespace
