// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast::output {

/// Points in single precision.
std::vector<Eigen::Vector3f> single(ConstPoints points);

/// Quads and triangles that move with their points, and what of them stays the same while they do: edges, and which of
/// the corners around a point share a normal.
class Surface {
 public:
  /// A quad, or a triangle whose last corner stands there twice; counter-clockwise seen from outside.
  using Face = std::array<int, 4>;

  /// original: the points [m] at which is decided where the surface bends smoothly and where it has a crease.
  /// walls: per face, 1 for walls of cuts, which do not bend smoothly into the rest; empty: none is one.
  Surface(std::vector<Eigen::Vector3f> original, std::vector<Face> faces, std::vector<unsigned char> walls = {});

  const std::vector<Eigen::Vector3f>& original() const { return original_; }
  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<Edge>& edges() const { return edges_; }  ///< each once
  bool is_wall(std::size_t face) const { return !is_wall_.empty() && is_wall_[face] != 0; }

  bool is_closed() const { return is_closed_; }  ///< two faces meet at each edge

  float mean_edge() const;  ///< [m] mean length of the edges of the original

  /// Of the corners of each face: those around a point that no crease parts are of one group.
  const std::vector<std::array<int, 4>>& groups() const { return groups_; }

  /// Unit normals of the groups: the mean over their faces.
  std::vector<Eigen::Vector3f> group_normals(const std::vector<Eigen::Vector3f>& points) const;

  /// Normals of any length at the points: the sum over all faces around each, by their areas.
  std::vector<Eigen::Vector3f> point_normals(const std::vector<Eigen::Vector3f>& points) const;

  /// Creases, and the edges between a face that is turned to a viewer in direction `towards` and one that is not.
  std::vector<Edge> outline(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& towards) const;

  static bool is_triangle(const Face& face) { return face[2] == face[3]; }

 private:
  std::vector<Eigen::Vector3f> face_normals(const std::vector<Eigen::Vector3f>& points) const;  // twice the area long

  std::vector<Eigen::Vector3f> original_;
  std::vector<Face> faces_;
  std::vector<unsigned char> is_wall_;
  std::vector<Edge> edges_;
  std::vector<Edge> creases_, smooth_;               // where the original is not smooth, and where it is
  std::vector<std::array<int, 2>> faces_of_smooth_;  // the two faces at each smooth edge
  std::vector<std::array<int, 4>> groups_;
  int num_groups_ = 0;
  bool is_closed_ = true;
};

}  // namespace hexaplast::output
