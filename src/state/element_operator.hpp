// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kinematics/sampling.hpp"
#include "layout/chunked_operator.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

/// Bits of a 16-bit floating point number (1 sign, 5 exponent, 10 mantissa).
struct Half {
  std::uint16_t bits;
};

/// Which terms the stiffness of a body's elements, or of the cells of a coarse mesh, has.
struct StiffnessKind {
  Sampling sampling = {};
  ElasticLaw law = ElasticLaw::kCorotated;
  double branch_modulus = 0;  ///< mu_b over mu, of viscoelastic branches                                       eq. P14
  double branch_moduli = 0;   ///< sum of their g
  bool one_rotation = false;  ///< of the simple form (OneRotationPlaces): parallelepipeds, of the corotated law

  /// Cells assume nothing, and resist changes of volume at their samples.
  bool has_volume() const { return sampling.assumed != Assumed::kNothing; }
  bool has_law() const { return law != ElasticLaw::kCorotated; }
  /// Whether the mean dilatation of the samples acts on each of them, by a term of its own.
  bool has_mean() const { return has_volume() && !has_law() && !one_rotation; }
};

/// Where the coefficients of an element stand; the gradients of the volume ratio and of the mean dilatation, and the
/// coefficients of the law come last, in this order. All lengths are in units of Model::length.
template <bool kGeneral, Assumed kAssumed>
struct CoefficientPlaces {
  static constexpr bool kAssumes = kAssumed != Assumed::kNothing;
  static constexpr bool kHasMean = kGeneral && kAssumes;

  static constexpr int kC = 0;                                                 ///< C_i = J_i^-1 G_i R_i^T / 2
  static constexpr int kRotation = kC + 9 * kCorners;                          ///< R_i G_i^T
  static constexpr int kShared = kRotation + (kGeneral ? 9 * kCorners : 0);    ///< h
  static constexpr int kDirections = kShared + (kGeneral ? 3 * kCorners : 0);  ///< rows R_m Gm^T J^n / 2
  static constexpr int kMean = kDirections + (kAssumes ? 9 : 0);               ///< RestLanes::mean
  static constexpr int kSkew = kMean + (kHasMean ? 24 : 0);                    ///< RestLanes::skew
  static constexpr int kDual = kSkew + (kHasMean ? 9 : 0);                     ///< RestLanes::dual
  static constexpr int kCount = kDual + (kHasMean ? 9 : 0);
};
/// The same of the simple form that cycles take for elements: parallelepipeds with one rotation, whose products are
/// sums over modes instead of samples.
struct OneRotationPlaces {
  static constexpr int kDirections = 0;         ///< rows R_m Gm^T J^n / 2
  static constexpr int kOfTwo = 9;              ///< ModeStiffness, as its factor
  static constexpr int kOfThree = kOfTwo + 45;  ///< the same
  static constexpr int kCount = kOfThree + 6;
};
inline constexpr int kGradientCoefficients = 3 * (kCorners - 1);  ///< modes of a gradient at the corners
inline constexpr int kLawCoefficients = 7 * kCorners;             ///< R_i cof(S_i) R_i^T (6) and beta (1)

/// Numbers per element, without those of the volume ratio and of the law, and all.
int num_shape_coefficients(const StiffnessKind& kind, bool is_general);
int num_coefficients(const StiffnessKind& kind, bool is_general);

/// L = - df/dx of a body with its rotations held fixed, as coefficients of its elements: no matrix.
///                                                                                             theory.md section 9.3
/// Per block of elements, [component][element of the block]: CoefficientPlaces of general elements unless all of the
/// block are parallelepipeds. Weights: mu V / 8 and lambda V / 8. Lengths are in units of Model::length, so that the
/// coefficients are of the order of 1 and fit Coef.
/// T: numbers computed with; Coef: coefficients as stored.
template <class T, class Coef>
class ElementOperator final : public ChunkedOperator<T> {
 public:
  explicit ElementOperator(std::shared_ptr<const Partition> partition);

  const Partition& partition() const override { return *partition_; }
  void add_product(int chunk, T factor, const T* p, T* Ap) const override {
    add_product_of(nullptr, chunk, factor, p, Ap);
  }
  void add_diagonal(int chunk, T factor, T* diagonal) const override {
    add_diagonal_of(nullptr, chunk, factor, diagonal);
  }
  /// The same of the blocks whose entry is not 0.
  void add_product_of(const unsigned char* blocks, int chunk, T factor, const T* p, T* Ap) const;
  void add_diagonal_of(const unsigned char* blocks, int chunk, T factor, T* diagonal) const;

  /// Makes room for blocks of these kinds; has_coefficients: per block, not 0 where it has some, or null: all have.
  void resize(const std::vector<unsigned char>& is_general, const unsigned char* has_coefficients = nullptr);

  /// Bytes that are kept, all of which one application reads.
  std::size_t bytes() const { return coef.size() * sizeof(Coef) + weight.size() * sizeof(T); }

  StiffnessKind kind;
  std::vector<unsigned char> is_general;  ///< per block
  std::vector<std::size_t> offset;        ///< per block: into coef
  AlignedVector<Coef> coef;
  AlignedVector<T> weight;  ///< [block][mu, lambda][element], or [block][sample][mu, lambda][element]

 private:
  std::shared_ptr<const Partition> partition_;
};

}  // namespace hexaplast
