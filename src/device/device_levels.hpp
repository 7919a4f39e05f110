// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "device/bricks.hpp"
#include "layout/coarse_mesh.hpp"

namespace hexaplast {

/// The meshes of multigrid below a body's, laid out for a device.
class DeviceLevels {
 public:
  DeviceLevels(const Model& model, const History& history, const Bricks& finest);

  int count() const { return static_cast<int>(levels_.size()); }
  int num_nodes(int level) const { return levels_[level].at.num_nodes(); }
  std::vector<LevelArrays> arrays() const;

 private:
  struct Level {
    BrickLayout at;
    std::vector<float> rest, moduli;
    std::vector<int> child, fine_node;
    NodalMap placement, restriction, prolongation;
  };
  std::vector<Level> levels_;  // from fine to coarse
};

}  // namespace hexaplast
