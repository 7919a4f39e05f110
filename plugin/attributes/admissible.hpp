// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "attributes/attribute.hpp"

namespace hexaplast::attributes {

/// "must be > 0", "must lie in [0, 0.5)"; empty when every number is admissible.
std::string describe(const Range& range);

/// "-1 must be > 0": what is wrong with a number that a range does not contain.
std::string inadmissible(const Range& range, double number);
std::string inadmissible(const Range& range, long number);

}  // namespace hexaplast::attributes
