// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/layout/linear_system.hpp"
#include "state/corner_energy.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// What unfolds folded elements: cluster springs, and the corner energy of isolated rest shapes.
///                                                                                               theory.md section 3.3
///
///   d_e = min_i det Jhat_i / det J_i of an element, current against plastic rest                         (eq. E22)
///   s_e = (d1 - d_e) / (d1 - d0) within [0, 1], and of the elements beside the largest that touches      (eq. E27)
///   E_C = sum_n w_n |r_n|^2 / 2,  w_n = sum_e s_e strength mu V_e^1/3 / 2 of a node's elements      (eq. E23, E25)
///
/// with r the deviation from the best rigid placement of the plastic rest shape, one placement for each connected
/// cluster of elements with s > 0. Forces and moments of a cluster sum to zero. Nothing happens while all d_e >= d1. s
/// is held in the gradient, so that the sum of E_C and the elastic energy is not kept while s changes. Of isolated rest
/// shapes that have flowed, d1 is -.5 at most.
class Recovery final : public NodalOperator {
 public:
  /// nodes x 3 [m]. thin: per block, bits of the elements that may have a corner below `from(settings)`.
  void find(const Model& model, const History& history, std::span<const std::uint16_t> thin, ConstPoints current);

  /// [-] Corner ratio at and above which nothing acts; minus infinity where nothing ever does.
  static double from(const Settings& settings);

  bool acts() const { return !clusters_.empty() || corners_.acts(); }
  double energy() const { return energy_ + corners_.energy(); }  ///< [J]
  double spring_energy() const { return energy_; }               ///< [J] without that of corners

  /// [J] of these springs, as strong as they are, at other positions.
  double spring_energy_at(ConstPoints plastic_rest, ConstPoints current) const;

  /// f += forces [N].
  void add_force(Points f) const;

  /// F p = W (p less its rigid part): minus the slope of the forces, placements turning with the nodes.        eq. E26
  void add_product(double factor, ConstPoints p, Points Fp) const override;
  bool has_diagonal() const override { return true; }
  void add_diagonal(double factor, Points diagonal) const override;  ///< of W

  /// K += the same operator: W as blocks, and what is rigid in p as blocks of small clusters; large ones leave it out.
  void add_blocks(double factor, BlockMatrix& K) const override;

 private:
  struct Spring {
    int node;
    double weight;  // [N/m]
    Vec3 arm;       // [m] current position less the cluster's centre
    Vec3 residual;  // [m] r
  };
  struct Cluster {
    int first = 0, last = 0;  // of its springs
    double weight = 0;
    Mat3 inverse_inertia = Mat3::Zero();  // of the springs about the centre; without those axes that turn nothing
  };
  /// The best rigid placement of the plastic rest shape: current = centre + R (plastic rest - rest_centre).
  struct Placement {
    Vec3 rest_centre, centre;
    Mat3 R;
  };

  std::span<const Spring> springs_of(const Cluster& cluster) const {
    return {springs_.data() + cluster.first, springs_.data() + cluster.last};
  }
  Placement placement(const Cluster& cluster, ConstPoints plastic_rest, ConstPoints current) const;

  CornerEnergy corners_;
  std::vector<Spring> springs_;  // by clusters
  std::vector<Cluster> clusters_;
  double energy_ = 0;
  std::vector<double> pull_, weight_;  // per node: largest s of its elements, w
  std::vector<int> cluster_, count_;   // per node: index, or -1; per cluster: nodes
  DisjointSets sets_;
};

}  // namespace hexaplast
