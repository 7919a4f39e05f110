// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/pick.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/geometry/plane_cut.hpp"
#include "picture/gallery.hpp"
#include "picture/surface.hpp"
#include "view/source.hpp"

namespace hexaplast::view {

/// Which shape stands behind the body.
enum class Ghost { kNone, kInitial, kPlasticRest };

/// What is drawn of the body.
struct Look {
  bool shows_embedded_surfaces = true;  ///< where the scene has some; otherwise the faces of the hexahedra
  bool shows_edges = true;              ///< of the hexahedra
  Ghost ghost = Ghost::kInitial;
  bool shows_instruments = true;
  std::optional<Plane> cut = {};  ///< what lies above it is left out; hexahedra are shown then, surfaces have no inside
};

/// The triangles, lines and points that show a snapshot, and what the mouse meets.
class Figure {
 public:
  struct Vertex {
    Eigen::Vector3f place;   ///< [m]
    Eigen::Vector3f normal;  ///< unit vector
    float value = 0;         ///< of the quantity shown
  };

  /// The mesh must outlive the figure. Throws what Embedding throws.
  Figure(const HexMesh& mesh, output::Staging staging);

  bool has_embedded_surfaces() const { return !embedded_surfaces_.empty(); }
  bool shows_embedded_surfaces() const { return shows_embedded_surfaces_; }
  const output::Staging& staging() const { return staging_; }

  /// The largest forces that are shown [N]: their arrows are the longest. Of a kind that has none no arrow is drawn.
  struct Strongest {
    double load = 0, tool = 0;
  };

  /// Shows another moment.
  void update(const Snapshot& snapshot, const Look& look, const Strongest& strongest);

  const std::vector<Vertex>& triangles() const { return triangles_; }   ///< three of them each
  const std::vector<Eigen::Vector3f>& edges() const { return edges_; }  ///< two places each
  const std::vector<Eigen::Vector3f>& ghost_triangles() const { return ghost_triangles_; }
  double edge_length() const { return body_.surface->mean_edge(); }  ///< [m] mean of the hexahedra that are left
  const std::vector<Eigen::Vector3f>& fixed_places() const { return fixed_places_; }
  const std::vector<Vertex>& tool_triangles() const { return tool_triangles_; }
  const std::vector<Vertex>& load_arrows() const { return load_arrows_; }
  const std::vector<Vertex>& tool_arrows() const { return tool_arrows_; }  ///< seen also where they lie within tissue
  const std::vector<Eigen::Vector3f>& taut_springs() const { return taut_springs_; }    ///< two places each
  const std::vector<Eigen::Vector3f>& slack_springs() const { return slack_springs_; }  ///< two places each
  const Eigen::AlignedBox3d& box() const { return box_; }                               ///< [m] of the body

  /// Two places each: what a viewer in direction `towards` sees as the outlines of the ghost, and of instruments.
  std::vector<Eigen::Vector3f> ghost_outline(const Vec3& towards) const { return outline(ghosts_, towards); }
  std::vector<Eigen::Vector3f> tool_outline(const Vec3& towards) const { return outline(shown_tools_, towards); }

  /// Where an instrument's arrow ends [m], and its force [N].
  struct Force {
    Vec3 tip;
    double size = 0;
  };
  const std::vector<Force>& tool_forces() const { return tool_forces_; }
  const std::vector<Vec3>& rings() const { return rings_; }  ///< [m] instruments that have no shape

  /// What was cut out: the triangles and edges above are to be clipped by the plane, these are not.
  const std::optional<Plane>& cut() const { return cut_; }
  const std::vector<Vertex>& cut_triangles() const { return cut_triangles_; }
  const std::vector<Eigen::Vector3f>& cut_edges() const { return cut_edges_; }  ///< inside its border
  const std::vector<Eigen::Vector3f>& cut_outline() const { return cut_outline_; }

  /// Smallest and largest value shown; empty where the quantity has none (yield stress of what never yields).
  const Eigen::AlignedBox1d& range() const { return range_; }

  /// What a ray first meets of what is shown.
  struct Seen {
    Vec3 place;           ///< [m]
    Vec3 outwards;        ///< unit vector, away from the body
    double distance = 0;  ///< [m] from the origin of the ray
    int hexahedron = 0;   ///< of the mesh, where it is met
  };
  std::optional<Seen> hit(const Ray& ray) const;

 private:
  using Places = std::vector<Eigen::Vector3f>;
  using Face = output::Surface::Face;

  /// An embedded surface, or the boundary of the hexahedra, which needs no embedding.
  struct Sheet {
    std::optional<Embedding> embedding = {};
    PointArray original = {};  // [m]
    std::vector<Face> faces = {};
    std::unique_ptr<output::Surface> surface = {};  // of the faces that are left
    PointArray points = {};                         // [m] at the latest update
  };

  /// A surface at the latest update.
  struct Shape {
    const output::Surface* surface;
    Places points;  // [m]
  };

  static Places outline(const std::vector<Shape>& shapes, const Vec3& towards);
  void leave(std::span<const unsigned char> alive);  // only what is alive
  void place(Sheet& sheet, ConstPoints nodes) const;
  void draw(const Sheet& sheet, std::span<const double> nodal_values);
  std::optional<Seen> hit(const Sheet& sheet, const Ray& ray) const;
  std::optional<Seen> hit_below(const Plane& cut, const Ray& ray) const;
  int nearest_hexahedron(const Vec3& place) const;
  int hexahedron_at(const Sheet& sheet, const Face& face) const;
  void draw_cut(ConstPoints positions, std::span<const double> nodal_values, bool shows_edges);
  void draw_tools(const std::vector<output::Instrument>& instruments);
  void draw_forces(const Snapshot& snapshot, const Strongest& strongest);
  void draw_ghost(Sheet& sheet, ConstPoints nodes);

  const HexMesh& mesh_;
  output::Staging staging_;
  std::vector<unsigned char> alive_;
  Sheet body_;
  std::vector<Sheet> embedded_surfaces_;
  bool shows_embedded_surfaces_ = false;

  struct Tool {
    std::vector<Triangle> triangles;
    std::unique_ptr<output::Surface> surface;
  };
  std::map<int, Tool> tools_;  // by the number of the instrument

  std::optional<Plane> cut_;
  PointArray cut_points_;  // [m]
  std::vector<Triangle> cut_faces_;
  std::vector<Vertex> triangles_, tool_triangles_, cut_triangles_, load_arrows_, tool_arrows_;
  Places edges_, cut_edges_, cut_outline_, ghost_triangles_, fixed_places_, taut_springs_, slack_springs_;
  std::vector<Shape> ghosts_, shown_tools_;
  std::vector<Force> tool_forces_;
  std::vector<Vec3> rings_;
  Eigen::AlignedBox3d box_;
  Eigen::AlignedBox1d range_;
};

}  // namespace hexaplast::view
