// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>
#include <vector>

#include "scene/object.hpp"

namespace hexaplast::components {

/// The key times of a history, with one entry of the attribute `values` each. Rejects the scene when there are none,
/// when they do not ascend, or when `num_values` is another number.
std::vector<double> key_times(scene::Object& owner, std::string_view times, std::string_view values,
                              std::size_t num_values);

}  // namespace hexaplast::components
