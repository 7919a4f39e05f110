// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "hexaplast/state/model.hpp"

namespace hexaplast {

/// Everything plastic; changes once per accepted time step, by flow() alone. A checkpoint saves exactly this.
struct History {
  using CornerValues = std::array<double, kCorners>;

  std::vector<ElementPoints> rest_shape;     ///< [m] y: isolated rest shape, about the element's own mean
  std::vector<Mat3> rotation_map;            ///< Pi: rest frame -> material frame, per element
  std::vector<CornerValues> yield_stress;    ///< [Pa] tau per element and corner; infinite where it never yields
  std::vector<CornerValues> rotation_yield;  ///< [rad] tau^R per element and corner
  PointArray material;                       ///< [m] x: the joined rest shape, num_nodes x 3; all that elasticity sees
  std::vector<CornerValues> plastic_strain;  ///< [-] accumulated sqrt(2/3) gamma |dev log D|_F per element and corner
  double dissipated_energy = 0;              ///< [J] accumulated plastic work
  long version = 0;  ///< grows whenever `material` changes, so that derived data know they are old

  /// The virgin state of a model: material = original positions.
  explicit History(const Model& model);
};

}  // namespace hexaplast
