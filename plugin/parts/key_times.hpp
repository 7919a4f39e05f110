// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace hexaplast::parts {

/// Whether a moment has come at `time`, a sum of time steps: rounding of that sum makes nothing late. Both [s].
bool has_come(double moment, double time);

/// How many of the ascending key times have come.
std::ptrdiff_t num_come(std::span<const double> times, double time);

/// Checks the key times of a history, which has one of the option `values` for each of them. Throws OptionError when
/// there are none, when they do not ascend, or when `num_values` is another number.
void check_key_times(std::string_view option, std::span<const double> times, std::string_view values,
                     std::size_t num_values);

}  // namespace hexaplast::parts
