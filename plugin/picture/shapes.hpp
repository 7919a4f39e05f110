// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hexaplast/geometry/cut_surface.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/arrow.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/camera.hpp"
#include "picture/embedded_surface.hpp"
#include "picture/geometry.hpp"
#include "picture/picture_cut.hpp"
#include "picture/quantity.hpp"
#include "picture/regions.hpp"
#include "picture/surface.hpp"

namespace hexaplast::output {

/// What pictures of a body show besides its state, and from where.
struct Staging : PictureRecord {
  std::vector<EmbeddedSurface> embedded_surfaces;  ///< shown in place of the hexahedra
  bool shows_surfaces = true;                      ///< the embedded ones; else the hexahedra
  bool shows_edges = true;                         ///< those of hexahedra
  Quantity quantity = Quantity::kPlasticStrain;
  Regions regions;                                 ///< of the hexahedra
  std::vector<int> shown_regions;                  ///< within the body, which is translucent; empty: the body is shown
  std::optional<std::pair<double, double>> range;  ///< of the colours, ascending; none: of what is shown
  std::optional<Plane> cut;             ///< what lies on the viewer's side of it is left out; either side may be above
  std::string ghost = "initial shape";  ///< name of the pale shape behind; empty: there is none
  int width = 1280, height = 720;       ///< [pixels]

  /// Upwards: as asked for, else against gravity, else to the head of a patient, else y.
  Vec3 upright() const;

  /// From where a mesh is seen: the viewpoint, or beside the long axis.
  Viewpoint seen_from(const HexMesh& mesh) const;

  bool has_surfaces() const { return shows_surfaces && !embedded_surfaces.empty(); }
  bool shows_body() const { return !has_surfaces() && shows_hexahedra; }

  /// Behind a translucent body it would not be told from what lies within.
  bool shows_ghost() const { return !ghost.empty() && shown_regions.empty(); }

  /// Colours stand for regions.
  bool shows_numbers() const { return quantity == Quantity::kRegion && !regions.names.empty(); }

  /// What is shown by itself: the regions that are asked for, or where colours stand for them all, and 0 for the rest.
  std::vector<int> parts() const;
};

/// What is shown of a body at a moment: in single precision and of its surface only, so that many can be kept.
struct Moment {
  using Places = std::vector<Eigen::Vector3f>;

  struct Shown {
    std::shared_ptr<const Surface> surface;  ///< shared by all moments between two removals
    Places points;                           ///< [m]
    std::vector<float> values;               ///< one per point
  };

  /// A force at a node.
  struct Load {
    Eigen::Vector3f place;     ///< [m]
    Eigen::Vector3f force;     ///< [N]
    Eigen::Vector3f outwards;  ///< of the body's surface, any length; 0 inside
  };

  /// An instrument and its force on the body.
  struct Tool {
    Eigen::Vector3f place;                   ///< [m] where its force acts, or where it is
    Eigen::Vector3f force;                   ///< [N]
    std::shared_ptr<const Surface> surface;  ///< null: it has no shape
    Places points;                           ///< [m]
  };

  Shown body;
  std::vector<Shown> embedded_surfaces;
  std::vector<Shown> parts;   ///< of the body, shown in its place or within it
  std::vector<Shown> ghosts;  ///< without values
  CutFace cut;
  Places fixed;  ///< [m]
  std::vector<Load> loads;
  std::vector<Tool> tools;
  std::vector<SpringLine> springs;

  /// The whole body, and those that are filled and coloured.
  std::vector<const Shown*> whole(const Staging& staging) const;
  std::vector<const Shown*> filled(const Staging& staging) const;
};

/// Which forces the longest arrows stand for.
struct Strongest {
  float load = 0, tool = 0;  ///< [N] where there are none no arrow is drawn
  float arrow = 0;           ///< [m] the longest
  float girth = 0;           ///< [m] of all arrows

  /// A load that presses on the surface points at its place from outside, any other starts there.
  std::optional<Arrow> arrow_of(const Moment::Load& load) const;

  /// It starts where the force acts.
  std::optional<Arrow> arrow_of(const Moment::Tool& tool) const;
};

/// A body and the surfaces embedded in it, as they are shown: follows what is removed, and where the rest goes.
class Shapes {
 public:
  /// The boundary of the hexahedra that are left, by itself: points are those nodes that lie on it; walls of cuts are
  /// smooth.
  struct Boundary {
    Boundary(const HexMesh& mesh, std::span<const unsigned char> alive, const CutWalls* walls = nullptr);

    PointArray points_at(ConstPoints nodes) const;  ///< [m]

    std::vector<int> node_of_point;
    std::shared_ptr<const Surface> surface;
    std::vector<int> wall_points;  ///< which lie elsewhere than their nodes:
    std::optional<Embedding> walls;
  };

  /// An embedded surface, and what is left of it: cut where the hexahedra are.
  struct Carried {
    Embedding original, embedding;
    std::shared_ptr<const Surface> whole, current;
  };

  /// The mesh must outlive this object. Throws InputError or NumericalError where a surface cannot be embedded.
  Shapes(const HexMesh& mesh, Staging staging);

  const HexMesh& mesh() const { return mesh_; }
  const Boundary& original() const { return *original_; }
  const Boundary& current() const { return *current_; }
  const std::vector<Carried>& embedded_surfaces() const { return embedded_surfaces_; }
  float longest_arrow() const { return longest_arrow_; }  ///< [m]

  /// positions: num_nodes x 3 [m]; values: of the quantity, one per node; alive, if not empty: one per hexahedron, 0
  /// for those that are removed and not shown, and neither is what is embedded in them; conditions: what holds and
  /// loads the body; ghost: nodes of the pale shape [m], null: the initial positions; open: of the hexahedra, null:
  /// none are open, or their walls are drawn as they are.
  Moment at(ConstPoints positions, std::span<const double> values, std::span<const unsigned char> alive,
            const BoundaryConditions& conditions, const PointArray* ghost,
            const std::shared_ptr<const OpenFaces>& open = nullptr);

  /// A moment as a fitted camera sees it.
  Geometry geometry(const Moment& moment, const Camera& camera, const Strongest& strongest) const;

  Staging staging;  ///< may change between two moments, but for the embedded surfaces

 private:
  /// A region, or what is in none.
  struct Part {
    int number;
    Boundary hexahedra;
    std::vector<std::shared_ptr<const Surface>> embedded_surfaces;  ///< what of them it carries
  };

  void follow(std::span<const unsigned char> alive, const std::shared_ptr<const OpenFaces>& open);
  void carry(std::span<const unsigned char> alive, const CutWalls* walls);
  void divide(std::span<const unsigned char> alive);
  void add_parts(ConstPoints positions, std::span<const double> values, Moment& moment) const;
  std::vector<Moment::Shown> ghosts_at(const PointArray* nodes) const;
  std::vector<Moment::Load> loads_of(const BoundaryConditions& conditions, ConstPoints positions,
                                     std::span<const unsigned char> alive) const;
  Moment::Tool tool_of(const Instrument& instrument, ConstPoints positions);
  void draw_surface(const Moment::Shown& shown, float scale, Geometry::Vertices& vertices,
                    Geometry::Vertices& walls) const;

  const HexMesh& mesh_;
  float longest_arrow_;                                             // [m]
  std::vector<Hexahedron> original_hexahedra_, current_hexahedra_;  // until nodes split they are the same
  std::vector<Carried> embedded_surfaces_;
  std::shared_ptr<const Boundary> original_, current_;
  std::map<int, std::shared_ptr<const Surface>> tools_;  // by the number of the instrument, as it was last
  std::vector<unsigned char> current_alive_;             // that current_ belongs to; empty: all
  std::shared_ptr<const OpenFaces> current_open_;        // and null: none
  std::vector<Part> parts_;
  std::shared_ptr<const Boundary> parts_of_;  // that they are parts of
};

}  // namespace hexaplast::output
