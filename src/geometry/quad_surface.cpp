// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/quad_surface.hpp"

#include <algorithm>
#include <numeric>

#include "mesh/offenders.hpp"

namespace hexaplast {
namespace {

constexpr double kSamePlace = 1e-9;       // of the extent: vertices this close are one that was written twice
constexpr double kFlatQuadCorner = 1e-3;  // sine of the angle at a corner, seen along the normal of the quad

/// Marks every vertex of which another one lies at the same place.
Offenders coincident(const PointArray& x) {
  const Vec3 extent = (x.colwise().maxCoeff() - x.colwise().minCoeff()).transpose();
  const double reach = kSamePlace * extent.norm();
  // along a direction that no mesh is aligned with, few other vertices are as near as those at the same place
  const Eigen::VectorXd along = x * Vec3(0.5377, 0.6811, 0.4969).normalized();
  std::vector<int> order(static_cast<std::size_t>(x.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return along[a] < along[b]; });

  std::vector<bool> has_twin(order.size(), false);
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && along[order[j]] - along[order[i]] <= reach; ++j)
      if ((x.row(order[i]) - x.row(order[j])).norm() <= reach) has_twin[order[i]] = has_twin[order[j]] = true;

  Offenders found;
  for (std::size_t n = 0; n < has_twin.size(); ++n)
    if (has_twin[n]) found.add(static_cast<int>(n));
  return found;
}

}  // namespace

QuadSurface::QuadSurface(PointArray positions, std::vector<Quad> quads)
    : positions_(std::move(positions)), quads_(std::move(quads)) {
  if (quads_.empty()) throw InputError("a surface without quads: at least one needed");

  Offenders not_finite, out_of_range, repeated, unused;
  for (int n = 0; n < num_vertices(); ++n)
    if (!positions_.row(n).allFinite()) not_finite.add(n);
  not_finite.refuse("vertices with a coordinate that is not finite", "coordinates must be finite numbers");

  for (int q = 0; q < num_quads(); ++q) {
    const Quad vertices = sorted(quads_[q]);
    if (vertices.front() < 0 || vertices.back() >= num_vertices()) out_of_range.add(q);
    if (std::ranges::adjacent_find(vertices) != vertices.end()) repeated.add(q);
  }
  out_of_range.refuse("quads with a vertex out of range",
                      fmt::format("indices must lie in [0, {})", num_vertices()).c_str());
  repeated.refuse("quads that name a vertex twice", "the four corners must be distinct");

  first_.assign(num_vertices() + 1, 0);
  for (const Quad& quad : quads_)
    for (const int vertex : quad) ++first_[vertex + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  incidence_.resize(first_.back());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int q = 0; q < num_quads(); ++q)
    for (int k = 0; k < 4; ++k) incidence_[next[quads_[q][k]]++] = {q, k};

  for (int n = 0; n < num_vertices(); ++n)
    if (incident(n).empty()) unused.add(n);
  unused.refuse("vertices without a quad", "every vertex must belong to one");
  coincident(positions_).refuse("duplicate vertices", "quads that meet must share their vertices");
  check_edges();
  check_fans();
  check_shapes();
}

// An edge of a manifold belongs to two quads, which run through it in opposite directions, or to one on the boundary.
void QuadSurface::check_edges() {
  struct Side {
    int low, high, quad;
    bool ascends;
  };
  std::vector<Side> sides;
  sides.reserve(4 * quads_.size());
  for (int q = 0; q < num_quads(); ++q)
    for (int k = 0; k < 4; ++k) {
      const int a = quads_[q][k], b = quads_[q][(k + 1) % 4];
      sides.push_back({std::min(a, b), std::max(a, b), q, a < b});
    }
  const auto same_edge = [](const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; };
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.quad) < std::tie(b.low, b.high, b.quad);
  });

  std::vector<bool> meets_many(quads_.size(), false), is_turned(quads_.size(), false);
  for (std::size_t begin = 0, end; begin < sides.size(); begin = end) {
    for (end = begin + 1; end < sides.size() && same_edge(sides[begin], sides[end]);) ++end;
    is_closed_ = is_closed_ && end - begin == 2;
    for (std::size_t i = begin; i < end; ++i) {
      if (end - begin > 2) meets_many[sides[i].quad] = true;
      if (end - begin == 2 && sides[begin].ascends == sides[begin + 1].ascends) is_turned[sides[i].quad] = true;
    }
  }
  const auto marked = [](const std::vector<bool>& marks) {
    Offenders found;
    for (std::size_t q = 0; q < marks.size(); ++q)
      if (marks[q]) found.add(static_cast<int>(q));
    return found;
  };
  marked(meets_many).refuse("quads meet more than one other quad at an edge", "an edge may belong to two quads");
  marked(is_turned).refuse("quads have a neighbour of the other orientation",
                           "all quads must run counter-clockwise seen from one side");
}

// Around a vertex of a manifold, each quad leads to the next one across an edge, until the boundary or the first one.
void QuadSurface::check_fans() const {
  Offenders torn;
  for (int n = 0; n < num_vertices(); ++n) {
    const std::span<const Incidence> around = incident(n);
    const auto entered_from = [&](const Incidence& at) { return quads_[at.quad][(at.corner + 1) % 4]; };
    const auto left_to = [&](const Incidence& at) { return quads_[at.quad][(at.corner + 3) % 4]; };
    const auto quad_behind = [&](int neighbour) {
      return std::ranges::find_if(around, [&](const Incidence& at) { return entered_from(at) == neighbour; });
    };

    // an open fan begins with the quad that no other one leads to
    auto first = std::ranges::find_if(around, [&](const Incidence& at) {
      return std::ranges::none_of(around, [&](const Incidence& other) { return left_to(other) == entered_from(at); });
    });
    if (first == around.end()) first = around.begin();
    std::size_t length = 0;
    for (auto at = first; at != around.end();) {
      ++length;
      at = quad_behind(left_to(*at));
      if (at == first) break;
    }
    if (length < around.size()) torn.add(n);
  }
  torn.refuse("vertices join quads that share no edge there", "quads that meet must share an edge");
}

void QuadSurface::check_shapes() const {
  Offenders bad;
  for (int q = 0; q < num_quads(); ++q) {
    const Vec3 normal = (at(q, 2) - at(q, 0)).cross(at(q, 3) - at(q, 1)).normalized();
    bool is_sound = normal.allFinite();
    for (int k = 0; k < 4; ++k) {
      const Vec3 forward = at(q, k + 1) - at(q, k), back = at(q, k - 1) - at(q, k);
      is_sound = is_sound && forward.cross(back).dot(normal) > kFlatQuadCorner * forward.norm() * back.norm();
    }
    if (!is_sound) bad.add(q);
  }
  bad.refuse("quads that are flat, concave or twisted at a corner", "all four corners must be convex on the same side");
}

}  // namespace hexaplast
