// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// How the eight samples of an element follow from its corners.
struct Sampling {
  /// The part of the strain that is linear in a coordinate is assumed to be tangential to the faces of that coordinate,
  /// whatever the corners say.                                                                 theory.md section 2.1
  bool assumes_strain = false;
  double corner_weight = 0.5;  ///< [-] of the corner's gradient in that of its sample; the rest is the same in all
  bool of_the_centre = false;  ///< corner_weight = 0, and what all have in common is the gradient at the centre

  /// What of the difference of a sample's plastic increment from the mean of the eight goes into the rest shape:
  /// samples of corner_weight 1/2 show as much of a mode in which the element bends as their corners move by, others 2
  /// corner_weight of it.
  constexpr double increment_weight() const { return assumes_strain ? 1 / (2 * corner_weight) : 1; }  // eq. 27
};

constexpr Sampling sampling_of(const Settings& settings) {
  constexpr double kFullIntegration = 0.57735026918962576451;  // on parallelepipeds: the samples of 2 x 2 x 2 points
  switch (settings.bending) {
    case Bending::kAssumedCorner:
      return {.assumes_strain = true, .corner_weight = kFullIntegration};
    case Bending::kVertex:
      return {.corner_weight = 1};
    case Bending::kCentre:
      return {.corner_weight = 0, .of_the_centre = true};
    case Bending::kBlended:
      break;
  }
  return {.corner_weight = settings.blend_weight};
}

}  // namespace hexaplast
