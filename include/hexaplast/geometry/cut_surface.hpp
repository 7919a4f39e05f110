// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/mesh/node_copies.hpp"

namespace hexaplast {

/// Which faces between hexahedra of a mesh are open, and where what opened them passed.
struct OpenFaces {
  std::vector<int> initial_node;  ///< per node of the mesh: the initial one that it is a copy of
  std::vector<int> copy;          ///< per node: its copy; nodes with the same one are one node still

  /// Per hexahedron and side (kFaces): from its centre (0) to that of the hexahedron across (1); -1: closed.
  std::vector<std::array<double, 6>> crossing;

  bool operator==(const OpenFaces&) const = default;
};

/// Of an initial mesh with open joints (Body::opened, Body::crossings).
OpenFaces open_faces(const Joints& joints, const NodeCopies& copies, std::span<const int> opened,
                     std::span<const double> crossings, int num_hexahedra);

/// The smooth walls of a cut: a quad per open face that parts nodes, on either side, whose vertices are the nodes of
/// the open faces, moved to where the cut passed. Both lips have the same initial places.         theory.md section 10
class CutWalls {
 public:
  struct Wall {
    int hexahedron, side;
  };

  /// An initial node of walls.
  struct Node {
    Vec3 place;                                ///< [m] of its vertices
    Vec3 middle;                               ///< [m] of the crossings around it
    Vec3 normal = Vec3::Zero();                ///< of the cut there, unit, towards the second copy; 0: the cut has none
    std::vector<int> copies;                   ///< ascending
    std::vector<HexMesh::Incidence> incident;  ///< of a copy that has none left, all that are removed

    bool is_split() const { return copies.size() > 1; }
  };

  /// alive: one per hexahedron, 0 for those that are removed; empty: all are there. Both arguments must outlive this
  /// object. Throws InputError for arrays of other sizes.
  CutWalls(const HexMesh& mesh, const OpenFaces& open, std::span<const unsigned char> alive = {});

  const HexMesh& mesh() const { return mesh_; }
  bool empty() const { return walls_.empty(); }
  const std::vector<Wall>& walls() const { return walls_; }  ///< also of removed hexahedra
  bool is_wall(Wall face) const { return is_wall_[face.hexahedron][face.side] != 0; }
  bool is_wall(int hexahedron, const Quad& nodes) const;  ///< of the mesh
  double mean_link() const { return mean_link_; }         ///< [m] between the centres of hexahedra across open faces

  const std::map<int, Node>& nodes() const { return nodes_; }  ///< by initial node
  const Node* node(int initial) const;                         ///< null: it is on no wall

  int initial_node(int hexahedron, int corner) const;
  int copy(int hexahedron, int corner) const;
  int copy_at(int hexahedron, int initial) const;  ///< that a hexahedron has of an initial node; -1: none

  /// Of those that have a copy of the node: the hexahedron nearest to a place; -1: none is left.
  int carrier(const Node& node, int copy, const Vec3& place) const;

 private:
  struct Face;
  std::vector<Face> find_faces();
  void find_nodes(std::span<const Face> faces, std::span<const unsigned char> alive);
  void fit(Node& node, const Vec3& at, std::span<const Face> faces, const std::vector<int>& own,
           const std::vector<int>& around) const;
  Mat3 outer_tangents(const Node& node) const;

  const HexMesh& mesh_;
  const OpenFaces& open_;
  std::vector<Wall> walls_;
  std::vector<std::array<unsigned char, 6>> is_wall_;
  std::map<int, Node> nodes_;
  double mean_link_ = 0;
};

/// Nodes of a mesh that lie on walls: where they are drawn, and the hexahedra that move them.
struct WallVertices {
  std::vector<int> node;
  PointArray points;  ///< [m] initial
  std::vector<int> hexahedron;
};
WallVertices wall_vertices(const CutWalls& walls);

/// A surface that moves with hexahedra.
struct CarriedSurface {
  PointArray points;                   ///< [m] initial
  std::vector<int> hexahedron;         ///< that moves the point
  std::vector<Quad> faces;             ///< a triangle has its last corner twice
  std::vector<unsigned char> is_wall;  ///< per face
};

/// A surface of triangles and quads, embedded in hexahedra, some of whose faces are open: triangles that the cut
/// crosses are divided, and lips and walls are closed by strips. A closed surface stays closed: at each edge an even
/// number of faces meet. Its first points are those of the surface.
///   embedding: the points in hexahedra from `first_hexahedron` on, `num_hexahedra` of them.
CarriedSurface cut_skin(const CutWalls& walls, ConstPoints points, std::span<const Quad> faces,
                        const Embedding& embedding, int first_hexahedron, int num_hexahedra);

}  // namespace hexaplast
