// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Masses. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMassRayleigh{
    .name = "rayleighMass",
    .type = Type::kReal,
    .initial = "0",
    .unit = "1/s",
    .range = kNotNegative,
    .help = "Damping by this mass in the system matrix alone, besides the solver's own."};

inline constexpr Attribute kUniformMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Shared equally by all nodes."},
    {.name = "vertexMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Of each node, unless totalMass is given."},
    kMassRayleigh,
};
inline constexpr Description kUniformMass{.class_name = "UniformMass",
                                          .category = "Mass",
                                          .help = "The same mass at every node.",
                                          .templates = "Vec3 Vec3d Vec3,double Vec3d,double",
                                          .attributes = kUniformMassAttributes};

inline constexpr Attribute kDiagonalMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help =
         "Of the whole body, spread by volume. Counts before massDensity, which counts before vertexMass; 1 kg where "
         "none is given."},
    {.name = "massDensity",
     .type = Type::kReal,
     .unit = "kg/m^3",
     .range = kPositive,
     .help = "Mass per volume at rest."},
    {.name = "vertexMass", .type = Type::kReals, .unit = "kg", .range = kNotNegative, .help = "One value per node."},
    kMassRayleigh,
    {.name = "topology",
     .type = Type::kLink,
     .help = "The hexahedra; the topology of the node (or of the nearest one above) where it is not given."},
};
inline constexpr Description kDiagonalMass{.class_name = "DiagonalMass",
                                           .category = "Mass",
                                           .help = "Each hexahedron gives an eighth of its mass to each of its nodes.",
                                           .templates = "Vec3 Vec3d Vec3,double Vec3d,double",
                                           .attributes = kDiagonalMassAttributes};

}  // namespace hexaplast::attributes
