// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/mesh/joints.hpp"

namespace hexaplast {

/// What a line sweeps whose ends move straight from their places before a step to those after it, in coordinates on a
/// lattice.
struct Sweep {
  using Point = std::array<std::int64_t, 3>;
  struct End {
    Point before, after;
  };
  End p, q;
};

/// Whether a link meets a segment of a blade: exact for coordinates below 2^60.
///
/// In space and time a line p q sweeps the triangles (p0, q0, q1) and (p0, q1, p1), where 0 is before and 1 after the
/// step. Lines meet if one of the four pairs of triangles has a point in common. The blade counts as displaced by (eps,
/// eps^2, eps^3): it meets a link that it touches from one side only, and none that it moves along.
bool meet(const Sweep& link, const Sweep& segment);

/// A blade at a moment of a step: a chain of points, with a straight segment from each to the next.
struct BladeAt {
  double fraction;    ///< of the step: 0 at its beginning, 1 at its end
  PointArray points;  ///< [m]
};

/// Which joints of a body a blade opens: those that have a link that meets the blade.             theory.md section 10
///
/// A joint's links lead from the centre of its lowest hexahedron to those of the others; a centre is the mean of the
/// corners. Centres and blade are rounded to a lattice of 2^-32 of the initial mesh's box, and what meets is decided
/// exactly. So no link is missed or met twice between steps that begin where the one before ended, and a blade that
/// passes the whole body separates it.
///
/// Lines whose ends move differently bend within a step, away from the triangles by a quarter of the difference of the
/// displacements. The step is divided into parts in which that is below a tenth of the mean link.
class BladeCut {
 public:
  BladeCut(const HexMesh& initial, const Joints& joints);

  /// The joints that a blade opens in a step, ascending.
  ///   hexahedra: present corners. x_before, x_after: [m] present nodes at the beginning and at the end of the step.
  ///   blade: at moments of the step, ascending, the first with fraction 0, the last with fraction 1; between them its
  ///          points move straight.
  ///   is_open: per joint, not 0 where it is open already.
  /// Throws InputError for points that are not finite, or farther away than 10^8 times the longest side of the initial
  /// mesh's box.
  const std::vector<int>& opened(std::span<const Hexahedron> hexahedra, ConstPoints x_before, ConstPoints x_after,
                                 std::span<const BladeAt> blade, std::span<const unsigned char> is_open);

  /// Where the blade met them in that call: from the centre of the joint's lowest hexahedron (0) to that of the next
  /// one (1). Found in floating-point numbers, to about a hundredth; of a blade along the link it is the middle.
  const std::vector<double>& crossings() const { return crossings_; }

  double tolerance() const;  ///< [m] that tenth

 private:
  struct Link {
    int joint, first, second;  // hexahedra
  };

  Sweep::Point on_lattice(const Vec3& position, const char* whose, Eigen::Index number) const;
  Sweep::End centre(const Hexahedron& corners, Eigen::Index number, ConstPoints x_before, ConstPoints x_after) const;
  void find_near(std::span<const Hexahedron> hexahedra, ConstPoints x_before, ConstPoints x_after,
                 const Eigen::AlignedBox3d& blade, std::span<const unsigned char> is_open);
  void cut(double from, double to);

  Vec3 origin_ = Vec3::Zero();  // [m]
  double spacing_ = 1;          // [m]
  double mean_length_ = 0;      // of links, in spacings
  std::vector<Link> links_;     // in the order of their joints

  // of the last call, kept for their memory
  std::vector<Sweep::Point> points_;  // of the blade, moment after moment
  std::vector<Sweep::End> chain_;     // between two moments
  std::vector<Sweep::End> chain_part_;
  std::vector<unsigned char> beyond_of_node_, beyond_;  // a bit for each side of the blade's box; per hexahedron
  std::vector<Link> near_;
  std::vector<unsigned char> is_at_near_link_;  // per hexahedron
  std::vector<Sweep::End> centres_;             // of these
  std::vector<std::pair<int, double>> met_;     // joints, and where
  std::vector<int> opened_;
  std::vector<double> crossings_;
};

}  // namespace hexaplast
