// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "layout/coarse_mesh.hpp"
#include "solve/cg_space.hpp"
#include "solve/node_blocks.hpp"

namespace hexaplast {

/// One mesh of a multigrid cycle: A = P (diagonal + blocks + factor L) P, and the vectors of its smoother.
struct MultigridLevel {
  LevelOperator of;  ///< L
  float factor = 0;
  AlignedVector<float> diagonal, inverse;  ///< D, and 1 / diag(A); 0 where a block has the inverse
  SlotBlocks<float> blocks;
  ConstrainedDofs fixed;
  std::vector<unsigned char> is_fixed;  ///< the same, per number of a node
  AlignedVector<float> x, r, d, Ad;  ///< x of the finest mesh is borrowed from the caller of the cycle; Ad: of Lanczos
  std::vector<double> partial;       ///< sums per chunk
  double radius = 1;                 ///< of D^-1 A: what the smoother takes for the upper end of its spectrum

  const Partition& partition() const { return of.op->partition(); }
  void resize();
  void mark_fixed();  ///< is_fixed from `fixed`
};

/// A symmetric V-cycle as a preconditioner: Chebyshev smoothing on D^-1 A, trilinear transfer, coarse operators from
/// re-discretisation.                                                                           theory.md section 9.5
class Multigrid final : public SlotPreconditioner<float> {
 public:
  /// Takes the body's operators, and the diagonal, blocks and fixed degrees of freedom of `rest`. Finds the spectral
  /// radii, unless those that are given are valid for this system. Returns whether they are.
  bool setup(const KernelBody& body, const NodalPart& rest, SpectralRadii& radii);

  void apply(const AlignedVector<float>& r, AlignedVector<float>& z) override;
  double diagonal_norm(const AlignedVector<float>& x) override {
    MultigridLevel& fine = levels_.front();
    return norm_over(fine.partition(), fine.inverse, x, fine.partial);
  }

 private:
  bool find_radii(const KernelBody& body, const NodalPart& rest, SpectralRadii& radii);
  void set_diagonals(const PointArray& diagonal, const NodeMask& free, std::span<const NodeBlock> blocks);
  void descend(const MultigridLevel& finer, MultigridLevel& level) const;
  void restrict_blocks(MultigridLevel& finer, MultigridLevel& level);
  void cycle(std::size_t level);

  std::vector<MultigridLevel> levels_;  // from fine to coarse
  std::vector<int> block_of_slot_;      // of a finer mesh: index, or -1; scratch
};

}  // namespace hexaplast
