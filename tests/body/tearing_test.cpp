// SPDX-License-Identifier: LGPL-2.1-or-later
// What holds while a body is torn to pieces: surface, volume, forces, solvability, momentum, and the way a crack goes.
//                                                                                              theory.md section 5.7
#include <map>
#include <set>

#include "support/core.hpp"

namespace hexaplast {
namespace {

using SurfaceFaces = std::vector<std::array<int, 4>>;

Material tearing(double fracture_stress) {
  return {.yield_stress = 300, .flow_rate = 20, .hardening = 0.3, .fracture_stress = fracture_stress};
}

/// Volume inside a closed surface of bilinear faces, by the divergence theorem: six times the volume between a face and
/// the origin is the mean of what its two splittings into triangles enclose.
double enclosed_volume(const SurfaceFaces& surface, const PointArray& x) {
  double sixfold = 0;
  for (const auto& [a, b, c, d] : surface) {
    const auto cone = [&](int i, int j, int k) { return Vec3(x.row(i)).dot(Vec3(x.row(j)).cross(Vec3(x.row(k)))); };
    sixfold += (cone(a, b, c) + cone(a, c, d) + cone(a, b, d) + cone(b, c, d)) / 2;
  }
  return sixfold / 6;
}

/// Whether each edge is passed as often one way as the other: the surface has no border.
bool is_closed(const SurfaceFaces& surface) {
  std::map<std::array<int, 2>, int> passed;
  for (const auto& face : surface)
    for (int k = 0; k < 4; ++k) {
      const int from = face[k], to = face[(k + 1) % 4];
      passed[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  return std::ranges::all_of(passed, [](const auto& edge) { return edge.second == 0; });
}

// Many small bodies, each until nothing is left of it: scripts/soak repeats it with memory and arithmetic watched.
TEST(Tearing, KeepsSurfaceVolumeAndBalanceOverTenThousandRemovals) {
  Random random(301);
  const HexMesh mesh = distorted_block({3, 3, 2}, kEdge, 0.1, 302);
  const PointArray current = stretched_and_twisted(mesh, 1.4, 0.5);
  std::vector<double> volume_of(mesh.num_elements());
  for (int e = 0; e < mesh.num_elements(); ++e) volume_of[e] = volume(gather(current, mesh.hexahedra()[e]));

  std::size_t total = 0;
  while (total < 10000) {
    std::vector<Material> materials;
    for (int e = 0; e < mesh.num_elements(); ++e) materials.push_back(tearing(random.uniform(301, 480)));
    Settings settings;
    if (total % 36 == 0) settings.rest_shape = RestShape::kJoined;
    if (total % 180 == 0)
      settings.averaging = AveragingMethod::kJacobi, settings.implementation = Implementation::kPlain;
    Body body(mesh, std::move(materials), settings);
    const History& history = body.state().history;
    const std::vector<double> mass = lumped_masses(body, 1000);
    CholeskySolver solver;
    PreconditionedConjugateGradients iterative(1e-13, 2000);
    for (int k = 0; k < 100 && history.removed.size() < volume_of.size(); ++k) {
      // now and then one anywhere, as a host takes it; the others when they break
      const std::size_t before = history.removed.size();
      std::size_t taken = 0;
      if (random.uniform(0, 1) < 0.4) {
        const int e = static_cast<int>(random.uniform(0, mesh.num_elements()));
        taken = history.alive[e];
        body.remove(std::array{e});
      }
      const FlowReport report = body.flow(current, kStep);
      ASSERT_EQ(history.removed.size(), before + taken + report.removed);
      if (taken + report.removed == 0) continue;

      double expected = 0;
      for (int e = 0; e < mesh.num_elements(); ++e) {
        ASSERT_EQ(std::ranges::count(history.removed, e), history.alive[e] ? 0 : 1);
        if (history.alive[e]) expected += volume_of[e];
      }
      const SurfaceFaces surface = mesh.boundary_faces(history.alive);
      ASSERT_TRUE(is_closed(surface));
      ASSERT_NEAR(enclosed_volume(surface, current), expected, 1e-15);
      ASSERT_NEAR(body.volume(current), expected, 1e-15);

      // one implicit step of what is left: forces in balance, no momentum, nothing singular, nothing blown away
      LoadedBody system(body, mass, {}, {});
      PointArray x = current, v = PointArray::Zero(mesh.num_nodes(), 3), f = v, x_iterated = x, v_iterated = v;
      body.linearize(current);
      body.add_force(f);
      ASSERT_LE(f.colwise().sum().norm(), 1e-12 * std::max(1.0, f.cwiseAbs().sum()));
      ImplicitEuler({}).step(system, solver, 0, kStep, x, v);
      ImplicitEuler({}).step(system, iterative, 0, kStep, x_iterated, v_iterated);
      ASSERT_LE(max_abs(v - v_iterated), 1e-8 * std::max(1e-6, max_abs(v)));
      Vec3 momentum = Vec3::Zero();
      const std::vector<int> part_of_node = connected_parts(mesh, history.alive).part_of_node;
      for (int n = 0; n < mesh.num_nodes(); ++n) {
        momentum += mass[n] * v.row(n).transpose();
        if (part_of_node[n] >= 0) continue;
        ASSERT_EQ(v.row(n).norm() + f.row(n).norm(), 0) << "node " << n;
      }
      ASSERT_LE(momentum.norm(), 1e-10);
      ASSERT_LE(max_abs(x - current), 0.5 * kEdge);
      ASSERT_TRUE(history.plastic_rest_positions.allFinite());
    }
    ASSERT_EQ(history.removed.size(), volume_of.size());
    ASSERT_EQ(body.energy(current), 0);
    ASSERT_EQ(body.flow(current, kStep).removed, 0);
    total += history.removed.size();
  }
}

constexpr std::array<int, 3> kSheet{13, 8, 1};  // hexahedra of 1 cm along the pull, across, and through
constexpr double kCell = 0.01;                  // [m]
constexpr int kMiddle = 6;                      // column of hexahedra in which the sheet is notched
constexpr int kNotch = 3;                       // rows that the notch takes

/// A sheet notched from one side to three eighths of its width; every node moved by up to `fraction` of an edge.
HexMesh notched_sheet(double fraction) {
  const HexMesh whole = distorted_block(kSheet, kCell, fraction, 303);
  std::vector<Hexahedron> hexahedra;
  for (int e = 0; e < whole.num_elements(); ++e)
    if (e % kSheet[0] != kMiddle || e / kSheet[0] >= kNotch) hexahedra.push_back(whole.hexahedra()[e]);
  return HexMesh(whole.positions(), std::move(hexahedra));
}

/// The sheet, free and at rest, pulled apart at its ends along x by `pull` [N] until it is in two pieces.
MovingBody pulled_sheet(const HexMesh& mesh, double pull, const bool& is_pulled) {
  const std::vector<int> lower = nodes_at(mesh, 0, 0, 0.2 * kCell),
                         upper = nodes_at(mesh, 0, kSheet[0] * kCell, 0.2 * kCell);
  Motion setup;
  setup.euler = {.rayleigh_mass = 0, .rayleigh_stiffness = 0.02};
  setup.load = [=, &is_pulled](double time, ConstPoints, Points f) {
    if (!is_pulled) return;
    const double fraction = pull * std::min(1.0, time / 0.2) / static_cast<double>(lower.size());
    for (const int n : lower) f(n, 0) -= fraction;
    for (const int n : upper) f(n, 0) += fraction;
  };
  return {Body(mesh, {tearing(320)}, published_element()), std::move(setup)};
}

using Crack = std::set<std::array<int, 2>>;  // hexahedra by column and row

/// The removed hexahedra once the sheet is in two pieces; empty if it holds.
Crack crack_of(double fraction, double pull) {
  const HexMesh mesh = notched_sheet(fraction);
  bool is_pulled = true;
  MovingBody sheet = pulled_sheet(mesh, pull, is_pulled);
  const History& history = sheet.body.state().history;
  for (int k = 0; k < 200; ++k) {
    if (sheet.step().removed == 0 || connected_parts(mesh, history.alive).count == 1) continue;
    Crack crack;
    for (const int e : history.removed) {
      const int first = mesh.hexahedra()[e][0];  // the smallest corner: node (column, row, 0) of the grid
      crack.insert({first % (kSheet[0] + 1), first / (kSheet[0] + 1)});
    }
    return crack;
  }
  return {};
}

/// Whether a crack takes all that the notch leaves of its column, and nothing beyond the columns beside it.
bool continues_the_notch(const Crack& crack) {
  for (int row = kNotch; row < kSheet[1]; ++row)
    if (!crack.contains({kMiddle, row})) return false;
  return std::ranges::all_of(crack, [](const auto& cell) { return std::abs(cell[0] - kMiddle) <= 1; });
}

TEST(Tearing, ContinuesTheNotchAndTakesTheSameWayAfterASmallChange) {
  const Crack crack = crack_of(0, 0.16);
  EXPECT_TRUE(continues_the_notch(crack));
  for (const auto& [column, row] : crack)
    EXPECT_TRUE(crack.contains({2 * kMiddle - column, row})) << "the sheet is its own mirror image, the crack too";
  EXPECT_EQ(crack_of(0.01, 0.16), crack) << "nodes moved by up to one per cent of an edge";
  EXPECT_TRUE(continues_the_notch(crack_of(0, 0.17))) << "another load";
}

TEST(Tearing, LeavesEachPieceItsMomentum) {
  const HexMesh mesh = notched_sheet(0.05);
  bool is_pulled = true;
  MovingBody sheet = pulled_sheet(mesh, 0.16, is_pulled);
  ConnectedParts parts{{}, 1};
  const auto momenta = [&] {
    std::vector<Vec3> of_part(parts.count + 1, Vec3::Zero());  // the last one: nodes without hexahedron
    for (int n = 0; n < mesh.num_nodes(); ++n)
      of_part[parts.part_of_node[n] < 0 ? parts.count : parts.part_of_node[n]] +=
          sheet.mass()[n] * sheet.velocities.row(n).transpose();
    return of_part;
  };
  for (int k = 0; k < 200 && parts.count == 1; ++k) {
    sheet.step();
    parts = connected_parts(mesh, sheet.body.state().history.alive);
  }
  ASSERT_EQ(parts.count, 2);

  is_pulled = false;
  const std::vector<Vec3> at_break = momenta();
  const double size = at_break[0].norm();
  EXPECT_GT(size, 0);
  EXPECT_LE(std::accumulate(at_break.begin(), at_break.end(), Vec3(0, 0, 0)).norm(), 1e-11 * size);
  for (int k = 0; k < 100; ++k) {
    sheet.step();  // what a piece still loses stays its own
    const std::vector<Vec3> now = momenta();
    for (std::size_t part = 0; part < now.size(); ++part)
      ASSERT_LE((now[part] - at_break[part]).norm(), 1e-10 * size) << "part " << part << ", step " << k;
  }
}

}  // namespace
}  // namespace hexaplast
