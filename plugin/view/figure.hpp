// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "geometry/pick.hpp"
#include "picture/page.hpp"
#include "picture/shapes.hpp"
#include "view/camera.hpp"
#include "view/snapshot.hpp"

namespace hexaplast::view {

/// Which shape stands behind the body.
enum class Ghost { kNone, kInitial, kPlasticRest };

/// What is drawn of the body.
struct Look {
  bool shows_embedded_surfaces = true;  ///< where the scene has some; otherwise the faces of the hexahedra
  bool shows_edges = true;              ///< of the hexahedra
  Ghost ghost = Ghost::kInitial;
  bool shows_instruments = true;  ///< and loads, and what is fixed
  std::optional<Plane> cut = {};  ///< what lies above it is left out
  std::vector<int> regions = {};  ///< that are shown within the body, which is translucent; empty: the body is

  /// Of a snapshot: what is shown of its conditions, and the nodes of the ghost.
  output::BoundaryConditions conditions(const Snapshot& snapshot) const;
  const PointArray* ghost_nodes(const Snapshot& snapshot) const;
};

/// What the window shows of a snapshot, and what the mouse meets.
class Figure {
 public:
  /// The mesh must outlive the figure. Throws what Embedding throws.
  Figure(const HexMesh& mesh, output::Staging staging) : shapes_(mesh, std::move(staging)) {}

  bool has_embedded_surfaces() const { return !shapes_.staging.embedded_surfaces.empty(); }
  const output::Staging& staging() const { return shapes_.staging; }

  /// Shows another moment. strongest: the forces that the longest arrows stand for.
  void update(const Snapshot& snapshot, const Look& look, const output::Strongest& strongest);

  /// It, as a camera sees it.
  output::View view(const Camera& camera, const output::Scale& scale) const;

  const Eigen::AlignedBox3d& box() const { return box_; }  ///< [m] of the body

  /// Where an instrument's arrow ends [m], and its force [N].
  struct Force {
    Vec3 tip;
    double size = 0;
  };
  std::vector<Force> tool_forces() const;
  std::vector<Vec3> rings() const;  ///< [m] instruments that have no shape

  void see_values(output::Scale& scale) const;  ///< those that are shown

  /// What a ray first meets of what is shown.
  struct Seen {
    Vec3 place;            ///< [m]
    Vec3 outwards;         ///< unit vector, away from the body
    double distance = 0;   ///< [m] from the origin of the ray
    int hexahedron = 0;    ///< of the mesh, where it is met
    bool is_back = false;  ///< of the surface, met from inside
  };
  std::optional<Seen> hit(const Ray& ray) const;

 private:
  std::optional<Seen> hit(const output::Surface& surface, ConstPoints points, const Ray& ray) const;
  std::optional<Seen> hit_surfaces(const Ray& ray) const;
  std::optional<Seen> hit_body(const Ray& ray) const;
  std::optional<Seen> hit_below(const Plane& cut, const Ray& ray) const;
  int nearest_hexahedron(const Vec3& place) const;
  int hexahedron_at(const output::Surface::Face& face) const;

  output::Shapes shapes_;
  output::Moment moment_;
  output::Strongest strongest_;
  PointArray nodes_;                  // [m]
  std::vector<unsigned char> alive_;  // per hexahedron
  Eigen::AlignedBox3d box_;
};

}  // namespace hexaplast::view
