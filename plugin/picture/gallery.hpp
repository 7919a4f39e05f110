// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "picture/page.hpp"
#include "picture/renderer.hpp"
#include "picture/shapes.hpp"

namespace hexaplast::output {

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
  /// what holds and loads the body; ghost: nodes of the pale shape [m], null: the initial positions; open: faces
  /// between hexahedra, null: none.
  void add(long step, double time, ConstPoints positions, const std::vector<double>& values,
           std::span<const unsigned char> alive = {}, const BoundaryConditions& conditions = {},
           const PointArray* ghost = nullptr, const std::shared_ptr<const OpenFaces>& open = nullptr);

  int num_states() const { return static_cast<int>(states_.size()); }
  long step(int state) const { return states_[state].step; }

  /// Drawings of all states, one after the other: draw(state, drawing) is called in the order of their steps.
  template <class Draw>
  void for_each_drawing(const Draw& draw) const {
    if (states_.empty()) return;
    Camera camera(viewpoint_);
    Scale scale(shapes_.staging.quantity, shapes_.staging.range, shapes_.staging.regions.names);
    Strongest strongest = strongest_forces();
    const Eigen::AlignedBox3f room = surroundings();
    fit(camera, scale, strongest, room);
    for (int s = 0; s < num_states(); ++s) draw(s, drawing(states_[s], camera, scale, strongest, room));
  }

 private:
  struct State : Moment {
    long step = 0;
    double time = 0;  // [s]
  };

  Strongest strongest_forces() const;
  Eigen::AlignedBox3f surroundings() const;
  void fit(Camera& camera, Scale& scale, Strongest& strongest, const Eigen::AlignedBox3f& room) const;
  void see_arrows(Camera& camera, const Strongest& strongest) const;

  Drawing drawing(const State& state, const Camera& camera, const Scale& scale, const Strongest& strongest,
                  const Eigen::AlignedBox3f& room) const;
  std::vector<Key> keys_of_shapes(const Scale& scale) const;
  std::vector<Key> keys_of_forces(const State& state, const Camera& camera, const Strongest& strongest) const;

  std::string title_;
  int time_decimals_;
  Shapes shapes_;
  Viewpoint viewpoint_;
  std::vector<State> states_;
};

}  // namespace hexaplast::output
