// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// In scenes: TangentialForceField.
struct TangentialLoadOptions {
  std::vector<int> indices = {};    ///< nodes, group after group
  int group_size = 1;               ///< consecutive indices that form a group
  Vec3 axis = Vec3::UnitZ();        ///< of any length
  Vec3 centre = Vec3::Zero();       ///< [m] a point on the axis
  std::vector<double> times = {};   ///< [s] ascending
  std::vector<double> forces = {};  ///< [N] on each group at each key time

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(indices);
    HEXAPLAST_OPTION(group_size);
    HEXAPLAST_OPTION(axis);
    HEXAPLAST_OPTION(centre);
    HEXAPLAST_OPTION(times);
    HEXAPLAST_OPTION(forces);
  }
};

/// Forces around an axis that turn with the body (add_tangential_forces), changing linearly between key times: none
/// before the first one, the last force from the last one on.
class TangentialLoad {
 public:
  /// For fields of num_nodes x 3. Throws OptionError.
  TangentialLoad(TangentialLoadOptions options, int num_nodes);

  /// f += forces [N] at a time [s] and positions x [m].
  void add_force(double time, ConstPoints x, Points f) const;

  std::span<const int> nodes() const { return options_.indices; }

 private:
  TangentialLoadOptions options_;
};

}  // namespace hexaplast::parts
