// SPDX-License-Identifier: LGPL-2.1-or-later
// Viscoelastic branches, of which each sample of a hexahedron has strains of its own. For samples in lanes and for one
// sample, without lanes or matrices of other libraries.                                         theory.md section 5.10
#if defined(HEXAPLAST_ELEMENT_RELAXATION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELEMENT_RELAXATION_INL
#undef HEXAPLAST_ELEMENT_RELAXATION_INL
#else
#define HEXAPLAST_ELEMENT_RELAXATION_INL
#endif

#include <array>

#include "base/svd-inl.hpp"
#include "material/law-inl.hpp"
#include "material/relaxation.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// A + factor B.
template <class N>
HEXAPLAST_INLINE Sym<N> sum(const Sym<N>& A, N factor, const Sym<N>& B) {
  return {A.xx + factor * B.xx, A.yy + factor * B.yy, A.zz + factor * B.zz,
          A.yz + factor * B.yz, A.zx + factor * B.zx, A.xy + factor * B.xy};
}

/// A : B + w tr A tr B, in which energies of branches are.                                                  eq. P17
template <class N>
HEXAPLAST_INLINE N product(N w, const Sym<N>& A, const Sym<N>& B) {
  return A.xx * B.xx + A.yy * B.yy + A.zz * B.zz + N(2.0) * (A.yz * B.yz + A.zx * B.zx + A.xy * B.xy) +
         w * trace(A) * trace(B);
}

/// g w = (lambda_f' - lambda_f) / (2 mu), what branches, of which the g have this sum, add to the modulus of a sample's
/// own dilatation where nothing has relaxed; w >= -1/3, where they resist it no more. Moduli of either sign.
///                                                                                                      eq. E2, P14
template <class N>
HEXAPLAST_INLINE N branch_free_modulus(N mu, N lambda, N g) {
  using T = ScalarOf<N>;
  const N tiny(T(1e-30)), one(T(1)), two(T(2)), all = one + g, fourths = two + N(T(4.0 / 3)) * g;
  const N slow = abs(lambda) / max(abs(lambda + two * mu), tiny),
          sudden = one - two * all * (abs(mu) / max(abs(lambda + fourths * mu), tiny));
  return max(all * sudden - slow, N(T(-1.0 / 3)) * g);
}

/// w, the weight of traces in stresses and energies of branches.                                           eq. P14
template <class N>
HEXAPLAST_INLINE N branch_weight(N mu, N lambda, const Branches& branches) {
  const N g(branches.moduli());
  return branch_free_modulus(mu, lambda, g) / g;
}

/// What branches act on: B_i = S_i - (mean tr S) / 3. stretch(i): S_i.                                       eq. P13
template <class N, class Stretch>
HEXAPLAST_INLINE void branch_stretches(const Stretch& stretch, Sym<N> (&B)[kCorners]) {
  N mean(0.0);
  for (int i = 0; i < kCorners; ++i) {
    B[i] = stretch(i);
    mean += N(1.0 / (3 * kCorners)) * trace(B[i]);
  }
  for (Sym<N>& one : B) one = {one.xx - mean, one.yy - mean, one.zz - mean, one.yz, one.zx, one.xy};
}

/// q + w tr(q) 1: the stress that does on S_i the work of q on B_i, because the tr q of the samples have no mean.
///                                                                                                          eq. P14
template <class N>
HEXAPLAST_INLINE Sym<N> branch_stress(N w, const Sym<N>& q) {
  const N own = w * trace(q);
  return {q.xx + own, q.yy + own, q.zz + own, q.yz, q.zx, q.xy};
}

/// b after a step in which B changes by D.                                                                  eq. P13
template <class N>
HEXAPLAST_INLINE Sym<N> branch_strain(N decay, const Sym<N>& b, N response, const Sym<N>& D) {
  return sum(Sym<N>{decay * b.xx, decay * b.yy, decay * b.zz, decay * b.yz, decay * b.zx, decay * b.xy}, response, D);
}

/// What the branches of an element, or of one in each lane, bring into a step.                           eq. P13, P17
template <class V>
struct BranchLanes {
  /// D of a step that leads to these S. stretch(i): S_i.
  template <class Stretch>
  HEXAPLAST_INLINE void changes(const Stretch& stretch, Sym<V> (&D)[kCorners]) const {
    branch_stretches(stretch, D);
    for (int i = 0; i < kCorners; ++i) D[i] = sum(D[i], V(-1.0), before[i]);
  }
  /// Part of sigma at the end of the step.
  HEXAPLAST_INLINE Sym<V> stress(int sample, const Sym<V>& D) const {
    return branch_stress(weight, sum(held[sample], modulus + modulus, D));
  }
  /// Energy density of the same.
  HEXAPLAST_INLINE V energy(int sample, const Sym<V>& D) const {
    return stored[sample] + product(weight, held[sample], D) + modulus * product(weight, D, D);
  }

  Sym<V> before[kCorners];  ///< B at the step before
  Sym<V> held[kCorners];    ///< [Pa] sum of e q_k
  V stored[kCorners];       ///< [J/m^3] sum of |q_k|^2 / (4 g mu), by `product`
  V modulus, weight;        ///< [Pa] mu_b; w
};

/// load(e -> numbers of the tensors of element e, tensors of the samples).
template <class V, class Load>
HEXAPLAST_INLINE void set_branches(const Branches& branches, V mu, V lambda, const Load& load, BranchLanes<V>& to) {
  load([&](int e) { return branches.stretch[e][0].data(); }, to.before);
  to.modulus = V(branches.modulus()) * mu;
  to.weight = branch_weight(mu, lambda, branches);
  const V none(0.0);
  for (int i = 0; i < kCorners; ++i) {
    to.held[i] = {none, none, none, none, none, none};
    to.stored[i] = none;
  }
  const std::size_t count = branches.steps.size();
  for (std::size_t k = 0; k < count; ++k) {
    Sym<V> b[kCorners];
    load([&](int e) { return branches.strain[e * count + k][0].data(); }, b);
    const BranchStep& step = branches.steps[k];
    const V of_stored = V(step.modulus) * mu, of_held = V(2 * step.modulus * step.decay) * mu;
    for (int i = 0; i < kCorners; ++i) {
      to.held[i] = sum(to.held[i], of_held, b[i]);
      to.stored[i] += of_stored * product(to.weight, b[i], b[i]);
    }
  }
}

/// q + A, with which q's moments are in balance, where no stretches are opposite.                             eq. P15
///
///   A = [w]x,  (tr S - S) w = v,  [v]x = S q - q S
template <class N>
HEXAPLAST_INLINE Mat<N> in_balance(const Sym<N>& q, const Sym<N>& S) {
  const Mat<N> Sq = matrix(S) * matrix(q);
  const N v[3] = {Sq(2, 1) - Sq(1, 2), Sq(0, 2) - Sq(2, 0), Sq(1, 0) - Sq(0, 1)};
  const N trace = S.xx + S.yy + S.zz;
  const Mat<N> K = matrix(Sym<N>{trace - S.xx, trace - S.yy, trace - S.zz, -S.yz, -S.zx, -S.xy}), cof = cofactor(K);
  const N inverse = N(1.0) / dot(K.m[0], cof.m[0]);
  N w[3];
  for (int k = 0; k < 3; ++k) w[k] = inverse * dot(cof.m[k], v);
  return {{{q.xx, q.xy - w[2], q.zx + w[1]}, {q.xy + w[2], q.yy, q.yz - w[0]}, {q.zx - w[1], q.yz + w[0], q.zz}}};
}

/// The same everywhere. Where stretches are opposite, as they may be in inverted samples, A has no bound: both are
/// scaled down there.                                                                                  eq. P14, P15
template <class N>
HEXAPLAST_INLINE Mat<N> bounded_balance(const Sym<N>& q, const Sym<N>& S) {
  constexpr double kSmallest = 0.1;  // of (s_a + s_b)/|s_a - s_b|; above 1 where nothing is inverted
  const N none(0.0), shift = N(2.0) * sqrt(squared_norm(S));
  // the axes are those of S + shift, which has the same and is positive
  const SvdOf<N> svd = signed_svd(matrix(Sym<N>{S.xx + shift, S.yy + shift, S.zz + shift, S.yz, S.zx, S.xy}));
  Mat<N> H = product_transposed(svd.V * matrix(q), svd.V);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      if (a == b) continue;
      const N s_a = svd.d[a] - shift, s_b = svd.d[b] - shift;
      const N divisor = max(s_a + s_b, N(kSmallest) * abs(s_a - s_b));
      H(a, b) *= select(divisor > none, N(2.0) * s_a / divisor, N(1.0));  // 1 + (s_a - s_b)/(s_a + s_b)
    }
  return transposed_product(svd.V, H * svd.V);
}

/// Of a single element.
HEXAPLAST_INLINE BranchLanes<double> branches_of(const Branches& branches, const Lame& lame) {
  BranchLanes<double> of;
  const auto load = [](const auto& address, Sym<double>(&B)[kCorners]) {
    for (int i = 0; i < kCorners; ++i) {
      const double* n = address(0) + 6 * i;
      B[i] = {n[0], n[1], n[2], n[3], n[4], n[5]};
    }
  };
  set_branches(branches, lame.mu, lame.lambda, load, of);
  return of;
}

HEXAPLAST_INLINE Sym<double> symmetric(const std::array<double, 6>& n) { return {n[0], n[1], n[2], n[3], n[4], n[5]}; }
HEXAPLAST_INLINE std::array<double, 6> numbers(const Sym<double>& S) { return {S.xx, S.yy, S.zz, S.yz, S.zx, S.xy}; }

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
