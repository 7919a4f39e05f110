// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Nodes and elements. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMechanicalObjectAttributes[] = {
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kState,
     .help = "Nodes; default: those of the topology, also for a single position beside a topology in the same node. A "
             "link gives the first positions only."},
    {.name = "velocity", .type = Type::kVectors3, .unit = "m/s", .access = Access::kState, .help = "Default: at rest."},
    {.name = "rest_position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kState,
     .help = "Undeformed nodes; default: the transformed positions."},
    {.name = "externalForce", .type = Type::kVectors3, .unit = "N", .help = "Constant nodal forces, one per node."},
    {.name = "scale3d", .type = Type::kVector3, .initial = "1 1 1", .help = "Applied first to the positions."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z; applied second."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "topology", .type = Type::kLink, .help = "Source of the nodes; default: the nearest topology."},
    {.name = "scale",
     .type = Type::kReal,
     .initial = "1",
     .help = "Factor of all three directions; SOFA reads it in single precision."},
    {.name = "restScale",
     .type = Type::kReal,
     .initial = "1",
     .range = kPositive,
     .help = "Factor of the rest positions."},
    ignored_attribute("size", "Ignored here: there are as many nodes as positions."),
    ignored_attribute("force", "Ignored here: forces are computed in every step, in SOFA too."),
    ignored_attribute("derivX", "Ignored here: it is computed in every step, in SOFA too."),
    visual_attribute("showObject"),
    visual_attribute("showObjectScale"),
    visual_attribute("showIndices"),
    visual_attribute("showIndicesScale"),
    visual_attribute("showVectors"),
    visual_attribute("showVectorsScale"),
    visual_attribute("showColor"),
    visual_attribute("drawMode"),
};
inline constexpr Description kMechanicalObject{.class_name = "MechanicalObject",
                                               .category = "MechanicalState",
                                               .help = "Positions and velocities of the nodes.",
                                               .templates = kVec3Templates,
                                               .attributes = kMechanicalObjectAttributes};

inline constexpr Attribute kTopologyEdges{
    .name = "edges", .type = Type::kIntegers, .access = Access::kOutput, .help = "Pairs of nodes."};
inline constexpr Attribute kTopologyQuads{.name = "quads",
                                          .type = Type::kIntegers,
                                          .access = Access::kOutput,
                                          .help = "Faces of the cells, each once: groups of four nodes."};

inline constexpr Attribute kRegularGridTopologyAttributes[] = {
    {.name = "n",
     .type = Type::kIntegers,
     .initial = "2 2 2",
     .range = {.min = 2, .max = 2147483646},
     .help = "Nodes (not cells) along x, y, z."},
    {.name = "min", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Lowest corner."},
    {.name = "max", .type = Type::kVector3, .initial = "1 1 1", .unit = "m", .help = "Highest corner."},
    {.name = "cellWidth",
     .type = Type::kReal,
     .initial = "0",
     .unit = "m",
     .range = kNotNegative,
     .help = "If not 0, replaces n: no cell is wider than this."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Nodes: i + nx (j + ny k)."},
    {.name = "hexahedra", .type = Type::kHexahedra, .access = Access::kOutput, .help = "Cells, x fastest."},
    kTopologyQuads,
    kTopologyEdges,
    ignored_attribute("computeHexaList", "Ignored here: what is asked for is computed."),
    ignored_attribute("computeQuadList", "Ignored here: what is asked for is computed."),
    ignored_attribute("computeTriangleList", "Ignored here: what is asked for is computed."),
    ignored_attribute("createTexCoords", "Visual: ignored here."),
    ignored_attribute("computeEdgeList", "Ignored here: what is asked for is computed."),
    ignored_attribute("computePointList", "Ignored here: what is asked for is computed."),
    visual_attribute("drawEdges"),
    visual_attribute("drawTriangles"),
    visual_attribute("drawQuads"),
    visual_attribute("drawTetrahedra"),
    visual_attribute("drawHexahedra"),
};
inline constexpr Description kRegularGridTopology{.class_name = "RegularGridTopology",
                                                  .category = "Topology",
                                                  .help = "A box cut into equal cells.",
                                                  .attributes = kRegularGridTopologyAttributes};

inline constexpr Attribute kSparseGridTopologyAttributes[] = {
    {.name = "fileTopology",
     .type = Type::kText,
     .help = "The surface: triangles and quads of a mesh file, .obj (the only one in SOFA), .stl, .vtk, .vtu or .msh."},
    {.name = "n",
     .type = Type::kIntegers,
     .initial = "2 2 2",
     .range = {.min = 2, .max = 2147483646},
     .help = "Nodes (not cells) of the whole grid along x, y, z."},
    {.name = "min",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "m",
     .help = "Lowest corner of the grid. If min and max are both 0: the box around the surface, widened by 1 % at "
             "either side."},
    {.name = "max", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Highest corner of the grid."},
    {.name = "cellWidth",
     .type = Type::kReal,
     .initial = "0",
     .unit = "m",
     .range = kNotNegative,
     .help = "If not 0, replaces n: no cell is wider than this."},
    {.name = "onlyInsideCells",
     .type = Type::kBool,
     .initial = "false",
     .help = "Leaves out the cells that the surface passes through."},
    {.name = "fillWeighted",
     .type = Type::kBool,
     .initial = "true",
     .help =
         "Hexahedra that the surface passes through have half the stress at the same strain. Masses are not changed."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Nodes of the cells: x slowest, z fastest."},
    {.name = "hexahedra",
     .type = Type::kHexahedra,
     .access = Access::kOutput,
     .help = "The cells that the surface passes through, then those that it encloses; x fastest in both."},
    kTopologyQuads,
    kTopologyEdges,
    visual_attribute("drawEdges"),
    visual_attribute("drawTriangles"),
    visual_attribute("drawQuads"),
    visual_attribute("drawTetrahedra"),
    visual_attribute("drawHexahedra"),
};
inline constexpr Description kSparseGridTopology{
    .class_name = "SparseGridTopology",
    .category = "Topology",
    .help =
        "A coarse cage around a surface: the cells of a grid that the surface touches or encloses. A "
        "BarycentricMapping embeds the surface. A surface with holes through which the outside reaches cells inside it "
        "is an error. Warnings name the number of parts that share no face, and of nodes around which hexahedra fold.",
    .attributes = kSparseGridTopologyAttributes};

inline constexpr Attribute kMeshTopologyAttributes[] = {
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Nodes. Default: those of the mechanical state."},
    {.name = "hexahedra", .type = Type::kHexahedra, .range = kIndex, .help = "Groups of eight nodes."},
    {.name = "quads",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Groups of four nodes; default: all faces of the hexahedra, each once."},
    {.name = "triangles", .type = Type::kIntegers, .range = kIndex, .help = "Groups of three nodes."},
    {.name = "edges",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Pairs of nodes; default: all edges of the hexahedra, each once."},
    ignored_attribute("nbPoints", "Ignored here: there are as many nodes as positions."),
    ignored_attribute("createTriangleArray", "Ignored here."),
    ignored_attribute("createQuadArray", "Ignored here: what is asked for is computed."),
    ignored_attribute("computeAllBuffers", "Ignored here: what is asked for is computed."),
    ignored_attribute("checkConnexity", "Ignored here: unconnected parts are allowed."),
    ignored_attribute("checkTopology", "Ignored here: it is always checked."),
    visual_attribute("drawEdges"),
    visual_attribute("drawTriangles"),
    visual_attribute("drawQuads"),
    visual_attribute("drawTetrahedra"),
    visual_attribute("drawHexahedra"),
};
inline constexpr Description kMeshTopology{
    .class_name = "MeshTopology",
    .category = "Topology",
    .help = "Nodes and cells as they are given, from a mesh loader or in the scene.",
    .attributes = kMeshTopologyAttributes};
constexpr Description container(std::string_view class_name) {
  return {.class_name = class_name,
          .category = "Topology",
          .help = "Nodes and cells as they are given, from a mesh loader or in the scene.",
          .attributes = kMeshTopologyAttributes};
}
inline constexpr Description kHexahedronSetTopologyContainer = container("HexahedronSetTopologyContainer");
inline constexpr Description kQuadSetTopologyContainer = container("QuadSetTopologyContainer");
inline constexpr Description kTriangleSetTopologyContainer = container("TriangleSetTopologyContainer");

/// What every mesh loader takes; they differ in `createSubelements` alone.
constexpr std::array<Attribute, 18> loader_attributes(std::string_view creates_subelements) {
  return {{
      {.name = "filename", .type = Type::kText, .help = "The mesh file."},
      {.name = "scale3d", .type = Type::kVector3, .initial = "1 1 1", .help = "Applied first."},
      {.name = "scale",
       .type = Type::kReal,
       .initial = "1",
       .help = "Factor of all three directions; SOFA reads it in single precision."},
      {.name = "rotation",
       .type = Type::kVector3,
       .initial = "0 0 0",
       .unit = "deg",
       .help = "About x, then y, then z; applied second."},
      {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
      {.name = "triangulate",
       .type = Type::kBool,
       .initial = "false",
       .help = "Cuts every quad into two triangles, before faces are added."},
      {.name = "createSubelements",
       .type = Type::kBool,
       .initial = creates_subelements,
       .help = "Adds the faces of the hexahedra and the edges of all faces."},
      {.name = "onlyAttachedPoints",
       .type = Type::kBool,
       .initial = "false",
       .help = "Leaves out nodes that no cell has; the others are numbered anew."},
      {.name = "position", .type = Type::kVectors3, .unit = "m", .access = Access::kOutput, .help = "Nodes."},
      {.name = "edges", .type = Type::kIntegers, .access = Access::kOutput, .help = "Pairs of nodes."},
      {.name = "triangles", .type = Type::kIntegers, .access = Access::kOutput, .help = "Groups of three nodes."},
      {.name = "quads", .type = Type::kIntegers, .access = Access::kOutput, .help = "Groups of four nodes."},
      {.name = "hexahedra", .type = Type::kHexahedra, .access = Access::kOutput, .help = "Groups of eight nodes."},
      ignored_attribute("flipNormals", "Ignored here: normals are drawing."),
      ignored_attribute("normals", "Ignored here: normals are drawing."),
      visual_attribute("handleSeams"),
      visual_attribute("loadMaterial"),
      visual_attribute("storeGroups"),
  }};
}
inline constexpr auto kGmshLoaderAttributes = loader_attributes("true");
inline constexpr auto kMeshLoaderAttributes = loader_attributes("false");

inline constexpr Description kMeshGmshLoader{
    .class_name = "MeshGmshLoader",
    .category = "MeshLoader",
    .help =
        "Reads .msh files of Gmsh, versions 2 and 4.1, text or binary. Cells that are neither edges, triangles, quads "
        "nor hexahedra of first order are skipped, and copies of cells taken once, with a warning. Links reach the "
        "hexahedra of physical groups by the names of these, `@loader.tumour`, or by their numbers if they have none.",
    .attributes = kGmshLoaderAttributes};
inline constexpr Description kMeshVTKLoader{
    .class_name = "MeshVTKLoader",
    .category = "MeshLoader",
    .help =
        "Reads unstructured grids of VTK: legacy .vtk files (text or binary) and .vtu files (text, base64 or raw, "
        "uncompressed or by zlib). Skips cells as MeshGmshLoader does. Links reach the cell data of .vtu files by "
        "their names, `@loader.label`: one number per hexahedron.",
    .attributes = kMeshLoaderAttributes};
inline constexpr Description kMeshOBJLoader{.class_name = "MeshOBJLoader",
                                            .category = "MeshLoader",
                                            .help = "Reads the vertices, lines and faces of .obj files.",
                                            .attributes = kMeshLoaderAttributes};
inline constexpr Attribute kStlAttributes[] = {
    {.name = "headerSize",
     .type = Type::kInteger,
     .initial = "80",
     .range = kIndex,
     .help = "Of binary files, in bytes."},
    ignored_attribute("forceBinary", "Ignored here: the size of a file tells whether it is binary."),
    ignored_attribute("mergePositionUsingMap", "Ignored here: corners in one place are always one node."),
};
inline constexpr auto kStlLoaderAttributes = [] {
  std::array<Attribute, kMeshLoaderAttributes.size() + std::size(kStlAttributes)> all;
  std::ranges::copy(kStlAttributes, std::ranges::copy(kMeshLoaderAttributes, all.begin()).out);
  return all;
}();
inline constexpr Description kMeshSTLLoader{
    .class_name = "MeshSTLLoader",
    .category = "MeshLoader",
    .help =
        "Reads the triangles of .stl files, text or binary. Equal corners are one node. Triangles with two equal "
        "corners are left out, with a warning.",
    .attributes = kStlLoaderAttributes};

}  // namespace hexaplast::attributes
