// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Lists of values that are made from others. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr std::array kIndexValueMapperAttributes = {
    reals("inputValues", "The values before; there may be none."),
    integers("indices", {.range = {.min = 0, .max = 9999999}},
             "Places in the list that get `value`. The list grows as far as they reach."),
    real("value", {.initial = "0"}, "What stands at these places."),
    real("defaultValue", {.initial = "1"}, "What stands at the other places that the list has gained."),
    output(reals("outputValues", "The values after.")),
};
inline constexpr Description kIndexValueMapper =
    engine("IndexValueMapper", "Gives some entries of a list another value.", kIndexValueMapperAttributes);

inline constexpr std::array kIndicesFromValuesAttributes = {
    reals("values", "What is looked for."),
    reals("global", "The list in which it is looked for."),
    boolean("recursiveSearch", {.initial = "false"},
            "true: all places of each value, ascending; otherwise the first one. A value that is not there gives a "
            "warning."),
    output(integers("indices", "Places of the values.")),
    output(integers("otherIndices", "The other places.")),
};
inline constexpr Description kIndicesFromValues{.class_name = "IndicesFromValues",
                                                .category = "Engine",
                                                .help = "Finds the places of values in a list: hexahedra with a label.",
                                                .templates = "d f i I",
                                                .attributes = kIndicesFromValuesAttributes};

}  // namespace hexaplast::attributes
