// SPDX-License-Identifier: LGPL-2.1-or-later
// Nodal values of a hexahedron as modes: sums over the corners with the signs of the reference cube.
#if defined(HEXAPLAST_KINEMATICS_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_MODES_INL
#undef HEXAPLAST_KINEMATICS_MODES_INL
#else
#define HEXAPLAST_KINEMATICS_MODES_INL
#endif

#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// All modes of nodal values u but the sum of the corners. With the coordinates s of the corners in the reference cube:
///
///   at[n] = sum_a s_n u_a,   at[3 + l] = sum_a s_n s_m u_a (n, m, l different),   at[6] = sum_a s_0 s_1 s_2 u_a
template <class N>
struct ModeLanes {
  N at[kCorners - 1][3];
};

template <class N>
HEXAPLAST_INLINE void set_zero(ModeLanes<N>& modes) {
  for (auto& mode : modes.at)
    for (N& entry : mode) entry = N(ScalarOf<N>(0));
}

/// Differences come first: of values that are nearly alike, as those of a body that falls, they are exact.
template <class N>
HEXAPLAST_INLINE void modes(const CornerLanes<N>& u, ModeLanes<N>& at) {
  for (int i = 0; i < 3; ++i) {
    N along[4];  // the third coordinate
    for (int a = 0; a < 4; ++a) along[a] = u.at[a + 4][i] - u.at[a][i];
    // and along the first: near and far in the second
    const N up_near = along[1] + along[0], up_far = along[2] + along[3];
    const N both_near = along[1] - along[0], both_far = along[2] - along[3];
    at.at[2][i] = up_far + up_near;
    at.at[3][i] = up_far - up_near;
    at.at[4][i] = both_far + both_near;
    at.at[6][i] = both_far - both_near;
    const N across_near = (u.at[1][i] - u.at[0][i]) + (u.at[5][i] - u.at[4][i]);
    const N across_far = (u.at[2][i] - u.at[3][i]) + (u.at[6][i] - u.at[7][i]);
    at.at[0][i] = across_far + across_near;
    at.at[5][i] = across_far - across_near;
    at.at[1][i] = ((u.at[3][i] - u.at[0][i]) + (u.at[2][i] - u.at[1][i])) +
                  ((u.at[7][i] - u.at[4][i]) + (u.at[6][i] - u.at[5][i]));
  }
}

/// The transpose of modes(): what acts on the modes acts on the corners.
template <class N>
HEXAPLAST_INLINE void modes_transpose(const ModeLanes<N>& at, CornerLanes<N>& f) {
  for (int i = 0; i < 3; ++i) {
    const N across_far = at.at[0][i] + at.at[5][i], across_near = at.at[0][i] - at.at[5][i];
    const N up_far = at.at[2][i] + at.at[3][i], up_near = at.at[2][i] - at.at[3][i];
    const N both_far = at.at[4][i] + at.at[6][i], both_near = at.at[4][i] - at.at[6][i];
    const N far = at.at[1][i];
    const N sum[4] = {-(far + across_near), across_near - far, far + across_far, far - across_far};
    const N difference[4] = {up_near - both_near, up_near + both_near, up_far + both_far, up_far - both_far};
    for (int a = 0; a < 4; ++a) {
      f.at[a + 4][i] = sum[a] + difference[a];
      f.at[a][i] = sum[a] - difference[a];
    }
  }
}

/// to += factor a x b
template <class N>
HEXAPLAST_INLINE void add_cross(N factor, const N* a, const N* b, N* to) {
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    to[i] += factor * (a[k] * b[l] - a[l] * b[k]);
  }
}

/// The volume of a hexahedron with these modes, exactly, and what it changes with them. Edges are linear in each
/// coordinate of the reference cube, and terms of odd order in one of them have no part in the integral:
///
///   64 V = det(m_0, m_1, m_2) - sum_n m_n . (h_k x h_l) / 3,   n, k, l cyclic, h_n = m_3+n                      eq.
///   E30
template <class N>
HEXAPLAST_INLINE N volume_of(const ModeLanes<N>& modes, ModeLanes<N>& gradient) {
  using T = ScalarOf<N>;
  const N whole(T(1.0 / 64)), third(T(-1.0 / 192));
  set_zero(gradient);
  N volume(T(0));
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    constexpr int k = (n + 1) % 3, l = (n + 2) % 3;
    const N(*const m)[3] = modes.at;
    add_cross(whole, m[k], m[l], gradient.at[n]);
    if constexpr (n == 0) volume = dot(gradient.at[0], m[0]);
    add_cross(third, m[3 + k], m[3 + l], gradient.at[n]);
    add_cross(third, m[3 + k], m[l], gradient.at[3 + n]);
    add_cross(third, m[k], m[3 + l], gradient.at[3 + n]);
    N across[3] = {N(T(0)), N(T(0)), N(T(0))};
    add_cross(third, m[3 + k], m[3 + l], across);
    volume += dot(across, m[n]);
  });
  return volume;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
