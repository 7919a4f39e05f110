// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "base/blocks.hpp"
#include "hexaplast/base/corners.hpp"
#include "kinematics/sampling.hpp"

namespace hexaplast {

/// What viscoelastic branches add to the stiffness of the samples, over mu.                                   eq. P14
struct BranchModuli {
  double sum = 0;      ///< of their g
  double in_step = 0;  ///< mu_b: what a step sees of them
};

/// Which terms the stiffness of a body's elements has.
struct StiffnessKind {
  Sampling sampling = {};
  ElasticLaw law = ElasticLaw::kCorotated;
  BranchModuli branches = {};  ///< of the corotated law
  bool one_rotation = false;   ///< StoredOneRotation: of the corotated law

  constexpr bool has_law() const { return law != ElasticLaw::kCorotated; }
};

/// kCount numbers of each element of a group of kStride: [k] is number k of the first one, those of the others follow.
template <int kCount, int kStride, class Coef>
struct StoredNumbers {
  constexpr Coef* operator[](int k) const { return first + k * kStride; }

  Coef* first;
};

/// What is stored of the stiffness of an element: the names of its coefficients, and where they stand among those of
/// its block. Lengths are in units of Model::length. R_i, G_i: of sample i.
///                                                                                             theory.md section 9.3
///
///   written    CoefficientWriter                  elastic/element_kernels-inl.hpp
///   product    apply_stiffness                    elastic/assumed-inl.hpp; general: elastic/element_kernels-inl.hpp
///   diagonal   add_diagonal_of                    elastic/element_operator.cpp
///
/// kGeneral: some are no parallelepipeds.
template <bool kGeneral, class Coef, int kStride = kBlock>
class StoredElement {
 public:
  template <int kCount>
  using Numbers = StoredNumbers<kCount, kStride, Coef>;

  static constexpr bool kIsGeneral = kGeneral;
  static constexpr bool kMayHaveLaw = true;

  constexpr explicit StoredElement(Coef* first) : first_(first) {}

  /// C_i = J_i^-1 G_i R_i^T / 2
  constexpr Numbers<9> C(int i) const { return {at(9 * i)}; }

  // of general shapes
  constexpr Numbers<9> rotation(int i) const { return {at(kRotation + 9 * i)}; }        ///< R_i G_i^T
  constexpr Numbers<3> shared(int corner) const { return {at(kShared + 3 * corner)}; }  ///< RestLanes::h
  constexpr Numbers<3> mean(int corner) const { return {at(kMean + 3 * corner)}; }      ///< RestLanes::mean
  constexpr Numbers<9> skew() const { return {at(kSkew)}; }                             ///< RestLanes::skew
  constexpr Numbers<9> dual() const { return {at(kDual)}; }                             ///< RestLanes::dual

  // of all shapes; gradients by modes (ModeLanes): the sum of the corners is zero, and rounding does not change that
  constexpr Numbers<9> directions() const { return {at(kDirections)}; }            ///< rows R_m Gm^T J^n / 2
  constexpr Numbers<21> volume_gradient() const { return {at(kVolumeGradient)}; }  ///< of the volume ratio
  constexpr Numbers<21> mean_gradient() const { return {at(kOfLaw)}; }             ///< of the mean dilatation

  /// Of a law other than the corotated one, which has no mean gradient: R_i cof(S_i) R_i^T, as Sym, and beta_i.
  constexpr Numbers<7> law(int i) const { return {at(kOfLaw + 7 * i)}; }

  /// Coefficients per element.
  static constexpr int count(bool has_law) { return kOfLaw + (has_law ? 7 * kCorners : 21); }

 private:
  static constexpr int kRotation = 9 * kCorners;
  static constexpr int kShared = kRotation + (kGeneral ? 9 * kCorners : 0);
  static constexpr int kDirections = kShared + (kGeneral ? 3 * kCorners : 0);
  static constexpr int kMean = kDirections + 9;
  static constexpr int kSkew = kMean + (kGeneral ? 3 * kCorners : 0);
  static constexpr int kDual = kSkew + (kGeneral ? 9 : 0);
  static constexpr int kVolumeGradient = kDual + (kGeneral ? 9 : 0);
  static constexpr int kOfLaw = kVolumeGradient + 21;

  constexpr Coef* at(int number) const { return first_ + number * kStride; }

  Coef* first_;
};

/// The same of the simple form that cycles take for elements: parallelepipeds with one rotation, whose products are
/// sums over modes instead of samples.
///
///   written    store_one_rotation                 elastic/one_rotation-inl.hpp
///   product    apply_stiffness                    elastic/one_rotation-inl.hpp
///   diagonal   add_diagonal_of                    elastic/element_operator.cpp
template <class Coef, int kStride = kBlock>
class StoredOneRotation {
 public:
  template <int kCount>
  using Numbers = StoredNumbers<kCount, kStride, Coef>;

  static constexpr bool kIsGeneral = false, kMayHaveLaw = false;
  static constexpr int kCount = 9 + 45 + 6 + 21;

  constexpr explicit StoredOneRotation(Coef* first) : first_(first) {}

  constexpr Numbers<9> directions() const { return {at(0)}; }         ///< rows R_m Gm^T J^n / 2
  constexpr Numbers<45> of_two() const { return {at(9)}; }            ///< ModeStiffness::of_two, as its factor
  constexpr Numbers<6> of_three() const { return {at(54)}; }          ///< ModeStiffness::of_three, the same
  constexpr Numbers<21> volume_gradient() const { return {at(60)}; }  ///< of the volume ratio, by modes

 private:
  constexpr Coef* at(int number) const { return first_ + number * kStride; }

  Coef* first_;
};

}  // namespace hexaplast
