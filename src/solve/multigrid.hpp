// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "layout/coarse_mesh.hpp"
#include "solve/cg_space.hpp"
#include "solve/node_blocks.hpp"

namespace hexaplast {

/// One mesh of a multigrid cycle: A = P (diagonal + blocks + factor L) P, and the vectors of its smoother.
template <class T>
struct MultigridLevel {
  const ChunkedOperator<T>* op = nullptr;
  T factor = 0;
  AlignedVector<T> stiffness;          ///< diag(factor L)
  AlignedVector<T> diagonal, inverse;  ///< D, and 1 / diag(A); 0 where a block has the inverse
  SlotBlocks<T> blocks;
  bool has_diagonal = false;  ///< some of `diagonal` is not 0
  ConstrainedDofs fixed;
  std::vector<unsigned char> is_fixed;  ///< the same, per number of a node
  AlignedVector<T> x, r, d, Ad;  ///< x of the finest mesh is lent by whoever applies the cycle; Ad serves Lanczos
  std::vector<double> partial;   ///< sums per chunk
  double radius = 1;             ///< of D^-1 A: what the smoother takes for the upper end of its spectrum

  void resize();
};

/// A symmetric V-cycle as a preconditioner: Chebyshev smoothing on D^-1 A, trilinear transfer, coarse operators from
/// re-discretisation.                                                                           theory.md section 9.5
template <class T>
class Multigrid final : public SlotPreconditioner<T> {
 public:
  /// Takes the body's operators, and the diagonal, blocks and fixed degrees of freedom of `rest`; finds the spectral
  /// radii, unless `known` ones serve. Without `known`, those of the latest setup with the same system serve.
  void setup(const KernelBody& body, const NodalPart& rest, SpectralRadii* known = nullptr);

  /// Whether the radii were known ones; then the next setup finds them anew.
  bool forgets_known_radii();

  /// diag(factor L) of the body, in its slots; found once for a revision.
  const AlignedVector<T>& stiffness(const KernelBody& body);

  void apply(const AlignedVector<T>& r, AlignedVector<T>& z) override;
  double diagonal_norm(const AlignedVector<T>& x) override {
    return norm_over(fine_.op->partition(), fine_.inverse, x, fine_.partial);
  }

 private:
  void setup_operators(const KernelBody& body);
  void find_radii(const KernelBody& body, const NodalPart& rest, SpectralRadii* known);
  void place(const PointArray& diagonal, const NodeMask& free, std::span<const NodeBlock> blocks);
  template <class Finer>
  void restrict_blocks(MultigridLevel<Finer>& finer, const CoarseMesh& mesh, MultigridLevel<float>& level);
  template <class U>
  void smooth(MultigridLevel<U>& level, int degree, double min_fraction, bool leaves_residual);
  template <class Finer>
  void restrict_to(MultigridLevel<Finer>& finer, int coarse);
  template <class Finer>
  void prolong_from(int coarse, MultigridLevel<Finer>& finer);
  void cycle(int coarse);

  MultigridLevel<T> fine_;
  std::vector<MultigridLevel<float>> coarse_;
  std::span<const CoarseOperator> operators_;  // of the coarse meshes
  std::vector<int> block_of_slot_;             // of a finer mesh: index, or -1; scratch
  struct {
    long revision = 0;  // 0: of no system
    double factor = 0;
  } stiffness_of_;  // of all levels
  struct {
    long revision = 0;  // 0: of no system
    double factor = 0;
    PointArray diagonal;
    NodeMask free;
  } radii_of_;                    // all that the spectral radii follow from
  bool are_radii_known_ = false;  // they were, from an earlier system
};

}  // namespace hexaplast
