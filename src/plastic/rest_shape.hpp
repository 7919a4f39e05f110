// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// What happens to the isolated rest shape y of one element: eight rows about their own mean [m].  theory.md
/// section 5.3

inline constexpr double kRepairRate = 5;  ///< [1/s] a jammed shape is back within a few tenths of a second

/// The rotation R that minimises sum_i |R from_i - to_i|^2; both about their own means.
Mat3 fit_rotation(const ElementPoints& from, const ElementPoints& to);

/// The rows about their own mean.
inline ElementPoints about_mean(const ElementPoints& x) { return x.rowwise() - x.colwise().mean(); }

}  // namespace hexaplast
