// SPDX-License-Identifier: LGPL-2.1-or-later
// What formulas are written in: matrices of N, the number type. N is lanes in the kernels and double elsewhere, so that
// a formula stands once. A file of the kernels names none of its formulas with double: kernels fuse multiplications and
// additions, and the linker keeps one of two functions of the same name.
#if defined(HEXAPLAST_BASE_MATRIX_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_MATRIX_INL
#undef HEXAPLAST_BASE_MATRIX_INL
#else
#define HEXAPLAST_BASE_MATRIX_INL
#endif

#include "base/number-inl.hpp"
#include "hexaplast/base/corners.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// 3 x 3, row by row.
template <class N>
struct Mat {
  N m[3][3];
  HEXAPLAST_INLINE N& operator()(int i, int j) { return m[i][j]; }
  HEXAPLAST_INLINE const N& operator()(int i, int j) const { return m[i][j]; }
};
/// 3 x 3 symmetric.
template <class N>
struct Sym {
  N xx, yy, zz, yz, zx, xy;
};

/// to = from, number by number: the compiler would call for a copy of memory.
template <class N>
HEXAPLAST_INLINE void assign(const Mat<N>& from, Mat<N>& to) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) to(i, j) = from(i, j);
}

template <class N>
HEXAPLAST_INLINE Mat<N> matrix(const Sym<N>& S) {
  return {{{S.xx, S.xy, S.zx}, {S.xy, S.yy, S.yz}, {S.zx, S.yz, S.zz}}};
}

/// The lanes of which the bits are set from A, the others from B.
template <class N>
HEXAPLAST_INLINE Mat<N> select_bits(std::uint32_t bits_of_A, const Mat<N>& A, const Mat<N>& B) {
  Mat<N> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = select_bits(bits_of_A, A(i, j), B(i, j));
  return C;
}

template <class N>
HEXAPLAST_INLINE Sym<N> select_bits(std::uint32_t bits_of_A, const Sym<N>& A, const Sym<N>& B) {
  return {select_bits(bits_of_A, A.xx, B.xx), select_bits(bits_of_A, A.yy, B.yy), select_bits(bits_of_A, A.zz, B.zz),
          select_bits(bits_of_A, A.yz, B.yz), select_bits(bits_of_A, A.zx, B.zx), select_bits(bits_of_A, A.xy, B.xy)};
}

template <class N>
HEXAPLAST_INLINE Mat<N> operator+(const Mat<N>& A, const Mat<N>& B) {
  Mat<N> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(i, j) + B(i, j);
  return C;
}
/// C = A B.
template <class N>
HEXAPLAST_INLINE Mat<N> operator*(const Mat<N>& A, const Mat<N>& B) {
  Mat<N> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(i, 0) * B(0, j) + A(i, 1) * B(1, j) + A(i, 2) * B(2, j);
  return C;
}
/// C = A^T B.
template <class N>
HEXAPLAST_INLINE Mat<N> transposed_product(const Mat<N>& A, const Mat<N>& B) {
  Mat<N> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(0, i) * B(0, j) + A(1, i) * B(1, j) + A(2, i) * B(2, j);
  return C;
}
/// C = A B^T.
template <class N>
HEXAPLAST_INLINE Mat<N> product_transposed(const Mat<N>& A, const Mat<N>& B) {
  Mat<N> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(i, 0) * B(j, 0) + A(i, 1) * B(j, 1) + A(i, 2) * B(j, 2);
  return C;
}
/// det(F) F^-T.
template <class N>
HEXAPLAST_INLINE Mat<N> cofactor(const Mat<N>& F) {
  Mat<N> C;
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int m = (j + 1) % 3, n = (j + 2) % 3;
      C(i, j) = F(k, m) * F(l, n) - F(k, n) * F(l, m);
    }
  }
  return C;
}
/// Of vectors.
template <class N>
HEXAPLAST_INLINE N dot(const N* a, const N* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class N>
HEXAPLAST_INLINE N dot(const Mat<N>& A, const Mat<N>& B) {
  N sum = A(0, 0) * B(0, 0);
  for (int k = 1; k < 9; ++k) sum += A(k / 3, k % 3) * B(k / 3, k % 3);
  return sum;
}

template <class N>
HEXAPLAST_INLINE N determinant(const Mat<N>& F) {
  const N first[3] = {F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1), F(1, 2) * F(2, 0) - F(1, 0) * F(2, 2),
                      F(1, 0) * F(2, 1) - F(1, 1) * F(2, 0)};
  return dot(F.m[0], first);
}
template <class N>
HEXAPLAST_INLINE Mat<N> scaled(N factor, const Mat<N>& A) {
  Mat<N> B;
  for (int k = 0; k < 9; ++k) B.m[k / 3][k % 3] = factor * A.m[k / 3][k % 3];
  return B;
}
template <class N>
HEXAPLAST_INLINE Sym<N> symmetric_part(const Mat<N>& A) {
  const N half(ScalarOf<N>(0.5));
  return {
      A(0, 0), A(1, 1), A(2, 2), half * (A(1, 2) + A(2, 1)), half * (A(2, 0) + A(0, 2)), half * (A(0, 1) + A(1, 0))};
}

/// The reciprocal basis of three edges (rows): row d is cross(e_{d+1}, e_{d+2}) / det, so that e_c . row d = [c == d].
template <class N>
HEXAPLAST_INLINE Mat<N> reciprocal(const Mat<N>& rows, N& det) {
  Mat<N> C = cofactor(rows);
  det = rows(0, 0) * C(0, 0) + rows(0, 1) * C(0, 1) + rows(0, 2) * C(0, 2);
  const N inverse = N(1) / det;
  for (int k = 0; k < 9; ++k) C.m[k / 3][k % 3] *= inverse;
  return C;
}

/// Vectors at the corners of an element.
template <class N>
struct CornerLanes {
  N at[kCorners][3];
};

// Nested loops over few entries each: the compiler writes them out, one loop over all of them it may not.
template <class N>
HEXAPLAST_INLINE void set_zero(CornerLanes<N>& corners) {
  for (auto& corner : corners.at)
    for (N& entry : corner) entry = N(ScalarOf<N>(0));
}
/// to += corners
template <class N>
HEXAPLAST_INLINE void add(const CornerLanes<N>& corners, CornerLanes<N>& to) {
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) to.at[a][i] += corners.at[a][i];
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
