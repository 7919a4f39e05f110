// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/embed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/require.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/nearest_place.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {
namespace {

constexpr double kInside = 1e-9;    // of a hexahedron's size: a point this near to it lies in it
constexpr double kNoWeight = 1e-8;  // a corner with no more does not carry a point: what kInside lets through

std::array<double, kCorners> weights_at(const ElementPoints& x, const Vec3& s, const Vec3& p) {
  const CornerWeights w = weights_beyond(x, s, p);
  std::array<double, kCorners> weight;
  std::copy(w.begin(), w.end(), weight.begin());
  return weight;
}

Eigen::AlignedBox3d box_of(const ElementPoints& x) {
  return {Vec3(x.colwise().minCoeff().transpose()), Vec3(x.colwise().maxCoeff().transpose())};
}

}  // namespace

Embedding::Embedding(ConstPoints x, std::span<const Hexahedron> hexahedra, ConstPoints points)
    : num_nodes_(x.rows()), num_hexahedra_(std::ssize(hexahedra)) {
  if (hexahedra.empty()) throw InputError("there is no hexahedron in which points could be embedded");
  for (const Hexahedron& corners : hexahedra) require_nodes("Embedding", corners, num_nodes_);
  require_finite(x, "position");
  require_finite(points, "embedded point");

  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(hexahedra.size());
  for (const Hexahedron& corners : hexahedra) boxes.push_back(box_of(gather(x, corners)));
  const BoxTree tree(boxes);

  const int count = static_cast<int>(points.rows());
  anchors_.resize(static_cast<std::size_t>(count));
  std::vector<double> distance(static_cast<std::size_t>(count),
                               0);  // of those outside
  parallel_for(count, [&](int n) {
    const Vec3 p = points.row(n).transpose();
    int element = -1;
    HexahedronPlace place;
    bool is_inside = false;
    tree.for_each_nearer(p, [&](int e) -> double {
      const double size = boxes[e].diagonal().norm();
      const HexahedronPlace found = nearest_place(gather(x, hexahedra[e]), p, size);
      if (found.distance < place.distance) {
        element = e;
        place = found;
        is_inside = found.distance <= kInside * size;
      }
      return is_inside ? 0 : place.distance;
    });
    if (!is_inside) distance[n] = place.distance;
    if (element < 0) return;  // so far away that distances are no numbers

    anchors_[n] = {element, hexahedra[element], weights_at(gather(x, hexahedra[element]), place.s, p)};
  });
  const auto lost = std::ranges::find(distance, std::numeric_limits<double>::infinity());
  if (lost != distance.end())
    throw InputError(fmt::format("embedded point {} lies too far from the hexahedra", lost - distance.begin()));
  num_outside_ = static_cast<int>(std::ranges::count_if(distance, [](double d) { return d > 0; }));
  if (num_outside_ > 0) greatest_distance_ = std::ranges::max(distance);
}

Embedding::Embedding(ConstPoints x, std::span<const Hexahedron> hexahedra, ConstPoints points,
                     std::span<const int> hexahedron_of_point)
    : num_nodes_(x.rows()), num_hexahedra_(std::ssize(hexahedra)) {
  for (const Hexahedron& corners : hexahedra) require_nodes("Embedding", corners, num_nodes_);
  require_finite(x, "position");
  require_finite(points, "embedded point");
  require_count("Embedding", "hexahedron_of_point", std::ssize(hexahedron_of_point), points.rows());
  for (std::size_t n = 0; n < hexahedron_of_point.size(); ++n) {
    const int e = hexahedron_of_point[n];
    if (e < 0 || e >= num_hexahedra_)
      throw InputError(fmt::format("Embedding: hexahedron {}, must lie in [0, {})", e, num_hexahedra_));
    const Vec3 p = points.row(static_cast<Eigen::Index>(n)).transpose();
    const ElementPoints at = gather(x, hexahedra[static_cast<std::size_t>(e)]);
    const HexahedronPlace place = nearest_place(at, p, box_of(at).diagonal().norm());
    anchors_.push_back({e, hexahedra[static_cast<std::size_t>(e)], weights_at(at, place.s, p)});
  }
}

bool Embedding::is_left(std::span<const int> cell,
                        const std::function<bool(std::span<const int> nodes)>& hold_together) const {
  std::vector<int> of_cell;
  for (const int point : cell) {
    const Anchor& anchor = anchors_[point];
    const std::size_t before = of_cell.size();
    for (int a = 0; a < kCorners; ++a)
      if (std::abs(anchor.weight[a]) > kNoWeight) of_cell.push_back(anchor.corners[a]);
    if (!hold_together(std::span(of_cell).subspan(before))) return false;
  }
  std::ranges::sort(of_cell);
  of_cell.erase(std::unique(of_cell.begin(), of_cell.end()), of_cell.end());
  return hold_together(of_cell);
}

void Embedding::follow(std::span<const Hexahedron> hexahedra, int num_nodes) {
  require_count("Embedding::follow", "hexahedra", std::ssize(hexahedra), num_hexahedra_);
  for (const Hexahedron& corners : hexahedra) require_nodes("Embedding::follow", corners, num_nodes);
  for (Anchor& anchor : anchors_) anchor.corners = hexahedra[static_cast<std::size_t>(anchor.hexahedron)];
  num_nodes_ = num_nodes;
}

void Embedding::apply(ConstPoints nodes, Points points) const {
  require_rows("Embedding::apply", "nodes", nodes, num_nodes_);
  require_rows("Embedding::apply", "points", points, num_points());
  parallel_for(num_points(), [&](int i) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (int a = 0; a < kCorners; ++a) sum += anchors_[i].weight[a] * nodes.row(anchors_[i].corners[a]);
    points.row(i) = sum;
  });
}

void Embedding::add_transposed(ConstPoints points, Points nodes) const {
  require_rows("Embedding::add_transposed", "points", points, num_points());
  require_rows("Embedding::add_transposed", "nodes", nodes, num_nodes_);
  for (std::size_t i = 0; i < anchors_.size(); ++i)
    for (int a = 0; a < kCorners; ++a)
      nodes.row(anchors_[i].corners[a]) += anchors_[i].weight[a] * points.row(static_cast<Eigen::Index>(i));
}

void Embedding::add_transposed_blocks(const BlockMatrix& B, BlockMatrix& A) const {
  require_count("Embedding::add_transposed_blocks", "B", B.num_nodes(), num_points());
  require_count("Embedding::add_transposed_blocks", "A", A.num_nodes(), num_nodes_);
  for (int i = 0; i < B.num_nodes(); ++i) {
    const Anchor& row = anchors_[i];
    for (const auto& [j, block] : B.row(i)) {
      const Anchor& column = anchors_[j];
      for (int a = 0; a < kCorners; ++a)
        for (int b = 0; b < kCorners; ++b)
          A.add(row.corners[a], column.corners[b], row.weight[a] * column.weight[b] * block);
    }
  }
  if (B.leaves_out()) A.leave_out();
}

}  // namespace hexaplast
