// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Those of `candidates` that lie within `radius` [m] of a place, in their order. x: num_nodes x 3 [m]. Throws
/// InputError for a candidate that is no row of x.
std::vector<int> nodes_near(ConstPoints x, std::span<const int> candidates, const Vec3& place, double radius);

/// An instrument's hold on n nodes. A spring ties each of them to the place that it had, relative to the tool, when the
/// grip closed; it pulls ever harder up to a limit, and the node then stays behind. The weights w_i
/// are 1 / n unless nodes have split:
///
///   g_i = tool + arm_i - x_i                           elongation of node i [m]
///   f_i = k g_i min(1, F / (k |g_i|))                  k = w_i stiffness,  F = w_i max_force
///
///   df_i/dx_i = -k I                                   |g_i| <= F / k
///             = -F / |g_i| (I - g_i g_i^T / |g_i|^2)   beyond
///
///   psi_i = k |g_i|^2 / 2                            |g_i| <= F / k
///         = F |g_i| - F^2 / 2k                       beyond
///
/// The potential is convex, so that minus the derivative of the forces is symmetric and positive semi-definite; the sum
/// of the forces is never greater than max_force.
///
/// Beside each spring stands a dashpot, f_i = -c (v_i - v_tool) with c = w_i damping, which the limit does not concern.
///
/// InputError, in every build: a held node that a field (num_nodes x 3) has not, or elongations that are not one row
/// per held node, as those of another grip or of an earlier hold are.
struct Grip {
  std::vector<int> nodes = {};                                 ///< empty: the grip is open
  std::vector<double> weights = {};                            ///< w_i; empty: 1 / n each
  PointArray arms = {};                                        ///< [m] one row per node, from the tool
  double stiffness = 0;                                        ///< [N/m] of all springs together
  double max_force = std::numeric_limits<double>::infinity();  ///< [N] of all springs together
  double damping = 0;                                          ///< [N s/m] of all dashpots together

  /// Closes on nodes where they are. x: num_nodes x 3 [m].
  void close(std::vector<int> held, const Vec3& tool, ConstPoints x);
  void open();

  /// Weights the nodes by their shares (NodeCopies::share, one per node of the body).
  void share_out(std::span<const double> share_of_node);

  double part(double of_all, std::size_t i) const;  ///< w_i of a number of all together

  /// g_i [m], one row per held node, to which the stiffness below refers; `elongations` gets that size.
  void elongations_at(const Vec3& tool, ConstPoints x, PointArray& elongations) const;

  /// f += forces [N].
  void add_force(const Vec3& tool, ConstPoints x, Points f) const;

  /// Sum of psi_i [J]: the forces are minus its gradient with respect to x.
  double energy(const Vec3& tool, ConstPoints x) const;

  /// Sum of the forces [N] at some elongations: what the tool exerts on the body.
  Vec3 total_force(ConstPoints elongations) const;

  /// Sum of the moments [N m] about the tool of the same forces, which act where the nodes are.
  Vec3 total_moment(ConstPoints elongations) const;

  /// The same of the dashpots, at velocities v (num_nodes x 3) [m/s].
  Vec3 damping_moment(ConstPoints elongations, const Vec3& tool_velocity, ConstPoints v) const;

  void add_stiffness_product(ConstPoints elongations, double factor, ConstPoints dx, Points df) const;
  void add_stiffness_blocks(ConstPoints elongations, double factor, BlockMatrix& A) const;

  /// diagonal += that of factor K, if K has no other entries: false when a spring is at its limit.
  bool add_stiffness_diagonal(ConstPoints elongations, double factor, Points diagonal) const;

  /// f += forces [N] of the dashpots at velocities v (num_nodes x 3) [m/s]. Returns their sum: what they do to the
  /// body.
  Vec3 add_damping_force(const Vec3& tool_velocity, ConstPoints v, Points f) const;

  void add_damping_product(double factor, ConstPoints dx, Points df) const;
  void add_damping_blocks(double factor, BlockMatrix& A) const;
  void add_damping_diagonal(double factor, Points diagonal) const;

 private:
  bool is_at_limit(const Vec3& elongation, std::size_t i) const;
  Vec3 elongation(std::size_t i, const Vec3& tool, ConstPoints x) const;
  Vec3 force(const Vec3& elongation, std::size_t i) const;
  Mat3 stiffness_at(const Vec3& elongation, std::size_t i) const;
};

}  // namespace hexaplast
