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
    boolean("animate", {.initial = "false", .access = Access::kIgnored}, "Ignored here."),
    ignored_attributes("Ignored here: every node takes part in every step.", "sleeping", "canChangeSleepingState"),
    ignored_attribute("depend", "Ignored here: nodes are in the order of the scene."),
    visual_attributes("showBoundingTree", "showBoundingCollisionModels", "showBehaviorModels", "showCollisionModels",
                      "showMappings", "showMechanicalMappings", "showForceFields", "showInteractionForceFields",
                      "showVisualModels", "showWireFrame", "showWireframe", "showNormals"),
};

inline constexpr Table kRequiredPlugin{
    Category{"Settings"}(
        "RequiredPlugin",
        "Loads plugins by name. Names that begin with Sofa. are modules of SOFA, and are not loaded here."),
    free_text("pluginName", "Names of plugins, separated by blanks; default: `name`."),
    ignored_attribute("suffixMap", "Ignored here: a plugin is found by its name alone."),
    ignored_attribute("stopAfterFirstNameFound", "Ignored here: all names are loaded."),
    ignored_attribute("stopAfterFirstSuffixFound", "Ignored here: a plugin is found by its name alone."),
    ignored_attributes("Ignored here: all names are required.", "requireOne", "requireAll"),
};

inline constexpr Table kDefaultAnimationLoop{
    Category{"AnimationLoop"}("DefaultAnimationLoop",
                              "The order of events of a time step. A root without animation loop gets this one."),
    ignored_attribute("parallelODESolving", "Ignored here: solvers run one after another."),
    ignored_attribute("computeBoundingBox", "Visual: ignored here."),
};

}  // namespace hexaplast::attributes
