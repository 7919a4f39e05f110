// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/kinematics/gradients.hpp"
#include "hexaplast/state/history.hpp"

namespace hexaplast {

/// Everything computed at one set of world positions, and at one material shape. May be thrown away at any time.
struct Linearization {
  std::vector<RestOperator> rest;                    ///< gradient operator of the material shape, per element
  long material_version = -1;                        ///< History::version that `rest` belongs to
  std::vector<std::array<Mat3, kCorners>> rotation;  ///< R of F = R S per element and sample
  std::vector<ElementPoints> corner_force;           ///< [N] elastic force per element and corner
};

}  // namespace hexaplast
