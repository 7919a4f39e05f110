// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace hexaplast {

/// The instruction set that the kernels use: the best of those that both this build and this machine have. Results of
/// different sets differ in the last bits. Throws InputError where there is none, as all of the following do.
std::string simd_target();

/// All sets that could be used here within the restriction of set_simd_target, best first.
std::vector<std::string> simd_targets();

/// Restricts the kernels to one set; "" chooses again. Throws InputError for a set that simd_targets() does not name.
/// For tests and measurements: bodies built before keep the layout that suits the set they were built with.
void set_simd_target(const std::string& name);

/// Whether the set in use converts 16-bit floating point numbers.
bool simd_has_half();

}  // namespace hexaplast
