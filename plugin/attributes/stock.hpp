// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"
#include "attributes/stock/mechanics.hpp"
#include "attributes/stock/meshes.hpp"

/// SOFA's components as the embedded host knows them: names, defaults and meaning are SOFA's.
namespace hexaplast::attributes {

inline constexpr Table kNode{
    Category{"Node"}("Node", "Holds components and further nodes."),
    real("dt", {.initial = "0.01", .unit = "s", .range = kPositive}, "Time step; that of the root counts."),
    vector3("gravity", {.initial = "0 -9.81 0", .unit = "m/s^2"},
            "Acceleration of every mass; that of the root counts."),
    real("time", {.initial = "0", .unit = "s", .range = {.min = 0, .max = 0}}, "Every run begins at 0."),
};

inline constexpr Table kRequiredPlugin{
    Category{"Settings"}(
        "RequiredPlugin",
        "Loads plugins by name. Names that begin with Sofa. are modules of SOFA, and are not loaded here."),
    free_text("pluginName", "Names of plugins, separated by blanks; default: `name`."),
};

inline constexpr Description kDefaultAnimationLoop = Category{"AnimationLoop"}(
    "DefaultAnimationLoop", "The order of events of a time step. A root without animation loop gets this one.");

}  // namespace hexaplast::attributes
