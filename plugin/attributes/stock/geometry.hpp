// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Nodes and elements. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr auto kMechanicalObjectAttributes = joined(
    std::array{
        vectors3(
            "position", {.unit = "m", .access = Access::kState},
            "Nodes; default: those of the topology, also for a single position beside a topology in the same node. A "
            "link gives the first positions only."),
        vectors3("velocity", {.unit = "m/s", .access = Access::kState}, "Default: at rest."),
        vectors3("rest_position", {.unit = "m", .access = Access::kState},
                 "Undeformed nodes; default: the transformed positions."),
        vectors3("externalForce", {.unit = "N"}, "Constant nodal forces, one per node."),
        vector3("scale3d", {.initial = "1 1 1"}, "Applied first to the positions."),
        vector3("rotation", {.initial = "0 0 0", .unit = "deg"}, "About x, then y, then z; applied second."),
        vector3("translation", {.initial = "0 0 0", .unit = "m"}, "Applied last."),
        link("topology", "Source of the nodes; default: the nearest topology."),
        real("scale", {.initial = "1"}, "Factor of all three directions; SOFA reads it in single precision."),
        real("restScale", {.initial = "1", .range = kPositive}, "Factor of the rest positions."),
        ignored_attribute("size", "Ignored here: there are as many nodes as positions."),
        ignored_attribute("force", "Ignored here: forces are computed in every step, in SOFA too."),
        ignored_attribute("derivX", "Ignored here: it is computed in every step, in SOFA too."),
    },
    visual_attributes("showObject", "showObjectScale", "showIndices", "showIndicesScale", "showVectors",
                      "showVectorsScale", "showColor", "drawMode"));
inline constexpr Description kMechanicalObject{.class_name = "MechanicalObject",
                                               .category = "MechanicalState",
                                               .help = "Positions and velocities of the nodes.",
                                               .templates = kVec3Templates,
                                               .attributes = kMechanicalObjectAttributes};

inline constexpr Attribute kTopologyEdges = output(integers("edges", "Pairs of nodes."));
inline constexpr Attribute kTopologyQuads =
    output(integers("quads", "Faces of the cells, each once: groups of four nodes."));

inline constexpr Attribute kCellWidth = real("cellWidth", {.initial = "0", .unit = "m", .range = kNotNegative},
                                             "If not 0, replaces n: no cell is wider than this.");

inline constexpr auto kRegularGridTopologyAttributes = joined(
    std::array{
        integers("n", {.initial = "2 2 2", .range = {.min = 2, .max = 2147483646}}, "Nodes (not cells) along x, y, z."),
        vector3("min", {.initial = "0 0 0", .unit = "m"}, "Lowest corner."),
        vector3("max", {.initial = "1 1 1", .unit = "m"}, "Highest corner."),
        kCellWidth,
        output(vectors3("position", {.unit = "m"}, "Nodes: i + nx (j + ny k).")),
        output(hexahedra("hexahedra", "Cells, x fastest.")),
        kTopologyQuads,
        kTopologyEdges,
        ignored_attribute("computeHexaList", "Ignored here: what is asked for is computed."),
        ignored_attribute("computeQuadList", "Ignored here: what is asked for is computed."),
        ignored_attribute("computeTriangleList", "Ignored here: what is asked for is computed."),
        ignored_attribute("createTexCoords", "Visual: ignored here."),
        ignored_attribute("computeEdgeList", "Ignored here: what is asked for is computed."),
        ignored_attribute("computePointList", "Ignored here: what is asked for is computed."),
    },
    kDrawnCells);
inline constexpr Description kRegularGridTopology =
    topology("RegularGridTopology", "A box cut into equal cells.", kRegularGridTopologyAttributes);

inline constexpr auto kSparseGridTopologyAttributes = joined(
    std::array{
        free_text(
            "fileTopology",
            "The surface: triangles and quads of a mesh file, .obj (the only one in SOFA), .stl, .vtk, .vtu or .msh."),
        integers("n", {.initial = "2 2 2", .range = {.min = 2, .max = 2147483646}},
                 "Nodes (not cells) of the whole grid along x, y, z."),
        vector3("min", {.initial = "0 0 0", .unit = "m"},
                "Lowest corner of the grid. If min and max are both 0: the box around the surface, widened by 1 % at "
                "either side."),
        vector3("max", {.initial = "0 0 0", .unit = "m"}, "Highest corner of the grid."),
        kCellWidth,
        boolean("onlyInsideCells", {.initial = "false"}, "Leaves out the cells that the surface passes through."),
        boolean("fillWeighted", {.initial = "true"},
                "Hexahedra that the surface passes through have half the stress at the same strain. Masses are not "
                "changed."),
        output(vectors3("position", {.unit = "m"}, "Nodes of the cells: x slowest, z fastest.")),
        output(hexahedra("hexahedra",
                         "The cells that the surface passes through, then those that it encloses; x fastest in both.")),
        kTopologyQuads,
        kTopologyEdges,
    },
    kDrawnCells);
inline constexpr Description kSparseGridTopology = topology(
    "SparseGridTopology",
    "A coarse cage around a surface: the cells of a grid that the surface touches or encloses. A BarycentricMapping "
    "embeds the surface. A surface with holes through which the outside reaches cells inside it is an error. Warnings "
    "name the number of parts that share no face, and of nodes around which hexahedra fold.",
    kSparseGridTopologyAttributes);

inline constexpr auto kMeshTopologyAttributes = joined(
    std::array{
        vectors3("position", {.unit = "m"}, "Nodes. Default: those of the mechanical state."),
        hexahedra("hexahedra", {.range = kIndex}, "Groups of eight nodes."),
        indices("quads", "Groups of four nodes; default: all faces of the hexahedra, each once."),
        indices("triangles", "Groups of three nodes."),
        indices("edges", "Pairs of nodes; default: all edges of the hexahedra, each once."),
        ignored_attribute("nbPoints", "Ignored here: there are as many nodes as positions."),
        ignored_attribute("createTriangleArray", "Ignored here."),
        ignored_attribute("createQuadArray", "Ignored here: what is asked for is computed."),
        ignored_attribute("computeAllBuffers", "Ignored here: what is asked for is computed."),
        ignored_attribute("checkConnexity", "Ignored here: unconnected parts are allowed."),
        ignored_attribute("checkTopology", "Ignored here: it is always checked."),
    },
    kDrawnCells);
constexpr Description container(std::string_view class_name) {
  return topology(class_name, "Nodes and cells as they are given, from a mesh loader or in the scene.",
                  kMeshTopologyAttributes);
}
inline constexpr Description kMeshTopology = container("MeshTopology");
inline constexpr Description kHexahedronSetTopologyContainer = container("HexahedronSetTopologyContainer");
inline constexpr Description kQuadSetTopologyContainer = container("QuadSetTopologyContainer");
inline constexpr Description kTriangleSetTopologyContainer = container("TriangleSetTopologyContainer");

/// What every mesh loader takes; they differ in `createSubelements` alone.
constexpr auto loader_attributes(std::string_view creates_subelements) {
  return std::array{
      free_text("filename", "The mesh file."),
      vector3("scale3d", {.initial = "1 1 1"}, "Applied first."),
      real("scale", {.initial = "1"}, "Factor of all three directions; SOFA reads it in single precision."),
      vector3("rotation", {.initial = "0 0 0", .unit = "deg"}, "About x, then y, then z; applied second."),
      vector3("translation", {.initial = "0 0 0", .unit = "m"}, "Applied last."),
      boolean("triangulate", {.initial = "false"}, "Cuts every quad into two triangles, before faces are added."),
      boolean("createSubelements", {.initial = creates_subelements},
              "Adds the faces of the hexahedra and the edges of all faces."),
      boolean("onlyAttachedPoints", {.initial = "false"},
              "Leaves out nodes that no cell has; the others are numbered anew."),
      output(vectors3("position", {.unit = "m"}, "Nodes.")),
      output(integers("edges", "Pairs of nodes.")),
      output(integers("triangles", "Groups of three nodes.")),
      output(integers("quads", "Groups of four nodes.")),
      output(hexahedra("hexahedra", "Groups of eight nodes.")),
      ignored_attribute("flipNormals", "Ignored here: normals are drawing."),
      ignored_attribute("normals", "Ignored here: normals are drawing."),
      visual_attribute("handleSeams"),
      visual_attribute("loadMaterial"),
      visual_attribute("storeGroups"),
  };
}
inline constexpr auto kGmshLoaderAttributes = loader_attributes("true");
inline constexpr auto kMeshLoaderAttributes = loader_attributes("false");

inline constexpr Description kMeshGmshLoader = mesh_loader(
    "MeshGmshLoader",
    "Reads .msh files of Gmsh, versions 2 and 4.1, text or binary. Cells that are neither edges, triangles, quads nor "
    "hexahedra of first order are skipped, and copies of cells taken once, with a warning. Links reach the hexahedra "
    "of physical groups by the names of these, `@loader.tumour`, or by their numbers if they have none.",
    kGmshLoaderAttributes);
inline constexpr Description kMeshVTKLoader =
    mesh_loader("MeshVTKLoader",
                "Reads unstructured grids of VTK: legacy .vtk files (text or binary) and .vtu files (text, base64 or "
                "raw, uncompressed or by zlib). Skips cells as MeshGmshLoader does. Links reach the cell data of .vtu "
                "files by their names, `@loader.label`: one number per hexahedron.",
                kMeshLoaderAttributes);
inline constexpr Description kMeshOBJLoader =
    mesh_loader("MeshOBJLoader", "Reads the vertices, lines and faces of .obj files.", kMeshLoaderAttributes);
inline constexpr std::array kStlAttributes = {
    integer("headerSize", {.initial = "80", .range = kIndex}, "Of binary files, in bytes."),
    ignored_attribute("forceBinary", "Ignored here: the size of a file tells whether it is binary."),
    ignored_attribute("mergePositionUsingMap", "Ignored here: corners in one place are always one node."),
};
inline constexpr auto kStlLoaderAttributes = joined(kMeshLoaderAttributes, kStlAttributes);
inline constexpr Description kMeshSTLLoader =
    mesh_loader("MeshSTLLoader",
                "Reads the triangles of .stl files, text or binary. Equal corners are one node. Triangles with two "
                "equal corners are left out, with a warning.",
                kStlLoaderAttributes);

}  // namespace hexaplast::attributes
