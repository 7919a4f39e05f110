// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "solve/cg_space.hpp"
#include "solve/multigrid.hpp"

namespace hexaplast {

/// The preconditioner of a system that is not one body's alone:
///
///   z = sum_i W_i B_i W_i r + W_0 D^-1 W_0 r        sum of all W = 1 at every node
///
/// B_i is a V-cycle for body i with W_i of what stands on the nodes beside the bodies, D the nodes' own blocks of A.
/// The weight W_i of a body at a node is its fraction in the diagonal of all bodies there: 1 at nodes of its own. W_0
/// is left to bodies without coarse meshes and to nodes of no body.
///
/// Where other terms tie bodies to each other, as contact does, this is done group by group of nodes, each with a body
/// of its own. With the blocks D_g of the groups and L of the terms between them below the diagonal, the preconditioner
/// is
///
///   (D + L) D^-1 (D + L^T)
///
/// with bodies that nothing holds before the others, and soft ones before stiff ones. A group sees its ties to later
/// groups as ties to the ground, and those to earlier ones not at all: what is eliminated follows it, and resists
/// little. (With exact D, two equal bodies under a stiff tie have eigenvalues between 1 and about 2.)
class SeveralBodies final : public NodalPreconditioner {
 public:
  /// To be called before setup: the groups of nodes that bodies have, in the order of elimination.
  const std::vector<NodeGroup>& find_groups(const MatrixFreeSystem& system);

  /// lumped: made with these groups; null: there are no other terms. rest: the system's diagonal and what stands for
  /// its other terms. `cycles`: whether bodies with coarse meshes get V-cycles. radii: per body, as Multigrid::setup
  /// takes them; returns whether some were known.
  bool setup(const MatrixFreeSystem& system, const NodalPart& rest, const LumpedTerms* lumped, bool cycles,
             std::span<SpectralRadii> radii);

  /// Calls visit(body, diagonal of factor L, num_nodes x 3) of the latest find_groups.
  template <class Visit>
  void visit_stiffness(const Visit& visit) const {
    for (std::size_t i = 0; i < num_parts_; ++i) visit(parts_[i].first_node, parts_[i].stiffness);
  }
  void apply(const PointArray& r, PointArray& z) override;

  static bool has_coarse_meshes(const KernelBody& body);

 private:
  struct Part {
    bool cycles = false;
    const Partition* partition = nullptr;  // of a body on the CPU
    DeviceVectors* device = nullptr;       // of another one
    int first_node = 0;                    // of the body's; what follows is of its nodes
    Eigen::VectorXd weight;                // per node
    PointArray stiffness;                  // diagonal of the body's operator

    auto rows(auto& of_all) const { return of_all.middleRows(first_node, stiffness.rows()); }
    PointArray diagonal, own_diagonal;  // weighted
    NodeMask free;
    std::vector<NodeBlock> blocks;
    Multigrid multigrid;
    AlignedVector<float> r, z;
    MatrixFreeSystem of_device;
    PointArray weighted, preconditioned;

    void add_cycle(ConstPoints from, Points to);
  };

  void find_stiffness(const KernelBody& body, Part& part);
  void apply_to(const NodeGroup& group, const PointArray& r, PointArray& z);
  void subtract_ties(const PointArray& z, PointArray& r);

  AlignedVector<double> slots_;  // scratch
  std::vector<Part> parts_;      // of the bodies; those of an earlier system behind them
  std::size_t num_parts_ = 0;
  Eigen::VectorXd weight_of_rest_, sum_;
  PointArray inverse_;             // of D, where no block has it
  std::vector<NodeBlock> blocks_;  // inverse
  struct Candidate {
    NodeGroup group;
    bool is_held = false;
    double stiffness = 0;  // mean of a node
  };
  std::vector<Candidate> candidates_;  // scratch
  std::vector<bool> is_of_body_;       // likewise, per node
  std::vector<NodeGroup> groups_;
  std::vector<bool> ties_;  // per group: it is tied to one behind it; empty: no group is
  const MatrixFreeSystem* system_ = nullptr;
  PointArray left_, later_, product_;
};

}  // namespace hexaplast
