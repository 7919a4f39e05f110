// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/embed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/finite.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "hexaplast/mesh/trilinear.hpp"

namespace hexaplast {
namespace {

constexpr double kInside = 1e-9;     // of a hexahedron's size: a point this near to it lies in it
constexpr int kMostIterations = 60;  // of Newton's method; inside a sound hexahedron it needs less than ten

Eigen::Matrix<double, kCorners, 1> shape_functions(const Vec3& s) {
  Eigen::Matrix<double, kCorners, 1> N;
  for (int a = 0; a < kCorners; ++a)
    N[a] = (1 + kCornerSign[a][0] * s[0]) * (1 + kCornerSign[a][1] * s[1]) * (1 + kCornerSign[a][2] * s[2]) / 8;
  return N;
}

/// The place of a hexahedron that is nearest to a point.
struct Place {
  Vec3 s = Vec3::Zero();  // in [-1, 1]^3
  double distance = std::numeric_limits<double>::infinity();
};

/// Newton's method on x(s) = p, held within the reference cube.
Place nearest_place(const ElementPoints& x, const Vec3& p, double size) {
  Place best;
  Vec3 s = Vec3::Zero();
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Vec3 gap = p - x.transpose() * shape_functions(s);
    if (gap.norm() < best.distance) best = {s, gap.norm()};
    if (best.distance <= 1e-15 * size) break;
    const Mat3 J = x.transpose() * shape_derivatives(s);
    const Vec3 next = (s + J.inverse() * gap).cwiseMin(1).cwiseMax(-1);
    if (!next.allFinite() || next == s) break;
    s = next;
  }
  return best;
}

Eigen::AlignedBox3d box_of(const ElementPoints& x) {
  return {Vec3(x.colwise().minCoeff().transpose()), Vec3(x.colwise().maxCoeff().transpose())};
}

/// Finds hexahedra near a place: a regular grid of bins, each with the hexahedra whose boxes touch it, ascending.
class Bins {
 public:
  explicit Bins(const std::vector<Eigen::AlignedBox3d>& boxes) {
    for (const auto& box : boxes) all_.extend(box);
    const double edge = std::cbrt(all_.sizes().prod() / static_cast<double>(boxes.size()));
    for (int d = 0; d < 3; ++d)
      count_[d] = std::clamp(static_cast<int>(all_.sizes()[d] / std::max(edge, 1e-300)), 1, kMostBins);
    content_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
    for (std::size_t e = 0; e < boxes.size(); ++e) {
      const auto least = bin_of(boxes[e].min()), most = bin_of(boxes[e].max());
      for (int k = least[2]; k <= most[2]; ++k)
        for (int j = least[1]; j <= most[1]; ++j)
          for (int i = least[0]; i <= most[0]; ++i) content_[index(i, j, k)].push_back(static_cast<int>(e));
    }
  }

  std::span<const int> at(const Vec3& point) const {
    const auto [i, j, k] = bin_of(point);
    return content_[index(i, j, k)];
  }

 private:
  static constexpr int kMostBins = 256;  // in each direction

  /// The bin of a point, or the one next to it where it lies outside.
  std::array<int, 3> bin_of(const Vec3& point) const {
    std::array<int, 3> bin;
    for (int d = 0; d < 3; ++d) {
      const double share = (point[d] - all_.min()[d]) / std::max(all_.sizes()[d], 1e-300);
      bin[d] = static_cast<int>(std::clamp(share * count_[d], 0.0, count_[d] - 1.0));
    }
    return bin;
  }
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(count_[0]) * (j + static_cast<std::size_t>(count_[1]) * k);
  }

  Eigen::AlignedBox3d all_;
  std::array<int, 3> count_{};
  std::vector<std::vector<int>> content_;
};

}  // namespace

Embedding::Embedding(ConstPoints x, std::span<const Hexahedron> hexahedra, ConstPoints points) {
  if (hexahedra.empty()) throw InputError("there is no hexahedron in which points could be embedded");
  require_finite(points, "embedded point");

  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Hexahedron& corners : hexahedra) boxes.push_back(box_of(gather(x, corners)));
  const Bins bins(boxes);
  const auto size_of = [&](int e) { return boxes[e].diagonal().norm(); };

  anchors_.reserve(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    const Vec3 p = points.row(n).transpose();
    int element = -1;
    Place place;
    const auto consider = [&](int e) {
      const Place found = nearest_place(gather(x, hexahedra[e]), p, size_of(e));
      if (found.distance >= place.distance) return;
      element = e;
      place = found;
    };
    const auto is_inside = [&] { return element >= 0 && place.distance <= kInside * size_of(element); };

    for (const int e : bins.at(p)) {
      if (boxes[e].exteriorDistance(p) <= kInside * size_of(e)) consider(e);
      if (is_inside()) break;
    }
    if (!is_inside()) {
      for (int e = 0; e < static_cast<int>(hexahedra.size()); ++e)
        if (boxes[e].exteriorDistance(p) < place.distance) consider(e);
      ++num_outside_;
      greatest_distance_ = std::max(greatest_distance_, place.distance);
    }

    // the weights of the nearest place, continued to the point itself
    const ElementPoints corners = gather(x, hexahedra[element]);
    const ElementPoints dN = shape_derivatives(place.s);
    const Eigen::Matrix<double, kCorners, 1> N = shape_functions(place.s);
    const Mat3 J = corners.transpose() * dN;
    const Eigen::Matrix<double, kCorners, 1> w = N + dN * (J.inverse() * (p - corners.transpose() * N));
    Anchor& anchor = anchors_.emplace_back(Anchor{hexahedra[element], {}});
    std::copy(w.begin(), w.end(), anchor.weight.begin());
  }
}

void Embedding::apply(ConstPoints nodes, Points points) const {
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (int a = 0; a < kCorners; ++a) sum += anchors_[i].weight[a] * nodes.row(anchors_[i].corners[a]);
    points.row(static_cast<Eigen::Index>(i)) = sum;
  }
}

void Embedding::add_transposed(ConstPoints points, Points nodes) const {
  for (std::size_t i = 0; i < anchors_.size(); ++i)
    for (int a = 0; a < kCorners; ++a)
      nodes.row(anchors_[i].corners[a]) += anchors_[i].weight[a] * points.row(static_cast<Eigen::Index>(i));
}

void Embedding::add_transposed_blocks(const BlockMatrix& B, BlockMatrix& A) const {
  for (int i = 0; i < B.num_nodes(); ++i) {
    const Anchor& row = anchors_[i];
    for (const auto& [j, block] : B.row(i)) {
      const Anchor& column = anchors_[j];
      for (int a = 0; a < kCorners; ++a)
        for (int b = 0; b < kCorners; ++b)
          A.add(row.corners[a], column.corners[b], row.weight[a] * column.weight[b] * block);
    }
  }
}

}  // namespace hexaplast
