// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "geometry/nearest_place.hpp"
#include "hexaplast/contact/surface_samples.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// From a hexahedron to what touches it, in reference coordinates: three edges from a sound one (weights_beyond).
inline constexpr double kFarthestBeyond = 6;

/// The surface of a deformable body as it is touched: whether a point lies in one of the hexahedra, and where the
/// nearest place of the surface is then. The initial shape says where to begin to look for it, the present one decides.
/// Both walls of a cut lie at one place initially: ways lead through faces that hexahedra have in common at present.
class TissueSurface {
 public:
  /// alive: empty, or one per hexahedron. The mesh must outlive it.
  TissueSurface(const HexMesh& mesh, std::span<const unsigned char> alive, bool touches_itself);

  int num_faces() const { return static_cast<int>(faces_.size()); }
  const Quad& face(int f) const { return faces_[static_cast<std::size_t>(f)]; }
  /// Of a body that touches itself: whether hexahedra count at a node that did not before, or the other way round.
  bool has_changed_at(int node, const TissueSurface& before, const SplitNodes& split) const {
    const auto old = static_cast<std::size_t>(split.before(node));
    return old >= before.near_.size() || near_[node] != before.near_[old];
  }
  /// Per face of the surface that was there before: the one that it is now, or -1. split: nodes that have since.
  std::vector<int> faces_since(const TissueSurface& before, const SplitNodes& split) const;
  const std::vector<int>& nodes() const { return nodes_; }  ///< of the hexahedra that are left, ascending
  bool has_hexahedron(int e) const { return std::ranges::binary_search(hexahedra_, e); }
  double mean_edge() const { return mean_edge_; }  ///< [m] of its faces
  double thickness() const { return thickness_; }  ///< [m] the least of a hexahedron that has a face, initially
  const Eigen::AlignedBox3d& box() const { return box_; }

  /// From now on the body has the positions x, which outlive this; hexahedra outside `region` do not count.
  void look_at(ConstPoints x, const Eigen::AlignedBox3d& region, double reach);

  struct Place {
    int hexahedron = -1;
    CornerWeights weights = CornerWeights::Zero();  ///< of its corners, for the point
    int face = -1;
    double distance = 0;          ///< [m] from the surface, negative inside
    Vec3 normal = Vec3::UnitZ();  ///< of length 1: the direction in which the distance grows
  };

  /// Of a sample: the face of the side that it came through in a step before, or -1, and the normal of its own surface.
  struct Side {
    int face = -1;
    Vec3 outwards = Vec3::Zero();
  };

  /// Where a point is that lies inside, or in front of the surface within `reach` [m]. It is followed from the face of
  /// its side, if there is one. own: nodes of the sample, where it belongs to this body: hexahedra less than two cells
  /// away from them do not count.
  std::optional<Place> find(const Vec3& p, const Side& side, double reach, std::span<const int> own) const;

  /// Whether no hexahedron that counts comes nearer to a point than `reach` [m].
  bool is_clear(const Vec3& p, double reach, std::span<const int> own) const;

  /// A point on an edge of the surface is as near to all faces around it: its place is on the one that its own surface
  /// faces, whose normal is `outwards`.
  void turn_to_facing(Place& place, const Vec3& p, const Vec3& outwards, std::span<const int> own) const;

  /// The nearest place may lie on another side than the one that a point came through, from p - change straight to p
  /// against the body. Then its place is on that one, and the distance that from it along its normal. The side counts
  /// if it was inside before; without one, the nearest face there.
  void turn_to_entry(Place& place, const Vec3& p, const Vec3& change, const Side& side, std::span<const int> own) const;

 private:
  struct Nearest {
    int face = -1;
    TrianglePlace place;
    int triangle = 0;
  };

  int find_face(const Quad& nodes) const;  // that has these nodes, or -1
  void find_neighbourhoods(std::span<const unsigned char> alive);
  void find_thickness();
  bool is_near(int hexahedron, std::span<const int> own) const;
  bool is_joined(int hexahedron, int other, int steps = 3) const;
  bool is_left_out(int face, std::span<const int> own) const { return !own.empty() && is_near(owner_[face], own); }
  template <class Visit>
  void for_each_around(const Vec3& p, const Visit& visit) const;
  template <class Visit>
  void for_each_cell(const Eigen::AlignedBox3d& box, const Visit& visit) const;
  static std::array<Vec3, 3> triangle_of(ConstPoints x, const Quad& face, int k);
  bool is_nearer(const Nearest& found, const Nearest& other) const;
  bool is_farther(int face, const Nearest& than, const Vec3& p) const;
  Nearest nearest_on(ConstPoints x, const Quad& face, int index, const Vec3& p) const;
  Nearest nearest_initially(const Vec3& p, int hexahedron) const;
  Nearest walk(int face, const Vec3& p, std::span<const int> own, const std::optional<Vec3>& side = {}) const;
  Nearest on_its_side(const Side& side, const Vec3& p, std::span<const int> own) const;
  bool is_in_front(const Nearest& nearest, const Vec3& p) const;
  Vec3 normal_of(int face) const;
  Place place_at(const Nearest& nearest, const Vec3& p, bool is_inside) const;

  const HexMesh* mesh_;
  std::vector<int> hexahedra_;                      // that are left
  std::vector<Quad> faces_;                         // of the surface
  std::vector<int> owner_;                          // the hexahedron of each
  std::vector<int> first_of_node_, faces_of_node_;  // of the surface, around each node
  std::vector<int> first_of_hexahedron_, faces_of_hexahedron_;
  std::vector<std::array<int, 6>> across_;  // per hexahedron: its neighbours
  double mean_edge_ = 0, thickness_ = 0;
  std::vector<int> nodes_;
  std::vector<std::vector<int>> near_;  // per node: hexahedra less than two cells away, ascending; of one that touches
                                        // itself

  // the present look: hexahedra by the cells of a grid that their boxes meet
  std::optional<ConstPoints> x_;
  Eigen::AlignedBox3d box_;
  Vec3 origin_ = Vec3::Zero();
  double cell_ = 1;
  Eigen::Array3i size_ = {0, 0, 0};
  std::vector<Eigen::AlignedBox3d> boxes_;  // per hexahedron
  std::vector<int> counted_, first_in_cell_, in_cell_;
};

}  // namespace hexaplast
