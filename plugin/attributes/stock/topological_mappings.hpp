// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Topologies made of others. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMappedFrom{.name = "input",
                                       .type = Type::kLink,
                                       .help = "The topology with the cells; default: the nearest one above the node."};
inline constexpr Attribute kMappedTo{
    .name = "output", .type = Type::kLink, .help = "The container that gets the new cells and the same nodes."};
inline constexpr Attribute kFlipNormals{
    .name = "flipNormals", .type = Type::kBool, .initial = "false", .help = "Turns the new cells over."};

inline constexpr Attribute kHexa2QuadTopologicalMappingAttributes[] = {kMappedFrom, kMappedTo, kFlipNormals};
inline constexpr Description kHexa2QuadTopologicalMapping{
    .class_name = "Hexa2QuadTopologicalMapping",
    .category = "TopologicalMapping",
    .help =
        "The outer faces of hexahedra, in the beginning: where hexahedra are removed later, they stay. The numbers of "
        "the quads are not SOFA's.",
    .attributes = kHexa2QuadTopologicalMappingAttributes};

inline constexpr Attribute kQuad2TriangleTopologicalMappingAttributes[] = {
    kMappedFrom,
    kMappedTo,
    ignored_attribute("swapping", "Ignored here: every quad is cut between its first and its third node."),
};
inline constexpr Description kQuad2TriangleTopologicalMapping{
    .class_name = "Quad2TriangleTopologicalMapping",
    .category = "TopologicalMapping",
    .help = "Every quad as two triangles. SOFA takes the other diagonal for every other quad.",
    .attributes = kQuad2TriangleTopologicalMappingAttributes};

inline constexpr Attribute kHexa2TetraTopologicalMappingAttributes[] = {
    kMappedFrom,
    kMappedTo,
    ignored_attribute("swapping", "Ignored here: all hexahedra are cut alike."),
};
inline constexpr Description kHexa2TetraTopologicalMapping{
    .class_name = "Hexa2TetraTopologicalMapping",
    .category = "TopologicalMapping",
    .help =
        "Every hexahedron as six tetrahedra around the diagonal from its first to its seventh node. They are not "
        "mechanical: only hexahedra deform.",
    .attributes = kHexa2TetraTopologicalMappingAttributes};

inline constexpr Attribute kTetra2TriangleTopologicalMappingAttributes[] = {
    kMappedFrom,
    kMappedTo,
    kFlipNormals,
    ignored_attribute("noNewTriangles", "Ignored here: only the beginning counts."),
    ignored_attribute("noInitialTriangles", "Ignored here."),
};
inline constexpr Description kTetra2TriangleTopologicalMapping{
    .class_name = "Tetra2TriangleTopologicalMapping",
    .category = "TopologicalMapping",
    .help = "The outer faces of tetrahedra, in the beginning.",
    .attributes = kTetra2TriangleTopologicalMappingAttributes};

}  // namespace hexaplast::attributes
