// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Masses. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMassRayleigh{
    .name = "rayleighMass",
    .type = Type::kReal,
    .initial = "0",
    .unit = "1/s",
    .range = kNotNegative,
    .help = "Damping by this mass in the system matrix alone, besides the solver's own."};

inline constexpr Attribute kSeparateGravity{.name = "separateGravity",
                                            .type = Type::kWord,
                                            .initial = "false",
                                            .words = "false 0",
                                            .help = "Only false here: gravity is one of the forces."};

inline constexpr Attribute kUniformMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Divided equally among all nodes."},
    {.name = "vertexMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Of each node, unless totalMass is given."},
    kMassRayleigh,
    kSeparateGravity,
    ignored_attribute("preserveTotalMass", "Ignored here: nodes stay when hexahedra tear."),
    visual_attribute("showGravityCenter"),
    visual_attribute("showAxisSizeFactor"),
};
inline constexpr Description kUniformMass{.class_name = "UniformMass",
                                          .category = "Mass",
                                          .help = "The same mass at every node.",
                                          .templates = "Vec3 Vec3d Vec3,double Vec3d,double Vec3,Vec3",
                                          .attributes = kUniformMassAttributes};

inline constexpr Attribute kMassTopology{
    .name = "topology", .type = Type::kLink, .help = "The hexahedra; default: the nearest topology."};

inline constexpr Attribute kDiagonalMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Of the whole body, spread by volume. Counts before massDensity, and that before vertexMass; 1 kg if none "
             "is given."},
    {.name = "massDensity",
     .type = Type::kReal,
     .unit = "kg/m^3",
     .range = kPositive,
     .help = "Mass per volume at rest."},
    {.name = "vertexMass",
     .type = Type::kReals,
     .unit = "kg",
     .range = kNotNegative,
     .help = "One value for all nodes, or one per node."},
    {.name = "computeMassOnRest",
     .type = Type::kBool,
     .initial = "true",
     .help = "Whether volumes are those of the rest positions or of the first positions."},
    kMassRayleigh,
    kSeparateGravity,
    kMassTopology,
    ignored_attribute("geometryState", "Ignored here: the nodes are those of the mechanical state."),
    visual_attribute("showGravityCenter"),
    visual_attribute("showAxisSizeFactor"),
};
inline constexpr Description kDiagonalMass{.class_name = "DiagonalMass",
                                           .category = "Mass",
                                           .help = "Each hexahedron gives an eighth of its mass to each of its nodes.",
                                           .templates = "Vec3 Vec3d Vec3,double Vec3d,double Vec3,Vec3",
                                           .attributes = kDiagonalMassAttributes};

}  // namespace hexaplast::attributes
