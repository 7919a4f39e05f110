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
inline constexpr Description kIndexValueMapper{.class_name = "IndexValueMapper",
                                               .category = "Engine",
                                               .help = "Gives some entries of a list another value.",
                                               .templates = kVec3Templates,
                                               .attributes = kIndexValueMapperAttributes};

inline constexpr Attribute kIndicesFromValuesAttributes[] = {
    {.name = "values", .type = Type::kReals, .help = "What is looked for."},
    {.name = "global", .type = Type::kReals, .help = "The list in which it is looked for."},
    {.name = "recursiveSearch",
     .type = Type::kBool,
     .initial = "false",
     .help = "true: all places of each value, ascending; otherwise the first one. A value that is not there gives a "
             "warning."},
    {.name = "indices", .type = Type::kIntegers, .access = Access::kOutput, .help = "Places of the values."},
    {.name = "otherIndices", .type = Type::kIntegers, .access = Access::kOutput, .help = "The other places."},
};
inline constexpr Description kIndicesFromValues{.class_name = "IndicesFromValues",
                                                .category = "Engine",
                                                .help = "Finds the places of values in a list: hexahedra with a label.",
                                                .templates = "d f i I",
                                                .attributes = kIndicesFromValuesAttributes};

}  // namespace hexaplast::attributes
