// SPDX-License-Identifier: LGPL-2.1-or-later
// The plastic step of the paper, for one hexahedron in each lane and for one hexahedron.     theory.md sections 5.1
// to 5.4
#if defined(HEXAPLAST_PLAIN_FLOW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_PLAIN_FLOW_INL
#undef HEXAPLAST_PLAIN_FLOW_INL
#else
#define HEXAPLAST_PLAIN_FLOW_INL
#endif

#include <concepts>
#include <limits>

#include "kinematics/rotation-inl.hpp"
#include "material/law-inl.hpp"
#include "plain/element-inl.hpp"
#include "plastic/isolated_flow.hpp"
#include "plastic/point_flow-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

inline constexpr double kRepairRate = 5;  ///< [1/s] a jammed shape is back within a few tenths of a second

/// The stress norm. Lanes have a bound of the spectral one only.                                               eq. 20
template <class V>
HEXAPLAST_INLINE V size_of_stress(const Sym<V>& sigma, YieldNorm norm) {
  return stress_norm_bound(sigma, norm);
}
template <std::same_as<double> N>
HEXAPLAST_INLINE N size_of_stress(const Sym<N>& sigma, YieldNorm norm) {
  return stress_norm(to_eigen(matrix(sigma)), norm);
}

/// What a hexahedron is made of, in a step.
template <class N>
struct FlowRule {
  N rate_dt;                ///< [-] nu dt; 0 where no stretch flows
  N rotation_rate_dt;       ///< [-]
  N hardening;              ///< [-]
  bool stretches, rotates;  ///< whether something may flow
  double dt;                ///< [s]
};

/// ElementHistory, of joined rest shapes.
template <class N>
struct JoinedHistory {
  CornerLanes<N> rest_shape;         ///< [m] y
  Mat<N> rotation_map[kCorners];     ///< Pi
  N yield_stress[kCorners];          ///< [Pa] tau
  N rotation_yield[kCorners];        ///< [rad] tau^R
  N plastic_strain[kCorners];        ///< [-]
  Mat<N> plastic_stretch[kCorners];  ///< where the model tracks it
};

/// What flows.
template <class N>
struct JoinedFlow {
  N fraction[kCorners], rotation_fraction[kCorners];  ///< gamma, eta
  Mat<N> stretch[kCorners], rotation[kCorners];       ///< S^p - 1, R^p - 1
  N volume_ratio;                                     ///< beta
  N dissipated;                                       ///< [J]
  // a bit per lane
  std::uint32_t inverted, skipped, repaired, yielded;
  std::uint32_t fails = 0;  ///< beyond what the formulas of lanes can do
};

/// The value where something flows, 0 elsewhere.
template <class N>
HEXAPLAST_INLINE N where_flows(N fraction, N value) {
  return select(fraction > N(0.0), value, N(0.0));
}
template <class N>
HEXAPLAST_INLINE Mat<N> where_flows(N fraction, const Mat<N>& value) {
  Mat<N> out;
  for (int k = 0; k < 9; ++k) out.m[k / 3][k % 3] = where_flows(fraction, value.m[k / 3][k % 3]);
  return out;
}

/// Stretch at every corner.                                                                          theory.md 5.1
template <class N>
HEXAPLAST_NOINLINE void flow_stretch(const Element<N>& element, const Settings& settings, const FlowRule<N>& rule,
                                     N may_flow, JoinedHistory<N>& history, JoinedFlow<N>& flow) {
  for (int i = 0; i < kCorners; ++i) {
    const Sym<N>&S = element.polar[i].S, sigma = element.yielding_stress(i);
    const N norm = size_of_stress(sigma, settings.yield_norm), rate = may_flow * rule.rate_dt;
    flow.fraction[i] = flow_fraction(norm, history.yield_stress[i], rate, norm);  //                           eq. 21
    const N gamma = flow.fraction[i];
    if (settings.yield_norm == YieldNorm::kSpectral)  // of which lanes have a bound
      flow.fails |= bits<double>(gamma > N(0.0));
    // an overflow, which the caller refuses
    const std::uint32_t infinite = ~bits<double>(norm < N(std::numeric_limits<double>::infinity()));
    if ((infinite & bits<double>(rate > N(0.0))) != 0) [[unlikely]]
      flow.dissipated += where_flows(rate, norm);
    if (!any_positive(gamma)) continue;

    N strain(0.0), work(0.0);
    std::uint32_t fails = 0;
    flow.stretch[i] = where_flows(
        gamma, stretch_increment(S, dissipating(settings.law, S, sigma), gamma, strain, work, fails));  //      eq. 22
    flow.fails |= fails & bits<double>(gamma > N(0.0));
    flow.dissipated += N(1.0 / kCorners) * element.volume() * where_flows(gamma, work);
    history.plastic_strain[i] += where_flows(gamma, strain);
    history.yield_stress[i] = hardened(history.yield_stress[i], rule.hardening, gamma, norm);  //              eq. 23
  }
}

/// Rotation at every corner, relative to the centre (objective) or to the frame B (the paper's modes, eq. 33 and 34).
/// R_o: of the centre.                                                                               theory.md 5.2
template <class N>
HEXAPLAST_NOINLINE void flow_rotation(const Element<N>& element, const Mat<N>& R_o, const Mat<N>& frame,
                                      RotationPlasticity mode, const FlowRule<N>& rule, N may_flow,
                                      JoinedHistory<N>& history, JoinedFlow<N>& flow) {
  const RotationVector<N> pose = rotation_log(transposed_product(frame, R_o));
  RotationVector<N> of_corner[kCorners];  // R_o^T R_i
  N largest(0.0);
  for (int i = 0; i < kCorners; ++i) {
    of_corner[i] = rotation_log(transposed_product(R_o, element.polar[i].R));
    largest = max(largest, of_corner[i].angle);
  }
  for (int i = 0; i < kCorners; ++i) {
    RotationVector<N> turn = of_corner[i];
    N phi = turn.angle, size = phi;  //                                                                         eq. 24
    std::uint32_t fails = turn.near_half_turn;
    if (mode != RotationPlasticity::kObjective) {
      const bool is_centre = mode == RotationPlasticity::kCentre;
      if (is_centre) phi = largest;
      turn = is_centre ? pose : rotation_log(transposed_product(frame, element.polar[i].R));
      size = phi + pose.angle;
      fails |= turn.near_half_turn | pose.near_half_turn;
    }
    const N eta = flow_fraction(phi, history.rotation_yield[i], may_flow * rule.rotation_rate_dt, size);  //    eq. 25
    flow.rotation_fraction[i] = eta;
    if (!any_positive(eta)) continue;
    flow.rotation[i] = where_flows(eta, rotation_expm1(turn, eta));  //                                         eq. 26
    flow.fails |= fails & bits<double>(eta > N(0.0));
    history.rotation_yield[i] = hardened(history.rotation_yield[i], rule.hardening, eta, phi);
  }
}

/// y_i <- Pi_i^T A_i Pi_i y_i with A_i = R^p_i S^p_i, or S^p_i alone in the paper's modes, whose rotations go into the
/// maps (eq. 35); then the mean is removed.                                                                   eq. 27
template <class N>
HEXAPLAST_NOINLINE void deform_rest_shape(const Settings& settings, bool tracks_stretch, const JoinedFlow<N>& flow,
                                          JoinedHistory<N>& history) {
  const bool is_objective = settings.rotation_plasticity == RotationPlasticity::kObjective;
  const N of_own(sampling_of(settings).increment_weight()), of_mean = N(1.0) - of_own;
  Mat<N> increment[kCorners], mean;  // A_i - 1
  set_zero(mean);
  for (int i = 0; i < kCorners; ++i) {
    increment[i] = flow.stretch[i];
    if (is_objective) increment[i] = increment[i] + flow.rotation[i] + flow.rotation[i] * flow.stretch[i];
    mean = mean + scaled(N(1.0 / kCorners), increment[i]);
  }
  CornerLanes<N>& y = history.rest_shape;
  N centre[3] = {N(0.0), N(0.0), N(0.0)};
  for (int i = 0; i < kCorners; ++i) {
    const Mat<N> Pi = history.rotation_map[i];
    const auto in_rest_frame = [&](const Mat<N>& A) __attribute__((always_inline)) {
      return transposed_product(Pi, A * Pi);
    };
    if (tracks_stretch)
      history.plastic_stretch[i] =
          history.plastic_stretch[i] + in_rest_frame(flow.stretch[i]) * history.plastic_stretch[i];
    const Mat<N> A = in_rest_frame(scaled(of_own, increment[i]) + scaled(of_mean, mean));
    const N change[3] = {dot(A.m[0], y.at[i]), dot(A.m[1], y.at[i]), dot(A.m[2], y.at[i])};
    for (int k = 0; k < 3; ++k) {
      y.at[i][k] += change[k];
      centre[k] += N(1.0 / kCorners) * y.at[i][k];
    }
    if (!is_objective) history.rotation_map[i] = Pi + flow.rotation[i] * Pi;
  }
  for (int i = 0; i < kCorners; ++i)
    for (int k = 0; k < 3; ++k) y.at[i][k] -= centre[k];
}

/// What a hexahedron was at first.
template <class N>
struct InitialElement {
  CornerLanes<N> shape;  ///< [m] corners about their mean
  N jacobian[kCorners];  ///< [m^3] det J_i
  N volume;              ///< [m^3] V0
};

/// One plastic step before the averaging. rest, current: corners [m]; frame: B of the paper's rotation modes.
template <class N>
HEXAPLAST_NOINLINE void flow_element(const Element<N>& element, const CornerLanes<N>& rest,
                                     const CornerLanes<N>& current, const InitialElement<N>& initial,
                                     const Settings& settings, bool tracks_stretch, const FlowRule<N>& rule,
                                     const Mat<N>& frame, JoinedHistory<N>& history, JoinedFlow<N>& flow) {
  const N none(0.0), one(1.0), threshold(settings.inversion_threshold);
  flow.dissipated = none;
  for (int i = 0; i < kCorners; ++i) {
    flow.fraction[i] = flow.rotation_fraction[i] = none;
    set_zero(flow.stretch[i]);
    set_zero(flow.rotation[i]);
  }

  // guard: nothing flows in an element that is inverted or nearly so, at its current or its plastic rest positions
  N min_det(1e300), min_ratio(1e300);
  for (int i = 0; i < kCorners; ++i) {
    const N det = determinant(element.F[i]);
    flow.dissipated += none * det;  // no number where one overflows, which the caller refuses
    min_det = min(min_det, det);
    min_ratio = min(min_ratio, element.jacobian(i) / initial.jacobian[i]);
  }
  const N least = min(min_det, min_ratio), may_flow = select(least < threshold, none, one);
  flow.inverted = bits<double>(min_det < none);
  flow.skipped = bits<double>(least < threshold);

  const CornerLanes<N> before = history.rest_shape;
  if (rule.stretches) flow_stretch(element, settings, rule, may_flow, history, flow);
  if (rule.rotates) {
    const Mat<N> R_o = safe_polar(centre_gradient(rest, current)).R;
    flow_rotation(element, R_o, frame, settings.rotation_plasticity, rule, may_flow, history, flow);
  }
  N flowing = none;
  for (int i = 0; i < kCorners; ++i) flowing = max(flowing, max(flow.fraction[i], flow.rotation_fraction[i]));
  flow.yielded = bits<double>(flowing > none);
  if (flow.yielded != 0) {
    deform_rest_shape(settings, tracks_stretch, flow, history);
    for (int i = 0; i < kCorners; ++i)  // what did not flow keeps its bits
      for (int k = 0; k < 3; ++k)
        history.rest_shape.at[i][k] = select(flowing > none, history.rest_shape.at[i][k], before.at[i][k]);
  }

  CornerLanes<N>& y = history.rest_shape;
  flow.repaired = bits<double>(min_ratio < threshold);
  if (flow.repaired != 0) [[unlikely]] {  // back towards the initial shape                                    eq. 29
    const Mat<N> R = safe_polar(outer_sum(y, initial.shape)).R;
    const N step = select(min_ratio < threshold, N(std::min(1.0, kRepairRate * rule.dt)), none);
    for (int i = 0; i < kCorners; ++i) {
      N turned[3];
      for (int k = 0; k < 3; ++k) turned[k] = dot(R.m[k], initial.shape.at[i]);
      for (int k = 0; k < 3; ++k) y.at[i][k] += step * (turned[k] - y.at[i][k]);
    }
  }

  flow.volume_ratio = element.volume() / initial.volume;
  const N scale = restitution_scale(flow.volume_ratio, N(settings.volume_restitution * rule.dt));  //           eq. 28
  for (int i = 0; i < kCorners; ++i)
    for (int k = 0; k < 3; ++k) y.at[i][k] = scale * y.at[i][k];
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
