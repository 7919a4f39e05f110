// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "parts/force.hpp"
#include "parts/spread_nodes.hpp"

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
class TangentialLoad final : public Force {
 public:
  using Options = TangentialLoadOptions;
  static const attributes::Description& description();

  /// Both throw OptionError.
  TangentialLoad(TangentialLoadOptions options, const Surroundings& around);
  void set_options(TangentialLoadOptions options);

  void add_load(double time, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) const override;
  void nodes_changed(int state, const NodeCopies& copies, std::span<const int> split_from) override;
  bool is_in_matrix() const override { return false; }
  std::span<const int> loaded_nodes() const override { return loaded_; }

 private:
  void spread_nodes();

  int num_initial_;
  TangentialLoadOptions options_;
  const NodeCopies* copies_ = nullptr;  // null: no node has ever split
  SpreadNodes spread_;
  std::vector<int> loaded_;  // ascending
};

}  // namespace hexaplast::parts
