// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/geometry/plane_cut.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/arrow.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/camera.hpp"
#include "picture/embedded_surface.hpp"
#include "picture/page.hpp"
#include "picture/quantity.hpp"
#include "picture/renderer.hpp"
#include "picture/surface.hpp"

namespace hexaplast::output {

/// What pictures of a body show besides its state, and from where.
struct Staging {
  std::vector<EmbeddedSurface> embedded_surfaces;  ///< shown in place of the hexahedra
  bool shows_hexahedra = true;                     ///< beside embedded surfaces: as edges
  bool shows_edges = true;                         ///< those of hexahedra
  bool is_wireframe = false;                       ///< edges in colours, and nothing else
  bool shows_loads = true;                         ///< as arrows
  Vec3 gravity = Vec3::Zero();                     ///< [m/s^2] its direction is shown where it is not 0
  std::optional<Viewpoint> viewpoint;              ///< none: beside the long axis, and above
  Quantity quantity = Quantity::kPlasticStrain;
  std::optional<std::pair<double, double>> range;  ///< of the colours, ascending; none: of what is shown
  std::optional<Plane> cut;             ///< what lies on the viewer's side of it is left out; either side may be above
  std::string ghost = "initial shape";  ///< name of the pale shape behind; empty: there is none
  int width = 1280, height = 720;       ///< [pixels]
};

/// Enough decimals to tell the times of neighbouring steps apart, and not fewer than people expect of seconds. dt: [s]
int time_decimals(double dt);

/// Collects states of a run and shows them: the smooth-shaded surface of the hexahedra with their edges, or the
/// embedded surfaces that are embedded in them, coloured by a quantity. Values of hexahedra are averaged at nodes and
/// blended between them. Fixed nodes are dots, springs lines, instruments their shapes, or rings if they have none, and
/// all forces arrows. All pictures share one camera, fitted to every state collected, one colour scale and one length
/// of arrows per newton; that is why states are kept (in single precision, surface only) until the run is over.
class Gallery {
 public:
  /// title: shown in every picture. time_decimals: of the time stamps. The mesh must outlive the gallery. Throws
  /// InputError or NumericalError where a surface cannot be embedded.
  Gallery(const HexMesh& mesh, std::string title, int time_decimals, Staging staging = {});

  /// positions: num_nodes x 3 [m]; values: of the quantity, one per hexahedron or per node; alive, if not empty: one
  /// per hexahedron, 0 for those that are removed and not shown, and neither is what is embedded in them; conditions:
  /// what holds and loads the body; ghost: nodes of the pale shape [m], null: the initial positions.
  void add(long step, double time, ConstPoints positions, const std::vector<double>& values,
           std::span<const unsigned char> alive = {}, const BoundaryConditions& conditions = {},
           const PointArray* ghost = nullptr);

  int num_states() const { return static_cast<int>(states_.size()); }
  long step(int state) const { return states_[state].step; }

  /// Drawings of all states, one after the other: draw(state, drawing) is called in the order of their steps.
  template <class Draw>
  void for_each_drawing(const Draw& draw) const {
    if (states_.empty()) return;
    Camera camera(viewpoint_);
    Scale scale(staging_.quantity, staging_.range);
    Strongest strongest = strongest_forces();
    fit(camera, scale, strongest);
    for (int s = 0; s < num_states(); ++s) draw(s, drawing(states_[s], camera, scale, strongest));
  }

 private:
  using Places = std::vector<Eigen::Vector3f>;

  /// What an embedded surface's points are, and who moves them.
  struct CarriedSurface {
    Embedding embedding;
    std::vector<Surface::Face> faces;
    std::shared_ptr<const Surface> whole;
  };

  /// The boundary of the hexahedra that are left, by itself: points are those nodes that lie on it.
  struct Boundary {
    Boundary(const HexMesh& mesh, std::span<const unsigned char> alive);
    Places points_at(ConstPoints positions) const;  ///< [m]

    std::vector<int> node_of_point;
    std::shared_ptr<const Surface> surface;
  };

  /// A surface at a moment.
  struct Shown {
    std::shared_ptr<const Surface> surface;  // shared by all states between two removals
    Places points;                           // [m]
    std::vector<float> values;               // one per point
  };

  /// Where the body is cut through.
  struct CutFace {
    Places points;  // [m]
    std::vector<float> values;
    std::vector<Triangle> triangles;
    std::vector<Edge> inner_lines, outline;
  };

  /// A force at a node.
  struct Load {
    int node = 0;
    Eigen::Vector3f place;     // [m]
    Eigen::Vector3f force;     // [N]
    Eigen::Vector3f outwards;  // of the body's surface, any length; 0 inside
  };

  /// An instrument and its force on the body.
  struct Tool {
    Eigen::Vector3f place;                   // [m] where its force acts, or where it is
    Eigen::Vector3f force;                   // [N]
    std::shared_ptr<const Surface> surface;  // null: it has no shape
    Places points;                           // [m]
  };

  /// A spring [m].
  struct Spring {
    Eigen::Vector3f from, to;
    bool is_slack;
  };

  /// The largest forces of all states [N]: their arrows are the longest.
  struct Strongest {
    float load = 0, tool = 0;
    float arrow = 0;  // [m] length of the longest arrow
  };

  struct State {
    long step = 0;
    double time = 0;  // [s]
    Shown body;
    std::vector<Shown> embedded_surfaces;
    std::vector<Shown> ghosts;  // without values
    CutFace cut;
    Places fixed;  // [m]
    std::vector<Load> loads;
    std::vector<Tool> tools;
    std::vector<Spring> springs;
  };

  bool shows_cage() const { return !embedded_surfaces_.empty() && staging_.shows_hexahedra; }
  bool shows_body() const { return embedded_surfaces_.empty() && staging_.shows_hexahedra; }

  void follow(std::span<const unsigned char> alive);
  std::vector<Shown> ghosts_at(const PointArray* nodes) const;
  std::vector<Load> loads_of(const BoundaryConditions& conditions, ConstPoints positions,
                             std::span<const unsigned char> alive) const;
  Tool tool_of(const Instrument& instrument, ConstPoints positions);
  CutFace cut_face(ConstPoints positions, const PointArray& values, std::span<const unsigned char> alive) const;

  std::vector<const Shown*> shown_in(const State& state) const;  // filled, not as edges
  std::vector<Plane> sides(const Camera& camera) const;
  Strongest strongest_forces() const;
  std::optional<Arrow> arrow_of(const Load& load, const Strongest& strongest) const;
  std::optional<Arrow> arrow_of(const Tool& tool, const Strongest& strongest) const;
  Eigen::AlignedBox3f surroundings() const;
  void fit(Camera& camera, Scale& scale, Strongest& strongest) const;
  void see_arrows(Camera& camera, const Strongest& strongest) const;

  Drawing drawing(const State& state, const Camera& camera, const Scale& scale, const Strongest& strongest) const;
  void draw_ghosts(const State& state, const Camera& camera, Drawing& picture) const;
  void draw_surfaces(const State& state, const Camera& camera, const Scale& scale, Drawing& picture) const;
  void draw_tools(const State& state, const Camera& camera, Drawing& picture) const;
  void draw_springs(const State& state, const Camera& camera, Drawing& picture) const;
  void draw_edges(const State& state, const Camera& camera, Drawing& picture) const;
  void draw_wires(const State& state, const Camera& camera, const Scale& scale, Drawing& picture) const;
  void draw_loads(const State& state, const Camera& camera, const Strongest& strongest, Drawing& picture) const;
  void draw_marks(const State& state, const Camera& camera, Page& page) const;
  std::vector<Key> keys_of_shapes(const Scale& scale) const;
  std::vector<Key> keys_of_forces(const State& state, const Camera& camera, const Strongest& strongest) const;

  const HexMesh& mesh_;
  std::string title_;
  int time_decimals_;
  Staging staging_;
  Viewpoint viewpoint_;
  float longest_arrow_;  // [m]
  std::vector<CarriedSurface> embedded_surfaces_;
  std::shared_ptr<const Boundary> original_, current_;
  std::vector<std::shared_ptr<const Surface>> current_embedded_surfaces_;
  std::map<int, std::shared_ptr<const Surface>> tools_;  // by the number of the instrument, as it was last
  std::vector<unsigned char> current_alive_;             // that current_ belongs to; empty: all
  std::vector<State> states_;
};

}  // namespace hexaplast::output
