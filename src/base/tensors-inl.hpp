// SPDX-License-Identifier: LGPL-2.1-or-later
// Matrices of numbers, and the library's own.
#if defined(HEXAPLAST_BASE_TENSORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_TENSORS_INL
#undef HEXAPLAST_BASE_TENSORS_INL
#else
#define HEXAPLAST_BASE_TENSORS_INL
#endif

#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"
#include "hexaplast/base/types.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

HEXAPLAST_INLINE Mat<double> entries(const Mat3& A) {
  return {{{A(0, 0), A(0, 1), A(0, 2)}, {A(1, 0), A(1, 1), A(1, 2)}, {A(2, 0), A(2, 1), A(2, 2)}}};
}
HEXAPLAST_INLINE Sym<double> symmetric_entries(const Mat3& S) {
  return {S(0, 0), S(1, 1), S(2, 2), S(1, 2), S(2, 0), S(0, 1)};
}
HEXAPLAST_INLINE Mat3 to_eigen(const Mat<double>& A) {
  Mat3 out;
  for (int k = 0; k < 9; ++k) out(k / 3, k % 3) = A.m[k / 3][k % 3];
  return out;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
