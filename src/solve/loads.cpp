// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/loads.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

KeyPhase phase_at(std::span<const double> times, double time) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  const int key = static_cast<int>(next - times.begin()) - 1;
  if (key < 0 || next == times.end()) return {.key = key, .fraction = 0};
  return {.key = key, .fraction = (time - times[key]) / (times[key + 1] - times[key])};
}

double interpolate(const KeyPhase& at, std::span<const double> values) {
  const double from = values[at.key];
  return at.fraction == 0 ? from : from + at.fraction * (values[at.key + 1] - from);
}

Eigen::RowVector3d interpolate(const KeyPhase& at, ConstPoints rows) {
  const Eigen::RowVector3d from = rows.row(at.key);
  if (at.fraction == 0) return from;
  return from + at.fraction * (rows.row(at.key + 1) - from);
}

Eigen::RowVector3d slope(const KeyPhase& at, std::span<const double> times, ConstPoints rows) {
  return (rows.row(at.key + 1) - rows.row(at.key)) / (times[at.key + 1] - times[at.key]);
}

void add_tangential_forces(std::span<const int> nodes, int group_size, const Vec3& axis, const Vec3& centre,
                           double force, ConstPoints x, Points f) {
  for (std::size_t first = 0; first + group_size <= nodes.size(); first += group_size) {
    const std::span<const int> group = nodes.subspan(first, group_size);
    Vec3 p = Vec3::Zero();
    for (const int node : group) p += x.row(node).transpose();
    p /= group_size;

    const Vec3 direction = axis.cross(p - centre);
    if (!(direction.norm() > 0))
      throw NumericalError(fmt::format("a tangential force has no direction: its node {} lies on the axis", group[0]));
    const Vec3 share = force / group_size * direction.normalized();
    for (const int node : group) f.row(node) += share.transpose();
  }
}

}  // namespace hexaplast
