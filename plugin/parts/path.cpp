// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/path.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "parts/key_times.hpp"
#include "solve/loads.hpp"

namespace hexaplast::parts {

void check_path(OptionErrors& errors, std::span<const double> key_times, ConstPoints positions,
                std::span<const double> orientations) {
  errors.collect(
      [&] { check_key_times("key_times", key_times, "positions", static_cast<std::size_t>(positions.rows())); });
  if (orientations.empty()) return;
  if (orientations.size() != 4 * key_times.size()) {
    errors.add({"orientations", fmt::format("{} numbers given, must be a quaternion (4) for each of {} key times",
                                            orientations.size(), key_times.size())});
    return;
  }
  for (std::size_t k = 0; k < key_times.size(); ++k)
    if (!(Eigen::Vector4d::Map(&orientations[4 * k]).norm() > 0))
      errors.add({"orientations", fmt::format("quaternion {} is 0 0 0 0, must have a length", k)});
}

Pose pose_on_path(std::span<const double> key_times, ConstPoints positions, std::span<const double> orientations,
                  double time) {
  const KeyPhase phase = phase_at(key_times, std::max(time, key_times.front()));
  Pose pose{.position = interpolate(phase, positions).transpose()};
  if (orientations.empty()) return pose;
  const auto orientation_of = [&](int key) {
    return Eigen::Quaterniond(Eigen::Vector4d::Map(&orientations[4 * static_cast<std::size_t>(key)])
                                  .normalized());  // x y z w, as SOFA writes them
  };
  const int next = std::min(phase.key + 1, static_cast<int>(key_times.size()) - 1);
  pose.orientation = orientation_of(phase.key).slerp(phase.fraction, orientation_of(next));
  return pose;
}

}  // namespace hexaplast::parts
