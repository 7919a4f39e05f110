// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Boxes within boxes: finds those near a point without looking at all of them.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) {
    std::vector<int> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    branches_.reserve(2 * boxes.size());
    grow(boxes, order);
  }

  /// Calls visit(e) for boxes e in about the order of their distance from the point, as long as they are nearer than
  /// what visit returned last, at first `reach`.
  template <class Visit>
  void for_each_nearer(const Vec3& point, const Visit& visit,
                       double reach = std::numeric_limits<double>::infinity()) const {
    descend(0, point, reach, visit);
  }

  /// Calls visit(e) for boxes e that a ray meets nearer to its origin than what visit returned last, at first `reach`,
  /// in multiples of the direction's length.
  template <class Visit>
  void for_each_along(const Vec3& origin, const Vec3& direction, const Visit& visit,
                      double reach = std::numeric_limits<double>::infinity()) const {
    descend_along(0, origin, direction, reach, visit);
  }

 private:
  struct Branch {
    Eigen::AlignedBox3d box;
    int item = -1;    // of a leaf
    int second = -1;  // the first child follows its parent
  };

  void grow(const std::vector<Eigen::AlignedBox3d>& boxes, std::span<int> items) {
    const std::size_t at = branches_.size();
    Branch& branch = branches_.emplace_back();
    Eigen::AlignedBox3d centres;
    for (const int e : items) {
      branch.box.extend(boxes[e]);
      centres.extend(boxes[e].center());
    }
    if (items.size() == 1) {
      branch.item = items[0];
      return;
    }
    Eigen::Index axis = 0;
    centres.sizes().maxCoeff(&axis);
    const std::size_t half = items.size() / 2;
    std::ranges::nth_element(items, items.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](int e) { return std::pair(boxes[e].center()[axis], e); });
    grow(boxes, items.first(half));
    branches_[at].second = static_cast<int>(branches_.size());
    grow(boxes, items.subspan(half));
  }

  template <class Visit>
  void descend(int at, const Vec3& point, double& reach, const Visit& visit) const {
    const Branch& branch = branches_[at];
    if (branch.item >= 0) {
      reach = visit(branch.item);
      return;
    }
    std::array<std::pair<double, int>, 2> children{};
    for (int k = 0; k < 2; ++k) {
      const int child = k == 0 ? at + 1 : branch.second;
      children[k] = {branches_[child].box.squaredExteriorDistance(point), child};
    }
    if (children[1].first < children[0].first) std::swap(children[0], children[1]);
    for (const auto& [distance_squared, child] : children)
      if (distance_squared < reach * reach) descend(child, point, reach, visit);
  }

  /// Where a ray enters a box; infinite where it does not. Rounding must not let it pass between two boxes.
  static double entry(const Eigen::AlignedBox3d& box, const Vec3& origin, const Vec3& direction) {
    constexpr double kRounding = 1e-9;
    const Vec3 margin = Vec3::Constant(kRounding * box.sizes().norm());
    const Vec3 low = box.min() - margin - origin, high = box.max() + margin - origin;
    double first = 0, last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      if (direction[i] == 0) {
        if (low[i] > 0 || high[i] < 0) return std::numeric_limits<double>::infinity();
        continue;
      }
      const double a = low[i] / direction[i], b = high[i] / direction[i];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
    return first <= last ? first : std::numeric_limits<double>::infinity();
  }

  template <class Visit>
  void descend_along(int at, const Vec3& origin, const Vec3& direction, double& reach, const Visit& visit) const {
    const Branch& branch = branches_[at];
    if (!(entry(branch.box, origin, direction) < reach)) return;
    if (branch.item >= 0) {
      reach = visit(branch.item);
      return;
    }
    descend_along(at + 1, origin, direction, reach, visit);
    descend_along(branch.second, origin, direction, reach, visit);
  }

  std::vector<Branch> branches_;
};

}  // namespace hexaplast
