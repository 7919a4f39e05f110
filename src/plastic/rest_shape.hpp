// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// What happens to the isolated rest shape y of one element: eight rows about their own mean [m].  theory.md
/// section 5.3

inline constexpr double kVolumeAtRest = 1e-12;  ///< a relative volume error below is rounding

// lengths may not change more by restitution in one step, whatever beta
inline constexpr double kMinScale = 0.5, kGreatestScale = 2.0;

/// y_i <- Pi_i^T A_i Pi_i y_i, with one increment A_i = R^p_i S^p_i and one rotation map per corner; then the mean is
/// removed.                                                                                                   eq. 27
void deform_rest_shape(const std::array<Mat3, kCorners>& increments, const std::array<Mat3, kCorners>& rotation_maps,
                       ElementPoints& y);

/// Leads a nearly inverted shape back: y <- y + min(1, 5 dt) (R y0 - y), R the best rotation from y0 to y.    eq. 29
void repair_rest_shape(const ElementPoints& initial, double dt, ElementPoints& y);

/// y <- y (1 + c dt (1 - beta)), beta = plastic / initial volume; the factor stays within [1/2, 2], and y as it is
/// where beta is 1 but for rounding.                                                                          eq. 28
void restore_volume(double volume_ratio, double rate, double dt, ElementPoints& y);

/// The rotation R that minimises sum_i |R from_i - to_i|^2; both about their own means.
Mat3 fit_rotation(const ElementPoints& from, const ElementPoints& to);

/// The rows about their own mean.
inline ElementPoints about_mean(const ElementPoints& x) { return x.rowwise() - x.colwise().mean(); }

}  // namespace hexaplast
