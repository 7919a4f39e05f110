// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hexaplast/material/material.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "support/golden.hpp"

namespace hexaplast::support {

/// Tip deflection of a clamped 1 x 0.1 x 0.1 m beam under a small force even over its end, relative to Timoshenko's
/// beam. shares: of the nodes at the end in the force, by their numbers in ascending order.
double relative_deflection(const HexMesh& mesh, std::span<const double> weights, double poisson_ratio,
                           const Settings& settings);

/// The beam of cubes (20 x 2 x 2), or one of those of tests/data/calculix/locking_meshes.json.
struct BeamMesh {
  HexMesh mesh;
  std::vector<double> weights;
  Json reference;  ///< C3D8, C3D8I and C3D20R: relative deflections at Poisson's ratio 0, .3, .45, .49, .499
};
BeamMesh beam_mesh(const std::string& name);

}  // namespace hexaplast::support
