// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/loads.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

namespace {

/// Whether there are `size` values for a phase to lie between.
void require_key(const char* call, const KeyPhase& at, std::ptrdiff_t size, bool needs_next) {
  if (at.key < 0 || at.key + (needs_next ? 1 : 0) >= size)
    throw InputError(
        fmt::format("{}: key {}{} must lie in [0, {})", call, at.key, needs_next ? " and the next" : "", size));
}

}  // namespace

KeyPhase phase_at(std::span<const double> times, double time) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  const int key = static_cast<int>(next - times.begin()) - 1;
  if (key < 0 || next == times.end()) return {.key = key, .fraction = 0};
  return {.key = key, .fraction = (time - times[key]) / (times[key + 1] - times[key])};
}

double interpolate(const KeyPhase& at, std::span<const double> values) {
  require_key("interpolate", at, std::ssize(values), at.fraction != 0);
  const double from = values[at.key];
  return at.fraction == 0 ? from : from + at.fraction * (values[at.key + 1] - from);
}

Eigen::RowVector3d interpolate(const KeyPhase& at, ConstPoints rows) {
  require_key("interpolate", at, rows.rows(), at.fraction != 0);
  const Eigen::RowVector3d from = rows.row(at.key);
  if (at.fraction == 0) return from;
  return from + at.fraction * (rows.row(at.key + 1) - from);
}

Eigen::RowVector3d slope(const KeyPhase& at, std::span<const double> times, ConstPoints rows) {
  require_key("slope", at, std::min<std::ptrdiff_t>(std::ssize(times), rows.rows()), true);
  return (rows.row(at.key + 1) - rows.row(at.key)) / (times[at.key + 1] - times[at.key]);
}

void add_tangential_forces(std::span<const int> nodes, int group_size, const Vec3& axis, const Vec3& centre,
                           double force, ConstPoints x, Points f) {
  if (group_size < 1)
    throw InputError(fmt::format("add_tangential_forces: group_size {} must be at least 1", group_size));
  require_nodes("add_tangential_forces", nodes, x.rows());
  require_rows("add_tangential_forces", "f", f, x.rows());
  for (std::size_t first = 0; first + group_size <= nodes.size(); first += group_size) {
    const std::span<const int> group = nodes.subspan(first, group_size);
    Vec3 p = Vec3::Zero();
    for (const int node : group) p += x.row(node).transpose();
    p /= group_size;

    const Vec3 direction = axis.cross(p - centre);
    if (!(direction.norm() > 0))
      throw NumericalError(fmt::format("a tangential force has no direction: its node {} lies on the axis", group[0]));
    const Vec3 part = force / group_size * direction.normalized();
    for (const int node : group) f.row(node) += part.transpose();
  }
}

}  // namespace hexaplast
