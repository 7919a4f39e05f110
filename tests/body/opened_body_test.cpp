// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/core.hpp"

namespace hexaplast {
namespace {

Material soft_and_yielding() {
  Material material;
  material.young_modulus = 5000;
  material.poisson_ratio = 0.4;
  material.yield_stress = 100;
  material.flow_rate = 20;
  return material;
}

/// Faces between hexahedra on both sides of the plane where coordinate `axis` is `at` [m].
std::vector<int> joints_across(const Body& body, int axis, double at) {
  const HexMesh& mesh = body.mesh();
  const auto is_below = [&](int e) { return gather(mesh.positions(), mesh.hexahedra()[e]).col(axis).mean() < at; };
  std::vector<int> across;
  for (int j = 0; j < body.joints().count(); ++j) {
    const std::span<const int> held = body.joints().hexahedra(j);
    if (is_below(held.front()) != is_below(held.back())) across.push_back(j);
  }
  return across;
}

std::vector<int> all_joints(const Body& body) {
  std::vector<int> all(body.joints().count());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::unique_ptr<LinearSolver> solver(bool direct) {
  if (direct) return std::make_unique<CholeskySolver>();
  return std::make_unique<PreconditionedConjugateGradients>(1e-13, 2000, Preconditioner::kMultigrid);
}

const Motion kFalling{.density = 1000, .dt = 0.01, .gravity = {0, 0, -9.81}, .euler = {.rayleigh_stiffness = 0.01}};

/// The default element in double precision, in single precision, and the paper's method.
class OpenedBody : public testing::TestWithParam<int> {
 protected:
  Settings settings() const {
    if (GetParam() == 2) return published_element();
    Settings settings;
    settings.precision = GetParam() == 0 ? Precision::kDouble : Precision::kMixed;
    return settings;
  }
};
INSTANTIATE_TEST_SUITE_P(Settings, OpenedBody, testing::Values(0, 1, 2));

// Held at its ends, and cut through the middle.
TEST_P(OpenedBody, CutThroughMovesAsItsHalvesAlone) {
  const HexMesh whole = block({10, 3, 3}, 0.02), half = block({5, 3, 3}, 0.02);
  for (const bool direct : {true, false}) {
    if (!direct && GetParam() == 2) continue;  // the paper's method has no multigrid
    MovingBody cut(Body(whole, {soft_and_yielding()}, settings()), kFalling, solver(direct));
    MovingBody alone(Body(half, {soft_and_yielding()}, settings()), kFalling, solver(direct));
    std::vector<int> lower;  // nodes of the whole that are the half's, in its order
    for (int n = 0; n < whole.num_nodes(); ++n)
      if (whole.positions()(n, 0) < 0.1 + 1e-9) lower.push_back(n);
    cut.fix(nodes_at(whole, 0, 0));
    cut.fix(nodes_at(whole, 0, 0.2));
    alone.fix(nodes_at(half, 0, 0));
    const std::vector<int> parents = cut.open(joints_across(cut.body, 0, 0.1));
    ASSERT_EQ(parents.size(), 16u);
    ASSERT_EQ(cut.positions.rows(), whole.num_nodes() + 16);
    int yielded = 0;
    for (int step = 0; step < 40; ++step) {
      const FlowReport flow = cut.step();
      alone.step();
      yielded += flow.yielded;
    }
    EXPECT_GT(yielded, 0);
    // the half of the lower hexahedra keeps the numbers
    EXPECT_LE(max_abs(cut.positions(lower, Eigen::all) - alone.positions), GetParam() == 1 ? 1e-7 : 1e-10);
    EXPECT_GT(max_abs(cut.positions.bottomRows(16) - cut.positions(parents, Eigen::all)), 0.01);
  }
}

TEST_P(OpenedBody, AllOpenFallsInParabolas) {
  const HexMesh mesh = distorted_block({3, 3, 3}, 0.02, 0.1, 5);
  MovingBody moving(Body(mesh, {soft_and_yielding()}, settings()), {.dt = 0.01, .gravity = {0, 0, -9.81}},
                    solver(true));
  moving.open(all_joints(moving.body));
  ASSERT_EQ(moving.body.mesh().num_nodes(), 8 * 27);
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (const int n : moving.body.mesh().hexahedra()[e]) moving.velocities.row(n) = Vec3(0.1 * e, 0, 1).transpose();
  moving.run(20);
  double fallen = 0, v = 0;  // implicit Euler
  for (int step = 0; step < 20; ++step) fallen += 0.01 * (v -= 0.01 * 9.81);
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (const int n : moving.body.mesh().hexahedra()[e]) {
      const Vec3 expected = moving.body.mesh().positions().row(n).transpose() + Vec3(0.1 * e * 0.2, 0, 0.2 + fallen);
      EXPECT_LE((moving.positions.row(n).transpose() - expected).norm(), GetParam() == 1 ? 1e-5 : 1e-11);
    }
}

// In whatever order and with however many threads joints open; saved, loaded and undone amid a cut.
TEST_P(OpenedBody, GoesOnWithTheSameBits) {
  const HexMesh mesh = GetParam() == 2 ? block({8, 4, 4}, 0.02) : block({16, 8, 8}, 0.01);
  const auto made = [&] {
    MovingBody moving(Body(mesh, {soft_and_yielding()}, settings()), kFalling,
                      std::make_unique<PreconditionedConjugateGradients>(1e-6, 500));  // multigrid where there is one
    moving.fix(nodes_at(mesh, 0, 0));
    return moving;
  };
  MovingBody first = made(), second = made();
  const std::string initial = first.state_hash();
  std::stringstream saved;
  for (MovingBody* moving : {&first, &second}) {
    set_num_threads(moving == &first ? 1 : 3);
    moving->run(8);
    std::vector<int> joints = joints_across(moving->body, 0, 0.08);
    joints.resize(10);
    if (moving == &second) std::ranges::reverse(joints);
    std::vector<double> crossings;
    for (const int joint : joints) crossings.push_back(joint / static_cast<double>(moving->body.joints().count()));
    moving->open(joints, crossings);
    moving->run(4);
    if (moving == &first) moving->save(saved);
    moving->open(joints_across(moving->body, 1, 0.04));
    moving->run(4);
  }
  set_num_threads(0);
  EXPECT_EQ(first.state_hash(), second.state_hash());
  for (std::size_t k = 0; k < 10; ++k)
    EXPECT_EQ(first.body.crossings()[k], first.body.opened()[k] / static_cast<double>(first.body.joints().count()));
  EXPECT_EQ(first.body.crossings().back(), 0.5);
  EXPECT_EQ(first.body.opened().size(), 10u + joints_across(made().body, 1, 0.04).size());

  MovingBody third = made();
  for (MovingBody* moving : {&third, &second}) {
    saved.clear();
    saved.seekg(0);
    moving->load(saved);
    EXPECT_EQ(moving->positions.rows(), moving->body.mesh().num_nodes());
    moving->open(joints_across(moving->body, 1, 0.04));
    moving->run(4);
    EXPECT_EQ(moving->state_hash(), first.state_hash());
  }
  first.reset();
  EXPECT_EQ(first.state_hash(), initial);
  EXPECT_EQ(first.body.mesh().num_nodes(), mesh.num_nodes());
  EXPECT_TRUE(first.body.opened().empty());
}

// Opening moves nothing, and takes no mass, momentum or energy.
TEST_P(OpenedBody, KeepsMassMomentumAndEnergy) {
  Random random(11);
  const HexMesh mesh = distorted_block({4, 3, 3}, 0.02, 0.15, 9);
  MovingBody moving(Body(mesh, {soft_and_yielding()}, settings()), kFalling);
  moving.positions += random.field(mesh.num_nodes(), 0.002);
  moving.velocities = random.field(mesh.num_nodes(), 0.1);
  moving.run(3);
  const auto sums = [&] {
    const Eigen::Map<const Eigen::VectorXd> mass(moving.mass().data(), std::ssize(moving.mass()));
    Eigen::VectorXd all(9);
    all[0] = mass.sum();
    all.segment<3>(1) = moving.velocities.transpose() * mass;
    Vec3 spin = Vec3::Zero();
    for (int n = 0; n < mass.size(); ++n)
      spin += mass[n] * moving.positions.row(n).transpose().cross(moving.velocities.row(n).transpose());
    all.segment<3>(4) = spin;
    all[7] = moving.velocities.rowwise().squaredNorm().dot(mass) / 2;
    all[8] = moving.body.energy(moving.positions);
    return all;
  };
  const Eigen::VectorXd before = sums();
  for (int call = 0; call < 5; ++call) {
    std::vector<int> opened;
    for (const int j : all_joints(moving.body))
      if (random.uniform(0, 1) < 0.2) opened.push_back(j);
    moving.open(opened);
    EXPECT_LE((sums() - before).cwiseAbs().maxCoeff(), 1e-12 * before.cwiseAbs().maxCoeff());
    moving.body.linearize(moving.positions);
    PointArray force = PointArray::Zero(moving.positions.rows(), 3);
    moving.body.add_force(force);
    EXPECT_LE(force.colwise().sum().norm(), 1e-12 * force.norm());
  }
}

TEST_P(OpenedBody, RefusesWhatIsNoJoint) {
  MovingBody moving(Body(block({3, 3, 3}, 0.1), {Material{}}, settings()), {});
  const std::string before = moving.state_hash();
  EXPECT_TRUE(refuses<InputError>([&] { moving.open(std::vector{0, 54}); }, {"joint 54", "[0, 54)"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.open(std::vector{-1}); }, {"joint -1"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.open(std::vector{0}, std::vector{1.5}); }, {"crossing 1.5", "[0, 1]"}));
  EXPECT_TRUE(refuses<InputError>([&] { moving.open(std::vector{0}, std::vector{.5, .5}); }, {"2 crossings for 1"}));
  EXPECT_EQ(moving.state_hash(), before);
  int inside = 0;
  while (moving.body.joints().hexahedra(inside).front() != 13) ++inside;
  // other faces hold its nodes together
  EXPECT_TRUE(moving.open(std::vector{inside, inside}, std::vector{0.25, 0.75}).empty());
  EXPECT_EQ(moving.body.opened().size(), 1u);
  EXPECT_EQ(moving.body.crossings()[0], 0.25);
  const long revision = moving.body.revision();
  EXPECT_TRUE(moving.open(std::vector{inside}).empty());
  EXPECT_EQ(moving.body.revision(), revision);

  moving.body.open(joints_across(moving.body, 0, 0.15));
  EXPECT_TRUE(refuses<InputError>([&] { moving.step(); }, {"not its body"}));
}

/// tests/data/cutting: the same masses and pieces as those of the reference.
TEST(Body, OpensAsTheReferenceDoes) {
  for (const std::string name : {"block_random", "corner_contact", "removed", "voxels_random"}) {
    const Json data = test_data("cutting", "mesh_" + name);
    Body body(HexMesh(matrix(data["positions"]), hexahedra(data["hexahedra"])), {Material{}});
    std::vector<int> gone;
    for (int e = 0; e < body.mesh().num_elements(); ++e)
      if (data.contains("alive") && data["alive"][e] == 0) gone.push_back(e);
    body.remove(gone);
    for (const Json& call : data["calls"]) {
      std::vector<int> joints;
      for (const auto& face : call["open"]["faces"])
        joints.push_back(body.joints().find(Joints::Face{face[0], face[1]}));
      for (const auto& hinge : call["open"]["hinges"])
        joints.push_back(body.joints().find(Joints::Hinge{hinge[0], hinge[1]}));
      body.open(joints);
      const Json& after = call["after"];
      EXPECT_EQ(body.mesh().hexahedra(), hexahedra(after["hexahedra"]));
      const Eigen::VectorXd masses = support::vector(after["masses"]);
      const std::vector<double> ours = lumped_masses(body, 1);
      for (int n = 0; n < masses.size(); ++n) EXPECT_NEAR(ours[n], masses[n], 4 * 0x1p-52 * masses[n]);
      const ConnectedParts pieces = connected_parts(body.mesh(), body.alive());
      EXPECT_EQ(pieces.part_of_node, after["piece_of_node"]);
      EXPECT_EQ(pieces.count, after["num_pieces"]);
    }
  }
}

}  // namespace
}  // namespace hexaplast
