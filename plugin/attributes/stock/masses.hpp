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
    .name = "topology",
    .type = Type::kLink,
    .help = "The hexahedra; default: the topology of the node, or of the nearest one above."};

inline constexpr Attribute kDiagonalMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Of the whole body, spread by volume. Counts before massDensity, which counts before vertexMass; 1 kg if "
             "none is given."},
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

inline constexpr Attribute kMeshMatrixMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Of the whole body, spread by volume. Counts before massDensity; 1 kg if none is given."},
    {.name = "massDensity",
     .type = Type::kReals,
     .unit = "kg/m^3",
     .range = kPositive,
     .help = "Mass per volume: one value, or one per hexahedron."},
    {.name = "lumping",
     .type = Type::kBool,
     .initial = "false",
     .help =
         "Sums every row on the diagonal: an eighth of its mass to each node of a hexahedron, as DiagonalMass does."},
    {.name = "computeMassOnRest",
     .type = Type::kBool,
     .initial = "false",
     .help = "Whether volumes are those of the rest positions or of the first positions."},
    kMassRayleigh,
    kSeparateGravity,
    kMassTopology,
    ignored_attribute("geometryState", "Ignored here: the nodes are those of the mechanical state."),
    ignored_attribute("printMass", "Ignored here."),
    visual_attribute("showGravityCenter"),
    visual_attribute("showAxisSizeFactor"),
};
inline constexpr Description kMeshMatrixMass{
    .class_name = "MeshMatrixMass",
    .category = "Mass",
    .help =
        "The finite element mass matrix of the hexahedra. SOFA couples the nodes along edges alone (a twentieth of a "
        "hexahedron's mass at each node, a fortieth on each edge), which lets some motions have a negative energy; "
        "here every two nodes of a hexahedron are coupled, with the same total. Lumped, the two are equal. Of a "
        "topology "
        "without hexahedra its quads or triangles have the mass, by area, with SOFA's matrix.",
    .templates = "Vec3 Vec3d Vec3,Vec3 Vec3d,Vec3d",
    .attributes = kMeshMatrixMassAttributes};

}  // namespace hexaplast::attributes
