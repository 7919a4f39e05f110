// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"
#include "output/renderer.hpp"

namespace hexaplast::output {

/// Collects states of a run and shows them: the shaded surface with its element edges, coloured per hexahedron by
/// plastic strain. All pictures share one camera, fitted to every state collected, and one colour scale, from 0 to the
/// greatest plastic strain among them; that is why states are kept (in single precision, surface only) until the run is
/// over.
class Gallery {
 public:
  static constexpr int kWidth = 1280, kHeight = 720;  // [pixels]

  /// title: shown in every picture. time_decimals: of the time stamps. The mesh must outlive the gallery.
  Gallery(const HexMesh& mesh, std::string title, int time_decimals);

  /// positions: num_nodes x 3 [m]; plastic_strain: one per hexahedron [-]; alive, if not empty: one per hexahedron, 0
  /// for those that are removed and not shown.
  void add(long step, double time, ConstPoints positions, const std::vector<double>& plastic_strain,
           std::span<const unsigned char> alive = {});

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
  /// The boundary of the hexahedra that are left, by itself: points are those nodes that lie on it.
  struct Surface {
    Surface(const HexMesh& mesh, std::span<const unsigned char> alive);

    std::vector<Eigen::Vector3f> points_at(ConstPoints positions) const;  ///< [m]
    std::vector<Eigen::Vector3f> face_normals(
        const std::vector<Eigen::Vector3f>& points) const;  ///< twice the area long

    std::vector<int> node_of_point;
    std::vector<std::array<int, 4>> faces;  // points, counter-clockwise seen from outside
    std::vector<int> element_of_face;
    std::vector<std::vector<int>> faces_of_point;
    std::vector<std::array<int, 2>> edges;    // points, each edge once
    std::vector<std::array<int, 2>> creases;  // edges at which the original surface has a corner
    std::vector<Eigen::Vector3f> original;    // [m] original positions of the points
  };

  struct State {
    long step = 0;
    double time = 0;                         // [s]
    std::shared_ptr<const Surface> surface;  // shared by all states between two removals
    std::vector<Eigen::Vector3f> points;     // [m] one per surface point
    std::vector<float> plastic_strain;       // one per face, of the hexahedron behind it
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

  View fitted_view() const;
  Drawing drawing(const State& state, const View& view) const;
  void draw_body(const State& state, const View& view, Drawing& picture) const;
  void draw_original(const View& view, Drawing& picture) const;

  const HexMesh& mesh_;
  std::string title_;
  int time_decimals_;
  int long_axis_;
  std::shared_ptr<const Surface> original_, current_;
  std::vector<unsigned char> current_alive_;  // that current_ belongs to; empty: all
  std::vector<State> states_;
};

}  // namespace hexaplast::output
