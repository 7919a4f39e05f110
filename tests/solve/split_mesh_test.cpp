// SPDX-License-Identifier: LGPL-2.1-or-later
// Meshes some nodes of which are split: the iterations that multigrid takes with their coarse meshes.
#include "base/disjoint_sets.hpp"
#include "layout/coarse_mesh.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

Vec3 centre(const HexMesh& mesh, int e) {
  return gather(mesh.positions(), mesh.hexahedra()[e]).colwise().mean().transpose();
}

/// Which faces are open: by the centres of two hexahedra that share one.
using Opens = std::function<bool(const Vec3&, const Vec3&)>;

/// The mesh with a node for each group of hexahedra that closed faces join around one of `initial`. Groups that no face
/// joined there, open or not, stay together unless `opens` tells the centres of their first hexahedra apart.
HexMesh split(const HexMesh& initial, const Opens& opens) {
  std::vector<Hexahedron> hexahedra = initial.hexahedra();
  std::vector<int> initial_node;
  for (int n = 0; n < initial.num_nodes(); ++n) initial_node.push_back(n);
  const auto is_open = [&](int e, int other) { return opens(centre(initial, e), centre(initial, other)); };
  for (int n = 0; n < initial.num_nodes(); ++n) {
    const auto around = initial.incident(n);
    const int count = static_cast<int>(around.size());
    if (count == 0) continue;
    DisjointSets by_faces(count), closed(count);
    const auto for_each_pair = [&](const auto& visit) {
      for (int i = 0; i < count; ++i)
        for (int j = 0; j < i; ++j) visit(i, j, around[i].element, around[j].element);
    };
    for_each_pair([&](int i, int j, int e, int other) {
      if (std::ranges::count(initial.neighbours()[e], other) == 0) return;
      by_faces.join(i, j);
      if (!is_open(e, other)) closed.join(i, j);
    });
    for_each_pair([&](int i, int j, int e, int other) {
      if (by_faces.root(i) != by_faces.root(j) && !is_open(e, other)) closed.join(i, j);
    });
    std::vector<int> number(count, -1);
    number[closed.root(0)] = n;
    for (int i = 0; i < count; ++i) {
      int& node = number[closed.root(i)];
      if (node < 0) {
        node = static_cast<int>(initial_node.size());
        initial_node.push_back(n);
      }
      hexahedra[around[i].element][around[i].corner] = node;
    }
  }
  PointArray X(static_cast<Eigen::Index>(initial_node.size()), 3);
  for (int n = 0; n < X.rows(); ++n) X.row(n) = initial.positions().row(initial_node[n]);
  return HexMesh(X, hexahedra);
}

/// Opens the faces in the plane x_axis = at, where `where` holds for their middle.
Opens plane(
    int axis, double at, const std::function<bool(const Vec3&)>& where = [](const Vec3&) { return true; }) {
  return [=](const Vec3& a, const Vec3& b) { return (a[axis] < at) != (b[axis] < at) && where((a + b) / 2); };
}

/// Two blocks that share the nodes of an edge along z, or the node of a corner.
HexMesh touching(bool at_edge) {
  const HexMesh all = block({8, 8, 8}, 0.1);
  std::vector<Hexahedron> kept;
  for (int e = 0; e < all.num_elements(); ++e) {
    const Eigen::Array3d at = centre(all, e).array();
    const bool is_low = (at.head(at_edge ? 2 : 3) < 0.4).all(), is_high = (at.head(at_edge ? 2 : 3) > 0.4).all();
    if (is_low || is_high) kept.push_back(all.hexahedra()[e]);
  }
  return HexMesh(all.positions(), kept);
}

/// Iterations of a step of a body under gravity that is held at one end.
int iterations_of(const HexMesh& mesh, double young_modulus, double tolerance) {
  MovingBody body(Body(mesh, {{.young_modulus = young_modulus}}),
                  {.gravity = {3, -9, 1}, .fixed = nodes_at(mesh, 2, 0)},
                  std::make_unique<PreconditionedConjugateGradients>(tolerance, 500, Preconditioner::kMultigrid));
  body.step();
  EXPECT_EQ(body.latest.preconditioner, PreconditionedBy::kMultigrid);
  EXPECT_TRUE(body.latest.converged);
  return body.latest.iterations;
}

/// Faces in the plane x = at, in the order of their rows from z = 0.24 down, ten in a row.
Opens first_faces(int count, double at) {
  return plane(0, at, [=](const Vec3& face) {
    return 10 * (23 - static_cast<int>(100 * face.z())) + static_cast<int>(100 * face.y()) < count;
  });
}

// Of tissue. Cuts lie between cells, and through them; they cross, end at one another, and cut loose.
TEST(SplitMesh, TakesAsManyIterationsAsTheWhole) {
  const HexMesh whole = block({10, 10, 24}, 0.01);
  const Opens across = plane(0, 0.05), along = plane(1, 0.03);
  const Opens crossed = [&](const Vec3& a, const Vec3& b) { return across(a, b) || along(a, b); };
  const Opens meeting = [&](const Vec3& a, const Vec3& b) { return across(a, b) || (along(a, b) && a.x() < 0.05); };
  const auto is_inside = [](const Vec3& at) { return ((at - Vec3(0.05, 0.05, 0.12)).array().abs() < 0.025).all(); };
  const Opens loose = [&](const Vec3& a, const Vec3& b) { return is_inside(a) != is_inside(b); };
  for (const double tolerance : {1e-2, 1e-6}) {
    const auto expect = [&](const HexMesh& of, const char* cuts, const Opens& opens, int more) {
      EXPECT_LE(iterations_of(split(of, opens), 5000, tolerance), iterations_of(of, 5000, tolerance) + more)
          << cuts << ", to " << tolerance;
    };
    for (const int cut : {4, 5}) {
      SCOPED_TRACE(cut);
      for (const int count : {1, 100, 240}) expect(whole, "one after the other", first_faces(count, 0.01 * cut), 1);
      const auto nine_slits = [&](const Vec3& a, const Vec3& b) {
        const int between = static_cast<int>(std::lround(50 * (a.z() + b.z())));  // where the hexahedra differ in z
        return std::abs(a.z() - b.z()) > 0.005 && between >= cut && between <= cut + 16 && between % 2 == cut % 2 &&
               a.x() < 0.07;
      };
      expect(whole, "slits", nine_slits, 3);
    }
    expect(whole, "crossed", crossed, 1);
    expect(whole, "one ends at the other", meeting, 1);
    expect(whole, "a loose piece", loose, 1);
    for (const bool at_edge : {true, false}) expect(touching(at_edge), "blocks that touch", plane(0, 0.4), 1);
  }
}

// Single hexahedra cut loose are not worth a cell each where they are many. The rest keeps its cells.
TEST(SplitMesh, CrumbsLeaveTheRestItsCoarseMeshes) {
  const HexMesh whole = block({12, 8, 8}, 0.1);
  const Charts charts(whole);
  const HexMesh mesh = split(whole, [](const Vec3& a, const Vec3& b) { return a.x() < 0.4 || b.x() < 0.4; });
  const Coarsening coarse = coarsen(charts.levels.at(0), mesh.num_nodes(), mesh.hexahedra()).value();
  EXPECT_EQ(coarse.cells.size(), 4U * 4 * 4);
  EXPECT_EQ(coarse.num_nodes, 5 * 5 * 5);

  const HexMesh dust = split(whole, [](const Vec3&, const Vec3&) { return true; });
  EXPECT_FALSE(coarsen(charts.levels.at(0), dust.num_nodes(), dust.hexahedra()));
}

// Of one node alone, which is fixed: neither the free degrees of freedom nor the diagonal tell.
TEST(SpectralRadii, AreFoundAnewWhenJointsOpen) {
  MovingBody bar(Body(block({4, 4, 16}, 0.01), {{}}), {.gravity = {1, 0, -9}, .fixed = {0, 1, 2, 3, 4}},
                 std::make_unique<PreconditionedConjugateGradients>(1e-2, 100, Preconditioner::kMultigrid));
  for (int step = 0; step < 2; ++step) bar.step();
  EXPECT_EQ(bar.solver_memory().radii.at(0).num_solves, 2);
  const std::array opened = {bar.body.joints().find(Joints::Face{0, 3})};
  EXPECT_EQ(bar.open(opened), std::vector<int>{1});
  bar.step();
  EXPECT_EQ(bar.solver_memory().radii.at(0).num_solves, 1);
}

// Halves are more slender than the whole. What is cut through to three quarters takes no more than they do.
TEST(SplitMesh, TakesAsManyIterationsAsItsHalvesWhereItIsStiff) {
  const HexMesh whole = block({10, 10, 24}, 0.01);
  const int of_half = iterations_of(block({5, 10, 24}, 0.01), 1e6, 1e-2);
  for (const int cut : {4, 5})
    for (const int count : {60, 120, 180, 240})
      EXPECT_LE(iterations_of(split(whole, first_faces(count, 0.01 * cut)), 1e6, 1e-2), of_half + 2)
          << count << " faces at " << cut;
}

}  // namespace
}  // namespace hexaplast
