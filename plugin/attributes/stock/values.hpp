// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Lists of values that are made from others. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kIndexValueMapperAttributes[] = {
    {.name = "inputValues", .type = Type::kReals, .help = "The values before; there may be none."},
    {.name = "indices",
     .type = Type::kIntegers,
     .range = {.min = 0, .max = 9999999},
     .help = "Places in the list that get `value`. The list grows as far as they reach."},
    {.name = "value", .type = Type::kReal, .initial = "0", .help = "What stands at these places."},
    {.name = "defaultValue",
     .type = Type::kReal,
     .initial = "1",
     .help = "What stands at the other places that the list has gained."},
    {.name = "outputValues", .type = Type::kReals, .access = Access::kOutput, .help = "The values after."},
};
inline constexpr Description kIndexValueMapper{
    .class_name = "IndexValueMapper",
    .category = "Engine",
    .help = "Gives some values of a list another value: of chosen hexahedra, for one.",
    .templates = kVec3Templates,
    .attributes = kIndexValueMapperAttributes};

}  // namespace hexaplast::attributes
