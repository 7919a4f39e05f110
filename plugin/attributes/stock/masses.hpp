// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Masses. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMassRayleigh =
    real("rayleighMass", {.initial = "0", .unit = "1/s", .range = kNotNegative},
         "Damping by this mass in the system matrix alone, besides the solver's own.");

inline constexpr Attribute kSeparateGravity = one_of("separateGravity", {.initial = "false", .words = "false 0"},
                                                     "Only false here: gravity is one of the forces.");

inline constexpr std::array kUniformMassAttributes = {
    real("totalMass", {.unit = "kg", .range = kPositive}, "Divided equally among all nodes."),
    real("vertexMass", {.unit = "kg", .range = kPositive}, "Of each node, unless totalMass is given."),
    kMassRayleigh,
    kSeparateGravity,
    ignored_attribute("preserveTotalMass", "Ignored here: nodes stay when hexahedra tear."),
    visual_attribute("showGravityCenter"),
    visual_attribute("showAxisSizeFactor"),
};
inline constexpr Description kUniformMass = mass("UniformMass", "The same mass at every node.", kUniformMassAttributes);

inline constexpr Attribute kMassTopology = link("topology", "The hexahedra; default: the nearest topology.");

inline constexpr std::array kDiagonalMassAttributes = {
    real("totalMass", {.unit = "kg", .range = kPositive},
         "Of the whole body, spread by volume. Counts before massDensity, and that before vertexMass; 1 kg if none is "
         "given."),
    real("massDensity", {.unit = "kg/m^3", .range = kPositive}, "Mass per volume at rest."),
    reals("vertexMass", {.unit = "kg", .range = kNotNegative}, "One value for all nodes, or one per node."),
    boolean("computeMassOnRest", {.initial = "true"},
            "Whether volumes are those of the rest positions or of the first positions."),
    kMassRayleigh,
    kSeparateGravity,
    kMassTopology,
    ignored_attribute("geometryState", "Ignored here: the nodes are those of the mechanical state."),
    visual_attribute("showGravityCenter"),
    visual_attribute("showAxisSizeFactor"),
};
inline constexpr Description kDiagonalMass =
    mass("DiagonalMass", "Each hexahedron gives an eighth of its mass to each of its nodes.", kDiagonalMassAttributes);

}  // namespace hexaplast::attributes
