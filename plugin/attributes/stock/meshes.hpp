// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Nodes, elements, and lists of them. See stock.hpp.
namespace hexaplast::attributes {

// ---- nodes and elements

inline constexpr Table kMechanicalObject{
    Category{"MechanicalState", kVec3Templates}("MechanicalObject", "Positions and velocities of the nodes."),
    vectors3("position", {.unit = "m", .access = Access::kState},
             "Nodes; default: those of the topology, also for a single position beside a topology in the same node. A "
             "link gives the first positions only."),
    vectors3("velocity", {.unit = "m/s", .access = Access::kState}, "Default: at rest."),
    vectors3("rest_position", {.unit = "m", .access = Access::kState},
             "Undeformed nodes; default: the transformed positions."),
    vector3("scale3d", {.initial = "1 1 1"}, "Applied first to the positions."),
    vector3("rotation", {.initial = "0 0 0", .unit = "deg"}, "About x, then y, then z; applied second."),
    vector3("translation", {.initial = "0 0 0", .unit = "m"}, "Applied last."),
    link("topology", "Source of the nodes; default: the nearest topology."),
    real("scale", {.initial = "1"}, "Factor of all three directions; SOFA reads it in single precision."),
    ignored("size"),
    ignored("force"),
};

inline constexpr Attribute kTopologyEdges = output(integers("edges", "Pairs of nodes."));
inline constexpr Attribute kTopologyQuads =
    output(integers("quads", "Faces of the cells, each once: groups of four nodes."));

inline constexpr Table kRegularGridTopology{
    topology("RegularGridTopology", "A box cut into equal cells."),
    integers("n", {.initial = "2 2 2", .range = {.min = 2, .max = 2147483646}}, "Nodes (not cells) along x, y, z."),
    vector3("min", {.initial = "0 0 0", .unit = "m"}, "Lowest corner."),
    vector3("max", {.initial = "1 1 1", .unit = "m"}, "Highest corner."),
    output(vectors3("position", {.unit = "m"}, "Nodes: i + nx (j + ny k).")),
    output(hexahedra("hexahedra", "Cells, x fastest.")),
    kTopologyQuads,
    kTopologyEdges,
};

inline constexpr Table kSparseGridTopology{
    topology("SparseGridTopology",
             "A coarse cage around a surface: the cells of a grid that the surface touches or encloses. A "
             "BarycentricMapping "
             "embeds the surface. A surface with holes through which the outside reaches cells inside it is an error. "
             "Warnings "
             "name the number of parts that share no face, and of nodes around which hexahedra fold."),
    free_text(
        "fileTopology",
        "The surface: triangles and quads of a mesh file, .obj (the only one in SOFA), .stl, .vtk, .vtu or .msh."),
    integers("n", {.initial = "2 2 2", .range = {.min = 2, .max = 2147483646}},
             "Nodes (not cells) of the whole grid along x, y, z."),
    vector3("min", {.initial = "0 0 0", .unit = "m"},
            "Lowest corner of the grid. If min and max are both 0: the box around the surface, widened by 1 % at "
            "either side."),
    vector3("max", {.initial = "0 0 0", .unit = "m"}, "Highest corner of the grid."),
    boolean("fillWeighted", {.initial = "true"},
            "Hexahedra that the surface passes through have half the stress at the same strain. Masses are not "
            "changed."),
    output(vectors3("position", {.unit = "m"}, "Nodes of the cells: x slowest, z fastest.")),
    output(hexahedra("hexahedra",
                     "The cells that the surface passes through, then those that it encloses; x fastest in both.")),
    kTopologyQuads,
    kTopologyEdges,
};

constexpr Description container(std::string_view class_name, std::span<const Attribute> attributes = {}) {
  return topology(class_name, "Nodes and cells as they are given, from a mesh loader or in the scene.", attributes);
}
inline constexpr Table kMeshTopology{
    container("MeshTopology"),
    vectors3("position", {.unit = "m"}, "Nodes. Default: those of the mechanical state."),
    hexahedra("hexahedra", {.range = kIndex}, "Groups of eight nodes."),
    indices("quads", "Groups of four nodes; default: all faces of the hexahedra, each once."),
    indices("triangles", "Groups of three nodes."),
    indices("edges", "Pairs of nodes; default: all edges of the hexahedra, each once."),
};
inline constexpr Description kHexahedronSetTopologyContainer =
    container("HexahedronSetTopologyContainer", kMeshTopology.rows);
inline constexpr Description kQuadSetTopologyContainer = container("QuadSetTopologyContainer", kMeshTopology.rows);
inline constexpr Description kTriangleSetTopologyContainer =
    container("TriangleSetTopologyContainer", kMeshTopology.rows);

inline constexpr std::array kLoaderAttributes =
    Table{
        Description(),
        free_text("filename", "The mesh file."),
        vector3("scale3d", {.initial = "1 1 1"}, "Applied first."),
        real("scale", {.initial = "1"}, "Factor of all three directions; SOFA reads it in single precision."),
        vector3("rotation", {.initial = "0 0 0", .unit = "deg"}, "About x, then y, then z; applied second."),
        vector3("translation", {.initial = "0 0 0", .unit = "m"}, "Applied last."),
        boolean("triangulate", {.initial = "false"}, "Cuts every quad into two triangles, before faces are added."),
        output(vectors3("position", {.unit = "m"}, "Nodes.")),
        output(integers("edges", "Pairs of nodes.")),
        output(integers("triangles", "Groups of three nodes.")),
        output(integers("quads", "Groups of four nodes.")),
        output(hexahedra("hexahedra", "Groups of eight nodes.")),
        ignored("normals"),
    }
        .rows;

inline constexpr Description kMeshGmshLoader = mesh_loader(
    "MeshGmshLoader",
    "Reads .msh files of Gmsh, versions 2 and 4.1, text or binary. Cells that are neither edges, triangles, quads nor "
    "hexahedra of first order are skipped, and copies of cells taken once, with a warning. Links reach the hexahedra "
    "of physical groups by the names of these, `@loader.tumour`, or by their numbers if they have none. Adds the faces "
    "of the hexahedra and the edges of all faces.",
    kLoaderAttributes);
inline constexpr Description kMeshVTKLoader =
    mesh_loader("MeshVTKLoader",
                "Reads unstructured grids of VTK: legacy .vtk files (text or binary) and .vtu files (text, base64 or "
                "raw, uncompressed or by zlib). Skips cells as MeshGmshLoader does. Links reach the cell data of .vtu "
                "files by their names, `@loader.label`: one number per hexahedron.",
                kLoaderAttributes);
inline constexpr Description kMeshOBJLoader =
    mesh_loader("MeshOBJLoader", "Reads the vertices, lines and faces of .obj files.", kLoaderAttributes);
inline constexpr Description kMeshSTLLoader =
    mesh_loader("MeshSTLLoader",
                "Reads the triangles of .stl files, text or binary. Equal corners are one node. Triangles with two "
                "equal corners are left out, with a warning.",
                kLoaderAttributes);

// ---- parts of a body found by their place

/// What every region takes and gives. They differ in `strict` alone, in SOFA too.
constexpr auto region_rows(std::string_view strict) {
  return Table{
      Description(),
      vectors3("position", {.unit = "m"}, "Points to select from; default: the rest positions of the nearest state."),
      hexahedra("hexahedra", {.range = kIndex}, "Hexahedra to select from; default: those of the nearest topology."),
      boolean("strict", {.initial = strict},
              "A hexahedron is inside when all its nodes are; otherwise when its centre is."),
      output(integers("indices", "Points inside, ascending.")),
      output(integers("indicesOut", "Points outside, ascending.")),
      output(integers("hexahedronIndices", "Hexahedra inside, ascending.")),
      output(hexahedra("hexahedraInROI", "Nodes of the hexahedra inside.")),
  }
      .rows;
}

inline constexpr Table kBoxROI{
    engine("BoxROI", "Finds what lies in boxes."),
    boxes("box", {.initial = "0 0 0 1 1 1", .unit = "m"},
          "Two opposite corners of each box, in any order. Points on the border are inside. The default is ignored if "
          "an orientedBox is given."),
    reals("orientedBox", {.unit = "m"},
          "Ten numbers for each box: three consecutive corners of a rectangle, and the thickness, half of it to either "
          "side."),
    region_rows("true"),
};

inline constexpr Table kSphereROI{
    engine("SphereROI", "Finds what lies in spheres."),
    vectors3("centers", {.unit = "m"}, "Centre of each sphere."),
    reals("radii", {.unit = "m", .range = kNotNegative},
          "One for all spheres, or one each. Points on the surface are inside."),
    region_rows("true"),
};

inline constexpr Table kPlaneROI{
    engine("PlaneROI", "Finds what lies in thick rectangles. SOFA's finds no hexahedra; orientedBox of BoxROI does."),
    reals("plane", {.unit = "m"}, "Ten numbers for each, as orientedBox of BoxROI."),
    region_rows("true"),
};

inline constexpr Table kMeshROI{
    engine("MeshROI", "Finds what a closed surface of triangles encloses."),
    vectors3("ROIposition", {.unit = "m"}, "Points of a surface."),
    indices(
        "ROItriangles",
        "Its triangles. It must be closed and oriented; several points may lie at one place. What lies on it may count "
        "as inside or as outside."),
    output(boxes("box", {.unit = "m"}, "Around the surface.")),
    region_rows("false"),
};

// ---- lists of values that are made from others

inline constexpr Table kIndexValueMapper{
    engine("IndexValueMapper", "Gives some entries of a list another value."),
    reals("inputValues", "The values before; there may be none."),
    integers("indices", {.range = {.min = 0, .max = 9999999}},
             "Places in the list that get `value`. The list grows as far as they reach."),
    real("value", {.initial = "0"}, "What stands at these places."),
    real("defaultValue", {.initial = "1"}, "What stands at the other places that the list has gained."),
    output(reals("outputValues", "The values after.")),
};

inline constexpr Table kIndicesFromValues{
    Category{"Engine", "d f i I"}("IndicesFromValues", "Finds the places of values in a list: hexahedra with a label."),
    reals("values", "What is looked for."),
    reals("global", "The list in which it is looked for."),
    boolean("recursiveSearch", {.initial = "false"},
            "true: all places of each value, ascending; otherwise the first one. A value that is not there gives a "
            "warning."),
    output(integers("indices", "Places of the values.")),
};

}  // namespace hexaplast::attributes
