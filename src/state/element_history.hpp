// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "base/corner_tensors.hpp"

namespace hexaplast {

/// The plastic history of one element, by value.
struct ElementHistory {
  ElementPoints rest_shape;       ///< [m] y: isolated rest shape, about the element's own mean
  CornerTensors rotation_map;     ///< Pi: rest frame -> material frame; eight equal ones where the mode has one
  CornerValues yield_stress;      ///< [Pa] tau; infinite if it never yields
  CornerValues rotation_yield;    ///< [rad] tau^R
  CornerValues plastic_strain;    ///< [-] accumulated sqrt(2/3) gamma |dev log D|_F
  CornerTensors plastic_stretch;  ///< product of the S^p, in the rest frame; identity unless the model tracks it
  CornerTensors plastic_inverse;  ///< G = (F^p)^-1 of isolated rest shapes; identity elsewhere
};

}  // namespace hexaplast
