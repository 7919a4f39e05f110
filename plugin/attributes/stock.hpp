// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/constraints.hpp"
#include "attributes/stock/geometry.hpp"
#include "attributes/stock/ignored.hpp"
#include "attributes/stock/loads.hpp"
#include "attributes/stock/mappings.hpp"
#include "attributes/stock/masses.hpp"
#include "attributes/stock/regions.hpp"
#include "attributes/stock/solvers.hpp"
#include "attributes/stock/springs.hpp"
#include "attributes/stock/values.hpp"
#include "attributes/stock/visuals.hpp"

/// SOFA's components as the embedded host knows them: names, defaults and meaning are SOFA's.
namespace hexaplast::attributes {

inline constexpr auto kNodeAttributes = joined(
    std::array{
        real("dt", {.initial = "0.01", .unit = "s", .range = kPositive}, "Time step; that of the root counts."),
        vector3("gravity", {.initial = "0 -9.81 0", .unit = "m/s^2"},
                "Acceleration of every mass; that of the root counts."),
        real("time", {.initial = "0", .unit = "s", .range = {.min = 0, .max = 0}}, "Every run begins at 0."),
        boolean("animate", {.initial = "false", .access = Access::kIgnored}, "Ignored here."),
        ignored_attribute("sleeping", "Ignored here: every node takes part in every step."),
        ignored_attribute("canChangeSleepingState", "Ignored here: every node takes part in every step."),
        ignored_attribute("depend", "Ignored here: nodes are in the order of the scene."),
    },
    visual_attributes("showBoundingTree", "showBoundingCollisionModels", "showBehaviorModels", "showCollisionModels",
                      "showMappings", "showMechanicalMappings", "showForceFields", "showInteractionForceFields",
                      "showVisualModels", "showWireFrame", "showWireframe", "showNormals"));
inline constexpr Description kNode{.class_name = "Node",
                                   .category = "Node",
                                   .help = "Holds components and further nodes.",
                                   .attributes = kNodeAttributes};

inline constexpr std::array kRequiredPluginAttributes = {
    free_text("pluginName", "Names of plugins, separated by blanks; default: `name`."),
    ignored_attribute("suffixMap", "Ignored here: a plugin is found by its name alone."),
    ignored_attribute("stopAfterFirstNameFound", "Ignored here: all names are loaded."),
    ignored_attribute("stopAfterFirstSuffixFound", "Ignored here: a plugin is found by its name alone."),
    ignored_attribute("requireOne", "Ignored here: all names are required."),
    ignored_attribute("requireAll", "Ignored here: all names are required."),
};
inline constexpr Description kRequiredPlugin{
    .class_name = "RequiredPlugin",
    .category = "Settings",
    .help = "Loads plugins by name. Names that begin with Sofa. are modules of SOFA, and are not loaded here.",
    .attributes = kRequiredPluginAttributes};

inline constexpr std::array kDefaultAnimationLoopAttributes = {
    ignored_attribute("parallelODESolving", "Ignored here: solvers run one after another."),
    ignored_attribute("computeBoundingBox", "Visual: ignored here."),
};
inline constexpr Description kDefaultAnimationLoop{
    .class_name = "DefaultAnimationLoop",
    .category = "AnimationLoop",
    .help = "The order of events of a time step. A root without animation loop gets this one.",
    .attributes = kDefaultAnimationLoopAttributes};

}  // namespace hexaplast::attributes
