// SPDX-License-Identifier: LGPL-2.1-or-later
// Coarse meshes of meshes some nodes of which are split, and the iterations that multigrid takes with them.
#include <set>

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

Coarsening coarsened(const HexMesh& initial, const HexMesh& mesh) {
  const Charts charts(initial);
  return coarsen(charts.levels.at(0), mesh.num_nodes(), mesh.hexahedra()).value();
}

std::set<int> columns_of(const NodalMap& map, int row) {
  return {map.column.begin() + map.first[row], map.column.begin() + map.first[row + 1]};
}

/// Pieces of cells, or hexahedra, that nodes connect.
int num_pieces(const std::vector<Hexahedron>& cells, int num_nodes) {
  DisjointSets sets(num_nodes);
  std::set<int> roots;
  for (const Hexahedron& cell : cells)
    for (const int node : cell) sets.join(cell[0], node);
  for (const Hexahedron& cell : cells) roots.insert(sets.root(cell[0]));
  return static_cast<int>(roots.size());
}

/// Every element is in one cell; a node lies between the same coarse nodes in all cells that have it, and where linear
/// fields put it; what is one piece stays one, and no other becomes one.
void expect_sound(const HexMesh& mesh, const Coarsening& coarse) {
  std::vector<int> cell_of(mesh.num_elements(), -1);
  for (std::size_t c = 0; c < coarse.cells.size(); ++c) {
    for (const int child : coarse.children[c])
      if (child >= 0) {
        EXPECT_EQ(std::exchange(cell_of[child], static_cast<int>(c)), -1) << "element " << child;
      }
    const std::set<int> corners(coarse.cells[c].begin(), coarse.cells[c].end());
    EXPECT_EQ(corners.size(), 8U) << "cell " << c;
  }
  EXPECT_EQ(std::ranges::count(cell_of, -1), 0);
  PointArray place = PointArray::Zero(coarse.num_nodes, 3);
  for (int n = 0; n < coarse.num_nodes; ++n)
    for (int k = coarse.placement.first[n]; k < coarse.placement.first[n + 1]; ++k)
      place.row(n) += coarse.placement.weight[k] * mesh.positions().row(coarse.placement.column[k]);
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (mesh.incident(n).empty()) continue;
    const std::set<int> columns = columns_of(coarse.prolongation, n);
    for (const HexMesh::Incidence& at : mesh.incident(n)) {
      const Hexahedron& cell = coarse.cells[cell_of[at.element]];
      for (const int column : columns) EXPECT_EQ(std::ranges::count(cell, column), 1) << "node " << n;
    }
    Vec3 at = Vec3::Zero();
    for (int k = coarse.prolongation.first[n]; k < coarse.prolongation.first[n + 1]; ++k)
      at += coarse.prolongation.weight[k] * place.row(coarse.prolongation.column[k]).transpose();
    EXPECT_LE((at - mesh.positions().row(n).transpose()).norm(), 1e-6) << "node " << n;
  }
  EXPECT_EQ(num_pieces(coarse.cells, coarse.num_nodes), num_pieces(mesh.hexahedra(), mesh.num_nodes()));
}

TEST(SplitMesh, HalvesHaveTheCoarseMeshesOfHalves) {
  const HexMesh whole = block({8, 6, 6}, 0.1);
  for (const int cut : {4, 3}) {  // between cells, and through them
    const HexMesh mesh = split(whole, plane(0, 0.1 * cut));
    ASSERT_EQ(mesh.num_nodes(), whole.num_nodes() + 7 * 7);
    const Coarsening coarse = coarsened(whole, mesh);
    expect_sound(mesh, coarse);
    EXPECT_EQ(coarse.cells.size(), cut == 4 ? 4U * 3 * 3 : 5U * 3 * 3);
    EXPECT_EQ(coarse.num_nodes, cut == 4 ? (3 + 3) * 4 * 4 : (3 + 4) * 4 * 4);
  }
}

// A slit ends between cells or in the middle of them. It is as long on the coarse mesh, or a hexahedron shorter.
TEST(SplitMesh, LipsOfASlitShareNoCoarseNode) {
  const HexMesh whole = block({8, 8, 8}, 0.1);
  for (const int cut : {4, 3})
    for (const int depth : {4, 5}) {
      const HexMesh mesh = split(whole, plane(0, 0.1 * cut, [&](const Vec3& at) { return at.y() < 0.1 * depth; }));
      ASSERT_EQ(mesh.num_nodes(), whole.num_nodes() + depth * 9);
      const Coarsening coarse = coarsened(whole, mesh);
      expect_sound(mesh, coarse);
      EXPECT_EQ(coarse.num_nodes, 5 * 5 * 5 + (cut == 4 ? 2 : 4) * 5);
      const int coarse_depth = depth / 2 * 2;
      for (int n = whole.num_nodes(); n < mesh.num_nodes(); ++n) {
        const Vec3 at = mesh.positions().row(n);
        if (at.y() > 0.1 * (coarse_depth - 2) + 1e-9) continue;
        for (const int other : nodes_at(mesh, 0, at.x())) {
          if (other == n || (mesh.positions().row(other).transpose() - at).norm() > 1e-9) continue;
          for (const int column : columns_of(coarse.prolongation, n))
            EXPECT_EQ(columns_of(coarse.prolongation, other).count(column), 0U) << at.transpose();
        }
      }
    }
}

// A slit one cell deep, which the next coarser cells do not resolve, through cells that they have as children: these
// are there twice, in cells with the same corners.
TEST(SplitMesh, CellsTakeBothSidesOfAChildThatASlitDivides) {
  const HexMesh whole = block({16, 16, 12}, 0.1);
  const HexMesh mesh = split(whole, plane(0, 0.3, [](const Vec3& at) { return at.y() < 0.2; }));
  const Charts charts(whole);
  const auto of_whole = coarse_meshes(charts, whole, Partition(whole)),
             found = coarse_meshes(charts, mesh, Partition(mesh));
  ASSERT_EQ(found.size(), of_whole.size());
  EXPECT_EQ(found[0].partition->num_elements, of_whole[0].partition->num_elements + 6);
  EXPECT_EQ(found[0].partition->num_nodes, of_whole[0].partition->num_nodes + 2 * 7);
  EXPECT_EQ(found[1].partition->num_elements, of_whole[1].partition->num_elements + 3);
  EXPECT_EQ(found[1].partition->num_nodes, of_whole[1].partition->num_nodes);
}

// Two cuts that cross, one that ends at another, and a piece that is cut loose within.
TEST(SplitMesh, CoarsePiecesAreThoseOfTheMesh) {
  const HexMesh whole = block({10, 8, 8}, 0.1);
  const Opens first = plane(0, 0.5), second = plane(1, 0.3);
  const auto is_inside = [](const Vec3& at) { return ((at - Vec3(0.5, 0.4, 0.4)).array().abs() < 0.2).all(); };
  for (const Opens& opens :
       {Opens([&](const Vec3&a, const Vec3&b) { return first(a, b) || second(a, b); }),
        Opens([&](const Vec3&a, const Vec3&b) { return first(a, b) || (second(a, b) && a.x() < 0.5); }),
        Opens([&](const Vec3&a, const Vec3&b) { return is_inside(a) != is_inside(b); })}) {
    const HexMesh mesh = split(whole, opens);
    ASSERT_GT(mesh.num_nodes(), whole.num_nodes());
    expect_sound(mesh, coarsened(whole, mesh));
  }
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

TEST(SplitMesh, BlocksThatTouchShareCoarseNodesUntilTheyAreCut) {
  for (const bool at_edge : {true, false}) {
    const HexMesh whole = touching(at_edge);
    const Coarsening joined = coarsened(whole, whole);
    expect_sound(whole, joined);
    const HexMesh mesh = split(whole, plane(0, 0.4));
    ASSERT_EQ(mesh.num_nodes(), whole.num_nodes() + (at_edge ? 9 : 1));
    const Coarsening apart = coarsened(whole, mesh);
    expect_sound(mesh, apart);
    EXPECT_EQ(apart.num_nodes, joined.num_nodes + (at_edge ? 5 : 1));
    EXPECT_EQ(num_pieces(apart.cells, apart.num_nodes), num_pieces(joined.cells, joined.num_nodes) + 1);
  }
}

// Single hexahedra cut loose are not worth a cell each where they are many. The rest keeps its cells.
TEST(SplitMesh, CrumbsLeaveTheRestItsCoarseMeshes) {
  const HexMesh whole = block({12, 8, 8}, 0.1);
  const HexMesh mesh = split(whole, [](const Vec3& a, const Vec3& b) { return a.x() < 0.4 || b.x() < 0.4; });
  const Coarsening coarse = coarsened(whole, mesh);
  EXPECT_EQ(coarse.cells.size(), 4U * 4 * 4);
  EXPECT_EQ(coarse.num_nodes, 5 * 5 * 5);
  for (int n = 0; n < mesh.num_nodes(); ++n)
    EXPECT_EQ(columns_of(coarse.prolongation, n).empty(), centre(mesh, mesh.incident(n)[0].element).x() < 0.4);

  const HexMesh dust = split(whole, [](const Vec3&, const Vec3&) { return true; });
  EXPECT_FALSE(coarsen(Charts(whole).levels.at(0), dust.num_nodes(), dust.hexahedra()));
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

// Of tissue. Cuts lie between cells, and through them.
TEST(SplitMesh, TakesAsManyIterationsAsTheWhole) {
  const HexMesh whole = block({10, 10, 24}, 0.01);
  for (const double tolerance : {1e-2, 1e-6}) {
    const int of_whole = iterations_of(whole, 5000, tolerance);
    for (const int cut : {4, 5}) {
      for (const int count : {1, 100, 240})
        EXPECT_LE(iterations_of(split(whole, first_faces(count, 0.01 * cut)), 5000, tolerance), of_whole + 1)
            << count << " faces at " << cut << ", to " << tolerance;
      const auto nine_slits = [&](const Vec3& a, const Vec3& b) {
        const int between = static_cast<int>(std::lround(50 * (a.z() + b.z())));  // where the hexahedra differ in z
        return std::abs(a.z() - b.z()) > 0.005 && between >= cut && between <= cut + 16 && between % 2 == cut % 2 &&
               a.x() < 0.07;
      };
      EXPECT_LE(iterations_of(split(whole, nine_slits), 5000, tolerance), of_whole + 3)
          << "slits from " << cut << " on, to " << tolerance;
    }
  }
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
