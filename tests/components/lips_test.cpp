// SPDX-License-Identifier: LGPL-2.1-or-later
// Bodies that touch themselves and are cut: the lips of the cut touch each other, and begin to without force.
#include <fmt/format.h>

#include <numbers>
#include <optional>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "support/mesh_text.hpp"
#include "support/random.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

constexpr double kCell = 0.01;
const std::string kTouch = "<TissueContactForceField name='touch' contactDistance='0.003' friction='0.3'/>";

/// Of hexahedra of 1 cm, whose nodes lie off those of a grid by up to `warp` [m].
std::string block_of(std::array<int, 3> cells, const std::string& more, double warp = 0,
                     const std::string& material = "") {
  const Vec3 max(cells[0] * kCell, cells[1] * kCell, cells[2] * kCell);
  const HexMesh grid = regular_grid(cells, Vec3::Zero(), max);
  const PointArray off = warp > 0 ? Random(3).field(grid.num_nodes(), warp) : PointArray::Zero(grid.num_nodes(), 3);
  return "<Node dt='0.005' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' "
         "rayleighStiffness='0.005'/><SparseLDLSolver/>" +
         mesh_topology(HexMesh(grid.positions() + off, grid.hexahedra())) +
         "<MechanicalObject name='nodes'/><DiagonalMass name='mass' massDensity='1000'/>"
         "<HexahedronElastoplasticFEMForceField name='flesh' youngModulus='5000' poissonRatio='0.3' " +
         material + "/>" + more + "</Node>";
}

const Body& lips_body(scene::Scene& scene) { return body(scene, "flesh"); }
scene::ForceField& flesh(scene::Scene& scene) { return at<scene::ForceField>(scene, "flesh"); }
double reading(scene::Scene& scene, const char* output) {
  return at<scene::Component>(scene, "touch").reals(output)[0];
}

/// Joints across a plane of the grid, as far as along[axis] < end.
std::vector<int> joints_across(const Body& body, int axis, double where, int along = 0, double end = 1) {
  const HexMesh& mesh = body.initial_mesh();
  std::vector<int> joints;
  for (int joint = 0; joint < body.joints().count(); ++joint) {
    Vec3 middle = Vec3::Zero();
    double off = 0;
    for (const int n : body.joints().nodes(joint)) {
      middle += mesh.positions().row(n).transpose() / 4;
      off = std::max(off, std::abs(mesh.positions()(n, axis) - where));
    }
    if (off < 0.3 * kCell && middle[along] < end) joints.push_back(joint);
  }
  return joints;
}

std::vector<int> random_joints(const Body& body, double fraction, unsigned seed) {
  Random random(seed);
  std::vector<int> joints;
  for (int joint = 0; joint < body.joints().count(); ++joint)
    if (random.uniform(0, 1) < fraction) joints.push_back(joint);
  return joints;
}

struct CutAtRest {
  const char* name;
  double warp;
  std::vector<int> (*joints)(const Body&);
};
void PrintTo(const CutAtRest& cut, std::ostream* out) { *out << cut.name; }

class LipsAtRest : public testing::TestWithParam<CutAtRest> {};

// Contact begins at 0.3 of an edge, and lips lie on one another: they begin at what there is between them.
TEST_P(LipsAtRest, FeelNoForce) {
  scene::Scene scene = read_and_init(block_of({4, 3, 3}, kTouch, GetParam().warp));
  run(scene, 2);
  scene.open(flesh(scene), GetParam().joints(lips_body(scene)));
  ASSERT_TRUE(lips_body(scene).copies().is_split());
  run(scene, 1);
  EXPECT_GT(reading(scene, "touching"), 0);
  run(scene, 30);
  const PointArray way = nodes(scene) - lips_body(scene).mesh().positions();
  EXPECT_LE(way.rowwise().norm().maxCoeff(), 1e-15);
}

INSTANTIATE_TEST_SUITE_P(
    Cuts, LipsAtRest,
    testing::Values(CutAtRest{"through", 0, [](const Body& body) { return joints_across(body, 0, 0.02); }},
                    CutAtRest{"half", 0, [](const Body& body) { return joints_across(body, 0, 0.02, 1, 0.02); }},
                    CutAtRest{"curved", 1e-3, [](const Body& body) { return joints_across(body, 0, 0.02); }},
                    CutAtRest{"ragged", 1e-3, [](const Body& body) { return random_joints(body, 0.6, 1); }},
                    CutAtRest{"all", 0, [](const Body& body) { return random_joints(body, 1, 1); }}),
    [](const auto& test) { return std::string(test.param.name); });

/// A bar that is held at its left end; the right one moves along x.
std::string led(const std::string& times, const std::string& ways) {
  return "<BoxROI name='left' box='-0.001 -1 -1 0.001 1 1'/><BoxROI name='right' box='0.079 -1 -1 0.081 1 1'/>"
         "<FixedProjectiveConstraint indices='@left.indices'/><LinearMovementProjectiveConstraint "
         "indices='@right.indices' keyTimes='" +
         times + "' movements='" + ways + "'/>";
}

TEST(Lips, CloseWithoutGainOfEnergy) {
  scene::Scene scene =
      read_and_init(block_of({8, 4, 4}, kTouch + led("0 0.1 0.5 1 2", "0 0 0  0 0 0  .004 0 0  -.001 0 0  -.001 0 0")));
  at<scene::OdeSolver>(scene, "euler").keep_energy_balance();
  scene.open(flesh(scene), joints_across(lips_body(scene), 0, 0.04));
  double work = 0, error = 0, before = 0;
  for (int step = 0; step < 300; ++step) {
    run(scene, 1);
    const EnergyBalance& balance = *at<scene::OdeSolver>(scene, "euler").energy_balance();
    work += std::abs(balance.support_work - before);
    before = balance.support_work;
    error = std::max(error, std::abs(balance.error()));
  }
  EXPECT_GT(work, 1e-5);
  EXPECT_GT(reading(scene, "touching"), 50);
  EXPECT_LT(error, 1e-3 * work);
}

// The halves of a bar that is pressed, cut and alone.
TEST(Lips, PressAsTwoBodiesDo) {
  const std::string
      motion = "' keyTimes='0 0.2 1' movements='0 0 0  -.004 0 0  -.004 0 0'/>",
      fixed = "<FixedProjectiveConstraint indices='@left.indices'/>",
      rois = "<BoxROI name='left' box='-0.001 -1 -1 0.001 1 1'/><BoxROI name='right' box='0.079 -1 -1 0.081 1 1'/>",
      moved = "<LinearMovementProjectiveConstraint indices='@right.indices" + motion;
  const auto half = [&](const std::string& name, const std::string& x, const std::string& more) {
    return "<Node name='" + name + "'><RegularGridTopology n='5 5 5' min='" + x +
           " 0.04 0.04'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
           "<HexahedronElastoplasticFEMForceField name='flesh' youngModulus='5000' poissonRatio='0.3'/>" +
           more + "</Node>";
  };
  const std::string frame =
      "<Node dt='0.005' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighStiffness='0.005'/>"
      "<SparseLDLSolver/>";
  scene::Scene two =
      read_and_init(frame + "<TissueContactForceField friction='0.3' object1='@first/nodes' object2='@second/nodes'/>" +
                    half("first", "0 0 0' max='0.04", rois + fixed) +
                    half("second", "0.04 0 0' max='0.08", rois + moved) + "</Node>");
  scene::Scene cut = read_and_init(
      block_of({8, 4, 4}, rois + fixed + moved + "<TissueContactForceField name='touch' friction='0.3'/>"));
  cut.open(flesh(cut), joints_across(lips_body(cut), 0, 0.04));
  const HexMesh& mesh = lips_body(cut).mesh();
  double largest = 0;
  for (int step = 0; step < 60; ++step) {
    run(cut, 1);
    run(two, 1);
    for (int e = 0; e < mesh.num_elements(); ++e) {
      const int i = e % 8, row = e / 8;
      const std::string half_of = i < 4 ? "first" : "second";
      const PointArray& alone = at<scene::MechanicalState>(two, half_of + "/nodes").positions();
      const HexMesh& other = at<scene::ForceField>(two, half_of + "/flesh").body()->mesh();
      const Hexahedron& there = other.hexahedra()[4 * row + i % 4];
      for (int a = 0; a < kCorners; ++a)
        largest = std::max(largest, (nodes(cut).row(mesh.hexahedra()[e][a]) - alone.row(there[a])).norm());
    }
  }
  EXPECT_GT(reading(cut, "touching"), 40);
  EXPECT_LT(largest, 1e-10);
}

/// A block that is thrown together, and cut in some steps; hexahedra go in some.
struct Crumbling {
  scene::Scene scene;
  Random random;
  std::vector<int> closed = {};

  Crumbling(std::array<int, 3> cells, unsigned seed)
      : scene(read_and_init(block_of(cells, kTouch, 1e-3, "yieldStress='200' plasticFlowRate='5'"))), random(seed) {
    auto& state = at<scene::MechanicalState>(scene, "nodes");
    PointArray& v = state.velocities();
    const Vec3 middle = kCell / 2 * Vec3(cells[0], cells[1], cells[2]);
    v = random.field(static_cast<int>(v.rows()), 0.05) - 4 * (state.positions().rowwise() - middle.transpose());
    for (int joint = 0; joint < lips_body(scene).joints().count(); ++joint) closed.push_back(joint);
  }

  int some(std::size_t count) {
    return std::min(static_cast<int>(random.uniform(0, 1) * static_cast<double>(count)), static_cast<int>(count) - 1);
  }
  void step(int num_joints, double removals = 0.1) {
    std::vector<int> joints;
    for (int k = 0; k < num_joints && !closed.empty(); ++k) {
      const int at = some(closed.size());
      joints.push_back(closed[at]);
      closed.erase(closed.begin() + at);
    }
    if (!joints.empty()) scene.open(flesh(scene), joints);
    if (random.uniform(0, 1) < removals)
      flesh(scene).remove_elements(std::array{some(static_cast<std::size_t>(lips_body(scene).mesh().num_elements()))});
    run(scene, 1);
  }

  /// Masses times a field, in sum.
  Vec3 times_masses(const PointArray& field) {
    PointArray sum = PointArray::Zero(field.rows(), 3);
    at<scene::Mass>(scene, "mass").add_product(1, field, sum);
    return sum.colwise().sum().transpose();
  }
  double mass() { return times_masses(PointArray::Ones(nodes(scene).rows(), 3)).x(); }
  Vec3 momentum() { return times_masses(at<scene::MechanicalState>(scene, "nodes").velocities()); }
};

// As many openings as HEXAPLAST_OPENINGS says.
TEST(Lips, OfRandomOpeningsLoseNoMassAndNoMomentum) {
  const char* given = std::getenv("HEXAPLAST_OPENINGS");
  const std::size_t num_openings = given ? std::stoul(given) : 2000;
  std::size_t num_opened = 0, num_removed = 0;
  double touching = 0;
  for (unsigned seed = 0; num_opened < num_openings; ++seed) {
    Crumbling block({3, 3, 2}, seed);
    const double mass = block.mass();
    const Vec3 momentum = block.momentum();
    for (int step = 0; step < 3; ++step) {
      block.step(11, 0.2);
      touching = std::max(touching, reading(block.scene, "touching"));
    }
    num_opened += lips_body(block.scene).opened().size();
    num_removed += lips_body(block.scene).removed().size();
    ASSERT_TRUE(nodes(block.scene).allFinite()) << seed;
    EXPECT_NEAR(block.mass(), mass, 1e-12 * mass) << seed;
    EXPECT_LT((block.momentum() - momentum).norm(), 1e-9 * mass * 0.1) << seed;
  }
  EXPECT_GT(num_removed, num_openings / 100);
  EXPECT_GT(touching, 50);
}

// Amid a cut: before a step that finds out where lips begin to touch, and while they part. A scene that has been reset
// is as at first.
TEST(Lips, GoOnWithTheSameBits) {
  constexpr std::array<int, 3> kCells = {4, 3, 3};
  std::vector<std::vector<std::byte>> states;
  double touching = 0;
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    Crumbling block(kCells, 1);
    for (int step = 0; step < 20; ++step) {
      block.step(5);
      touching = std::max(touching, reading(block.scene, "touching"));
      if (threads == 1)
        states.push_back(saved(block.scene));
      else
        ASSERT_EQ(saved(block.scene), states[step]) << "step " << step;
    }
    set_num_threads(1);
  }
  EXPECT_GT(touching, 50);

  Crumbling straight(kCells, 1), resumed(kCells, 1);
  for (int step = 0; step < 12; ++step) straight.step(5);
  resumed.step(3);  // which is forgotten
  const std::vector<int> joints(straight.closed.begin(), straight.closed.begin() + 10);
  for (int more = 0; more < 4; ++more) {
    if (more == 0) straight.scene.open(flesh(straight.scene), joints);
    go_on_in(straight.scene, resumed.scene);
    EXPECT_EQ(saved(resumed.scene), saved(straight.scene));
    for (scene::Scene* one : {&straight.scene, &resumed.scene}) run(*one, 2);
    EXPECT_EQ(saved(resumed.scene), saved(straight.scene)) << more;
  }
  const std::string text = block_of(kCells, kTouch, 1e-3, "yieldStress='200' plasticFlowRate='5'");
  scene::Scene fresh = read_and_init(text), other = read_and_init(text);
  other.open(flesh(other), joints_across(lips_body(other), 0, 0.02));
  run(other, 3);
  other.reset();
  for (scene::Scene* one : {&fresh, &other}) {
    one->open(flesh(*one), joints_across(lips_body(*one), 0, 0.01));
    run(*one, 3);
  }
  EXPECT_EQ(saved(other), saved(fresh));
}

// Lips lie on one another but for rounding, which knows the axes.
TEST(Lips, TouchInWhateverWayTheBodyIsTurned) {
  const HexMesh grid = regular_grid({4, 2, 1}, Vec3::Zero(), {4 * kCell, 2 * kCell, kCell});
  std::string foot, end;
  for (int n = 0; n < grid.num_nodes(); ++n) {
    if (grid.positions()(n, 0) == 0) foot += std::to_string(n) + " ";
    if (grid.positions()(n, 0) > 3.5 * kCell) end += std::to_string(n) + " ";
  }
  std::vector<int> joints;
  std::optional<PointArray> expected;
  double touching = 0;
  for (const double angle : {0.0, 1e-9, std::numbers::pi / 2, 2.1}) {
    const Mat3 R = Eigen::AngleAxisd(angle, Vec3(1, angle == 2.1, 0).normalized()).toRotationMatrix();
    const Vec3 pull = R * Vec3(-0.05, 0.02, 0);
    scene::Scene scene = read_and_init(
        "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='0.3' "
        "rayleighStiffness='0.02'/><SparseLDLSolver/>" +
        mesh_topology(HexMesh(grid.positions() * R.transpose(), grid.hexahedra())) +
        "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField "
        "name='flesh' youngModulus='8000' poissonRatio='0.4'/><FixedProjectiveConstraint indices='" +
        foot + "'/><ConstantForceField indices='" + end +
        fmt::format("' totalForce='{} {} {}'/><TissueContactForceField name='touch' friction='0.2'/></Node>", pull[0],
                    pull[1], pull[2]));
    run(scene, 3);
    if (!expected) joints = joints_across(lips_body(scene), 0, 2 * kCell);
    scene.open(flesh(scene), joints);
    run(scene, 1);
    const double touching_now = reading(scene, "touching");
    run(scene, 10);
    const PointArray back = nodes(scene) * R;
    if (!expected) {
      expected = back;
      touching = touching_now;
      EXPECT_GT(touching, 10);
    }
    EXPECT_EQ(touching_now, touching) << angle;
    EXPECT_LE((back - *expected).cwiseAbs().maxCoeff(), 1e-9) << angle;
  }
}

TEST(Lips, OfASheetThatClosesDoNotPassThroughEachOther) {
  std::string text = content(HEXAPLAST_SOURCE_DIR "/scenes/sheet_cut.scn");
  const auto replace = [&](const std::string& what, const std::string& by) { text = replaced(text, what, by); };
  for (const std::string side : {"-", ""}) {
    const std::string out = side + "0.003 0 0  ", in = (side.empty() ? "-" : "") + std::string("0.0005 0 0  ");
    replace("keyTimes=\"0 0.4 2\"", "keyTimes=\"0 0.4 1.4 1.9 9\"");
    replace("movements=\"0 0 0  " + out + side + "0.003 0 0\"", "movements=\"0 0 0  " + out + out + in + in + "\"");
  }
  const double d = 0.0005;
  replace("<Probe name=\"strain\"",
          "<TissueContactForceField name='touch' contactDistance='0.0005'/><Probe name=\"strain\"");
  scene::Scene scene = read_and_init(text);
  auto& state = at<scene::MechanicalState>(scene, "sheet/nodes");
  const Body& body = *at<scene::ForceField>(scene, "sheet/material").body();
  // of the copies of nodes, the right one from the left one
  const auto gaps = [&] {
    std::vector<double> all, side(static_cast<std::size_t>(state.num_nodes()), 0);
    for (const Hexahedron& corners : body.mesh().hexahedra()) {
      double x = 0;
      for (const int n : corners) x += body.mesh().positions()(n, 0) / 8;
      for (const int n : corners) side[n] += x;
    }
    for (int n = 0; n < body.copies().num_initial(); ++n)
      if (const auto copies = body.copies().of(n); copies.size() == 2) {
        const double sign = side[copies[0]] < side[copies[1]] ? 1 : -1;
        all.push_back(sign * (state.positions()(copies[1], 0) - state.positions()(copies[0], 0)));
      }
    return all;
  };
  run(scene, 130);
  EXPECT_EQ(gaps().size(), 57u);
  EXPECT_GT(std::ranges::max(gaps()), 0.004) << "it gapes";
  for (int k = 0; k < 8; ++k) {
    run(scene, 10);
    EXPECT_EQ(std::ranges::count_if(gaps(), [](double gap) { return gap < 0; }), 0) << scene.time();
  }
  EXPECT_GT(at<scene::Component>(scene, "sheet/touch").reals("touching")[0], 300);
  EXPECT_LT(std::ranges::max(gaps()), 1.01 * d);
  EXPECT_GT(std::ranges::min(gaps()), 0.98 * d);
}

}  // namespace
