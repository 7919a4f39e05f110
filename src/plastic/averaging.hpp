// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/plastic/flow_report.hpp"
#include "plastic/averaging_pass.hpp"

namespace hexaplast {

inline constexpr int kAveragingIterations = 10000;  ///< of the linear solver, after which it gives up
inline constexpr double kFitted = 1e-26;            ///< E below this fraction of sum |t|^2 is rounding

/// Rest-shape averaging: the joined positions x that fit the isolated rest shapes y best (theory.md section 5.5).
///
///   E(x) = sum_k min_Pi sum_i |Pi y_i - (x_i - c_k(x))|^2          c_k: mean of the element's corners      (eq. 30)
///
/// Gauss-Newton: with t_i = Pi y_i for the best rotations at the old x, solve
///
///   (H + 1e-7 P) dx = -g,   H_k = P - B (B^T B)^-1 B^T,   g = assembled x_i - c_k - t_i                    (eq. 31)
///
/// P removes an element's mean, B the infinitesimal rotations of x - c: a turn of a whole connected part is in neither
/// H nor g, and is taken out of dx. The local/global step solves P dx = -g. Every connected part keeps the mean of its
/// nodes.
class Averaging {
 public:
  explicit Averaging(const Model& model);

  /// Moves history.plastic_rest_positions by settings.averaging_steps steps. history.rotation_map becomes the best
  /// rotations at the new positions; a local/global step keeps those that it started from. changed: per element, not 0
  /// where the rest shape is another than before; parts without such an element keep their bits. Empty: all parts move.
  AveragingReport advance(const Model& model, LinearSolver& solver, History& history,
                          std::span<const unsigned char> changed = {});

  /// Connected parts of the elements that are alive in `history`, found anew when some were removed since the last
  /// call.
  const ConnectedParts& parts(const Model& model, const History& history);

  /// For others between two calls of `advance`.
  SlotScratch& slots() { return slots_; }

 private:
  class System;

  /// Over the nodes of a connected part.
  struct Sums {
    Vec3 field = Vec3::Zero(), arms = field;  // of a field, or its moment; of arms r from Part::node [m]
    Mat3 spread = Mat3::Zero();               // [m^2] of r r^T
  };
  /// Of a connected part, whose nodes keep their mean.
  struct Part {
    int num_nodes = 0, node = -1;  // one of them
    Sums sums;
    Vec3 centre = Vec3::Zero();  // [m] mean of the nodes, from `node`
    Vec3 turn = Vec3::Zero();    // that a field contains
  };

  /// Best rotations of history.rest_shape at history.plastic_rest_positions into history.rotation_map; returns E. With
  /// `prepares`: op_, gradient_ and size_ as well.
  double fit(const Model& model, History& history, bool prepares);
  void step(const Model& model, LinearSolver& solver, History& history, AveragingReport& report);
  template <class Add>
  void sum_over_nodes(const Add& add);                             // add(node, its part, sums)
  void remove_translation(PointArray& field);                      // of each connected part
  void remove_rotation(PointArray& field, ConstPoints positions);  // of a field without means
  void choose_elements(const Model& model, History& history, std::span<const unsigned char> changed);

  ConnectedParts parts_;
  std::optional<std::vector<int>> removed_;   // History::removed that parts_, of_part_ and node_weight_ belong to
  std::vector<double> node_weight_;           // number of live elements around a node: diagonal of P but for 7/8
  std::vector<Part> of_part_;                 // per connected part
  std::vector<Sums> partial_;                 // scratch of sum_over_nodes
  std::vector<unsigned char> part_moves_;     // per connected part
  std::vector<unsigned char> chosen_;         // per element: it is left, and its part moves
  PointArray gradient_, increment_, before_;  // gradient_ holds -g
  AveragingOperator op_;
  std::vector<std::uint16_t> present_;  // of chosen_: per block a bit per element
  SlotScratch slots_;                   // positions of the latest fit, and their gradient [m]
  std::vector<double> misfit_, size_;   // [m^2] per block
};

}  // namespace hexaplast
