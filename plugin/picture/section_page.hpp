// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/quantity.hpp"
#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Sections of a body across an axis, all of one scale, side by side: a body of length L is cut in the middle of each
/// of `count` parts of length L / count, and seen from the greater end of the axis.
struct SectionPage {
  std::string title, remark;  ///< upper left and upper right
  int axis = 2;               ///< 0, 1, 2
  Vec3 up = Vec3::UnitY();    ///< as far as it is not along the axis
  int count = 5;              ///< at least 1
  Quantity quantity = Quantity::kPlasticStrain;
  Regions regions;
  std::optional<std::pair<double, double>> range;  ///< of the colours; none: of what is shown
  bool shows_edges = true;                         ///< between hexahedra
  std::string ghost = "initial shape";             ///< name of the pale sections behind; empty: there are none
  int width = 1280, height = 720;                  ///< [pixels]

  /// positions: num_nodes x 3 [m]; values: of the quantity, one per hexahedron or per node; alive: one per hexahedron,
  /// 0 for those that are removed; behind: nodes of the pale shape [m], which is cut at the same parts of its own
  /// length.
  Drawing drawing(const HexMesh& mesh, ConstPoints positions, const std::vector<double>& values,
                  std::span<const unsigned char> alive, ConstPoints behind) const;
};

}  // namespace hexaplast::output
