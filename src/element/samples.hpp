// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/material/material.hpp"
#include "kinematics/polar.hpp"
#include "material/relaxation.hpp"

namespace hexaplast {

inline CornerTensors no_tensors() {
  CornerTensors tensors;
  tensors.fill(Mat3::Zero());
  return tensors;
}

/// The eight samples of one hexahedron.
struct ElementSamples {
  std::array<Mat3, kCorners> F;       ///< deformation gradients, of isolated rest shapes F^e       eq. 7, E11c, P1
  std::array<Polar, kCorners> polar;  ///< R, S of them                                                eq. 6
  std::array<Mat3, kCorners> stress;  ///< [Pa] sigma in the material frame              eq. 12, E3, E5, E15, E19
  double volume = 0;                  ///< [m^3] of the plastic rest shape; each sample carries an eighth of it
  double pressure = 0;                ///< [Pa] of the volume ratio, which is part of the stress
  double volume_ratio = 1;            ///< current volume over `volume`; 1 where nothing asks for it
  CornerTensors branch_stress = no_tensors();  ///< [Pa] part of the stress that viscoelastic branches hold
  double branch_moduli = 0;                    ///< [-] sum of their g
};

/// Adds to the samples of an element what its branches hold at the end of the step.                      eq. P7, P13
void add_branch_stress(const Branches& branches, const Lame& lame, ElementSamples& samples);

/// Corners [m]. plastic_inverse: the G_i of isolated rest shapes, null of joined ones; branches: of the element.
ElementSamples element_samples(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame,
                               const Settings& settings, const CornerTensors* plastic_inverse = nullptr,
                               const Branches& branches = {});

}  // namespace hexaplast
