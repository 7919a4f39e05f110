// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "attributes/attribute.hpp"

namespace hexaplast::attributes {

/// The core's rows of Material and Settings as attributes of a component, group by group.
std::span<const Attribute> body_attributes();

/// The core's rows of Material as attributes of a region of a body: none has a default.
std::span<const Attribute> region_attributes();

/// The attributes of one table, then those of another.
std::vector<Attribute> joined(std::span<const Attribute> first, std::span<const Attribute> then);

}  // namespace hexaplast::attributes
