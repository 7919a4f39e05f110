// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/mesh/embed.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "output/renderer.hpp"
#include "output/surface.hpp"

namespace hexaplast::output {

/// A surface that moves with the hexahedra of a body.
struct Skin {
  PointArray points;  ///< any number x 3 [m], in the body's original positions
  std::vector<Triangle> triangles;
  std::vector<Quad> quads;
};

/// What pictures of a body show besides its state, and from where.
struct Staging {
  std::vector<Skin> skins;       ///< shown in place of the hexahedra
  bool shows_hexahedra = true;   ///< beside skins: as edges
  std::vector<int> fixed_nodes;  ///< marked by dots
  std::optional<Vec3> towards;   ///< the direction in which the viewer stands; none: beside the long axis, and above
};

/// Collects states of a run and shows them: the smooth-shaded surface of the hexahedra with their edges, or the skins
/// that are embedded in them, coloured by plastic strain. Strain is averaged at nodes and blended between them. All
/// pictures share one camera, fitted to every state collected, and one colour scale, from 0 to the greatest plastic
/// strain shown; that is why states are kept (in single precision, surface only) until the run is over.
class Gallery {
 public:
  static constexpr int kWidth = 1280, kHeight = 720;  // [pixels]

  /// title: shown in every picture. time_decimals: of the time stamps. The mesh must outlive the gallery. Throws
  /// InputError or NumericalError where a skin cannot be embedded.
  Gallery(const HexMesh& mesh, std::string title, int time_decimals, Staging staging = {});

  /// positions: num_nodes x 3 [m]; plastic_strain: one per hexahedron [-]; alive, if not empty: one per hexahedron, 0
  /// for those that are removed and not shown, and neither is what is embedded in them; instruments: where those are
  /// that hold something [m].
  void add(long step, double time, ConstPoints positions, const std::vector<double>& plastic_strain,
           std::span<const unsigned char> alive = {}, std::span<const Vec3> instruments = {});

  int num_states() const { return static_cast<int>(states_.size()); }
  long step(int state) const { return states_[state].step; }

  /// Drawings of all states, one after the other: draw(state, drawing) is called in the order of their steps.
  template <class Draw>
  void for_each_drawing(const Draw& draw) const {
    if (states_.empty()) return;
    const View view = fitted_view();
    for (int s = 0; s < num_states(); ++s) draw(s, drawing(states_[s], view));
  }

 private:
  using Places = std::vector<Eigen::Vector3f>;

  /// What a skin's points are, and who moves them.
  struct EmbeddedSkin {
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
    std::vector<float> strain;               // [-] one per point
  };

  struct State {
    long step = 0;
    double time = 0;  // [s]
    Shown body;
    std::vector<Shown> skins;
    Places fixed, instruments;  // [m]
  };

  /// An orthographic camera, and the colour scale.
  struct View {
    Eigen::Vector3f right, up, towards;  // unit vectors; `towards` points at the viewer
    Eigen::Vector2f centre;              // [m] along right and up, of what is shown
    float pixels_per_metre = 1;
    float nearest = 0, farthest = 1;  // [m] along `towards`
    float greatest_strain = 0;

    Drawing::Vertex project(const Eigen::Vector3f& point) const;
  };

  bool shows_cage() const { return !skins_.empty() && staging_.shows_hexahedra; }
  bool shows_body() const { return skins_.empty() && staging_.shows_hexahedra; }

  std::vector<const Shown*> shown_in(const State& state) const;  // filled, not as edges
  View fitted_view() const;
  Drawing drawing(const State& state, const View& view) const;
  void draw_original(const View& view, Drawing& picture) const;
  void draw_surfaces(const State& state, const View& view, Drawing& picture) const;
  void draw_edges(const State& state, const View& view, Drawing& picture) const;
  void draw_marks(const State& state, const View& view, Drawing& picture) const;
  void draw_keys(Drawing& picture) const;

  const HexMesh& mesh_;
  std::string title_;
  int time_decimals_;
  int long_axis_;
  Staging staging_;
  std::vector<EmbeddedSkin> skins_;
  std::shared_ptr<const Boundary> original_, current_;
  std::vector<std::shared_ptr<const Surface>> current_skins_;
  std::vector<unsigned char> current_alive_;  // that current_ belongs to; empty: all
  std::vector<State> states_;
};

}  // namespace hexaplast::output
