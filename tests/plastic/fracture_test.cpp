// SPDX-License-Identifier: LGPL-2.1-or-later
// Elements that break: when they go, and that nothing else notices.                           theory.md section 5.7
#include "hexaplast/solve/newton_raphson.hpp"
#include "support/bar.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

Material hardening() { return {.yield_stress = 300, .flow_rate = 4, .hardening = 0.3}; }

double greatest(const CornerValues& values) { return *std::max_element(values.begin(), values.end()); }

// A body that never breaks flows beside one that does: until the step in which tau passes the limit they are the same.
TEST(Fracture, TakesAnElementInTheStepInWhichItsYieldStressPassesTheLimit) {
  const HexMesh mesh = distorted_block({1, 1, 1}, kEdge, 0.1, 201);
  for (const double limit : {320.0, 400.0, 500.0}) {
    Material brittle = hardening();
    brittle.fracture_stress = limit;
    Body whole(mesh, {hardening()}), body(mesh, {brittle});
    for (int k = 1; k <= 200; ++k) {
      const PointArray current = stretched_and_twisted(mesh, 1 + 0.002 * k, 0);
      whole.flow(current, kStep);
      const FlowReport report = body.flow(current, kStep);
      const double tau = greatest(whole.state().history.yield_stress[0]);
      ASSERT_EQ(report.removed, tau > limit) << "step " << k;
      ASSERT_EQ(body.state().history.yield_stress[0], whole.state().history.yield_stress[0]);
      if (report.removed) break;
    }
    EXPECT_EQ(body.state().history.removed, std::vector<int>{0});
  }
}

// Rotation flows below the yield stress, and without one. The threshold of stretch does not grow by it.
TEST(Fracture, ByStressTakesNoElementThatOnlyTurns) {
  const HexMesh mesh = block({1, 1, 4}, kEdge);
  const PointArray twisted = stretched_and_twisted(mesh, 1, 2);
  for (const RotationPlasticity mode :
       {RotationPlasticity::kObjective, RotationPlasticity::kVertex, RotationPlasticity::kCentre}) {
    for (const double yield_stress : {std::numeric_limits<double>::infinity(), 1e9}) {
      Material turning = hardening();
      turning.yield_stress = yield_stress;
      turning.rotation_flow_rate = 2;
      std::vector<Material> materials(4, turning);
      materials[3].fracture_stress = yield_stress;  // one may be torn by stress, or the limit would be refused
      for (int e = 0; e < 3; ++e) materials[e].fracture_stress = 600;
      Settings settings = kJoined;
      settings.rotation_plasticity = mode;
      if (mode != RotationPlasticity::kObjective) settings.implementation = Implementation::kPlain;
      Body body(mesh, materials, settings);
      for (int k = 0; k < 50; ++k) ASSERT_EQ(body.flow(twisted, kStep).removed, 0) << "step " << k;
      EXPECT_TRUE(body.state().history.removed.empty());
      EXPECT_GT(max_abs(body.state().history.plastic_rest_positions - mesh.positions()), 0.01 * kEdge)
          << "nothing flowed";
    }
  }
}

// What begins beyond the limit, as some of a body may, goes in the step in which it hardens.
TEST(Fracture, TakesWhatBeginsBeyondTheLimitWhenItFlows) {
  const HexMesh mesh = block({1, 1, 2}, kEdge);
  std::vector<Material> materials(2, hardening());
  materials[0].fracture_stress = 200;
  materials[1].fracture_stress = 1e9;
  Body body(mesh, materials);
  EXPECT_EQ(body.flow(stretched_and_twisted(mesh, 1.02, 0), kStep).removed, 0);  // 100 Pa
  EXPECT_EQ(body.flow(stretched_and_twisted(mesh, 1.2, 0), kStep).removed, 1);
  EXPECT_EQ(body.state().history.removed, std::vector<int>{0});
}

TEST(Fracture, TakesAnElementInTheStepInWhichItsPlasticStretchPassesTheLimit) {
  const HexMesh mesh = block({1, 1, 1}, kEdge);
  Material brittle = hardening();
  brittle.fracture_stretch = 1.1;
  Body whole(mesh, {hardening()}, kJoined), body(mesh, {brittle}, kJoined);
  const EndSections ends = end_sections(mesh);
  const PointArray current = mapped(mesh.positions(), Vec3(1.3, 1 / std::sqrt(1.3), 1 / std::sqrt(1.3)).asDiagonal());
  for (int k = 1; k <= 200; ++k) {
    whole.flow(current, kStep);
    const FlowReport report = body.flow(current, kStep);
    // a homogeneous stretch is the same product of S^p at every corner: the stretch of the plastic rest shape
    ASSERT_EQ(report.removed, elongation(ends, whole.state().history.plastic_rest_positions) > 0.1) << "step " << k;
    if (report.removed) return;
  }
  FAIL() << "it never broke";
}

// The load is the same at both ends, so the ends break alike and at once. The times are those of an independent
// implementation; the order is the physics: next to the load and the clamp.
TEST(Fracture, OfABarUnderASymmetricLoadIsSymmetric) {
  for (const auto& [limit, expected_time] : {std::pair{900.0, 0.66}, std::pair{1500.0, 1.04}}) {
    MovingBody bar = support::bar(BarLoad::kStretch, "high", limit);
    const std::vector<double> mass = bar.mass();
    double first = 0;
    for (int k = 0; k < 130; ++k) {
      if (bar.step().removed > 0 && first == 0) first = bar.time();
      const auto& alive = bar.body.state().history.alive;
      for (int e = 0; e < 90; ++e) {
        const int layer = e / 9, opposite = (9 - layer) * 9 + e % 9;
        ASSERT_EQ(alive[e], alive[opposite]) << "element " << e << " at " << bar.time() << " s";
      }
    }
    EXPECT_NEAR(first, expected_time, 0.02);
    EXPECT_EQ(bar.mass(), mass);
    EXPECT_TRUE(bar.positions.allFinite());
  }
}

// A beam under its own weight whose end is gone rests as a beam that never had it; the nodes of the end stay.
TEST(Fracture, LeavesAStaticEquilibriumThatIgnoresNodesWithoutElement) {
  const HexMesh shorter = block({4, 2, 2}, kEdge), longer = block({6, 2, 2}, kEdge);
  Body broken(longer, {Material{}}), whole(shorter, {Material{}});
  for (int e = 0; e < longer.num_elements(); ++e)
    if (e % 6 > 3) broken.remove(std::array{e});
  const auto weight = [](double, ConstPoints, Points f) { f.col(2).array() -= 0.04; };
  const auto rest = [&](Body& body, LinearSolver& solver) {
    LoadedBody system(body, std::vector<double>(body.mesh().num_nodes(), 0), nodes_at(body.mesh(), 0, 0), weight);
    PointArray x = body.mesh().positions();
    NewtonRaphson newton({.iterations = 50,
                          .relative_successive = 0,
                          .relative_initial = 0,
                          .absolute_residual = 1e-9,
                          .line_search_iterations = 3});
    EXPECT_EQ(newton.solve(system, solver, 0, x).status, NewtonStatus::kConverged);
    return x;
  };
  CholeskySolver direct;
  const PointArray expected = rest(whole, direct);
  ASSERT_LT(expected.col(2).minCoeff(), -0.01);

  PreconditionedConjugateGradients iterative(1e-12, 2000);
  for (LinearSolver* solver : {static_cast<LinearSolver*>(&direct), static_cast<LinearSolver*>(&iterative)}) {
    const PointArray x = rest(broken, *solver);
    for (int n = 0; n < longer.num_nodes(); ++n) {  // 7 and 5 along the beam
      const Vec3 place = n % 7 < 5 ? expected.row(n / 7 * 5 + n % 7) : longer.positions().row(n);
      EXPECT_LE((x.row(n).transpose() - place).norm(), 1e-7) << "node " << n;
    }
  }
}

// Ten thousand removals, one by one: the parts found are those that a plain flood over the live elements finds.
TEST(ConnectedParts, AreRightAfterEachOfTenThousandRandomRemovals) {
  const HexMesh mesh = block({5, 5, 4}, 1);
  const int num_elements = mesh.num_elements();
  Random random(205);
  for (int round = 0; round < 100; ++round) {
    std::vector<unsigned char> alive(num_elements, 1);
    std::vector<int> order(num_elements);
    std::iota(order.begin(), order.end(), 0);
    for (int i = num_elements - 1; i > 0; --i) std::swap(order[i], order[static_cast<int>(random.uniform(0, i + 1))]);
    for (const int gone : order) {
      alive[gone] = 0;
      const ConnectedParts parts = connected_parts(mesh, alive);

      std::vector<int> expected(mesh.num_nodes(), -1);
      int count = 0;
      const std::function<bool(int)> flood = [&](int n) {  // whether n is the first node of a part
        if (expected[n] >= 0) return false;
        for (const HexMesh::Incidence& at : mesh.incident(n)) {
          if (!alive[at.element]) continue;
          expected[n] = count;
          for (const int other : mesh.hexahedra()[at.element]) flood(other);
        }
        return expected[n] >= 0;
      };
      for (int n = 0; n < mesh.num_nodes(); ++n) count += flood(n);
      ASSERT_EQ(parts.part_of_node, expected);
      ASSERT_EQ(parts.count, count);
    }
  }
}

}  // namespace
}  // namespace hexaplast
