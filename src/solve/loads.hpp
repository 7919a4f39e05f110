// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Place of a time within ascending key times: `fraction` [0, 1) of the way from `key` to the next one.
struct KeyPhase {
  int key = -1;         ///< -1: before the first key time
  double fraction = 0;  ///< 0 from the last key time on, where `key` is the last one
};

KeyPhase phase_at(std::span<const double> times, double time);

/// The value, or the row, at a phase: linear between two keys, the last one from the last key time on. Throws
/// InputError for a key that is not there, as before the first key time.
double interpolate(const KeyPhase& at, std::span<const double> values);
Eigen::RowVector3d interpolate(const KeyPhase& at, ConstPoints rows);

/// Slope of the line between two keys. Throws InputError for a key that is not there, or has no next one.
Eigen::RowVector3d slope(const KeyPhase& at, std::span<const double> times, ConstPoints rows);

/// f += forces around an axis that turn with the body. The nodes form consecutive groups of `group_size`; for each
/// group
///
///   p = mean of x over the group,   t = axis x (p - centre) / |axis x (p - centre)|
///
/// and every node of it receives force / group_size along t. `force` [N] acts on each group. There is no stiffness
/// term. Throws InputError for nodes that x has not or an f of another size, NumericalError for a group whose p lies on
/// the axis, where no tangent exists.
void add_tangential_forces(std::span<const int> nodes, int group_size, const Vec3& axis, const Vec3& centre,
                           double force, ConstPoints x, Points f);

}  // namespace hexaplast
