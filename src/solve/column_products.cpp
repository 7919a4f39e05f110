// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the function at the end chooses at run time.
#include "solve/column_products.hpp"

#include <algorithm>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/column_products.cpp"
#include "hwy/foreach_target.h"
//
#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

constexpr std::ptrdiff_t kRowsAtOnce = 512;  // that stay in the cache
constexpr int kOfX = 4, kOfR = 2;            // columns that are multiplied at once

/// sums[i][j] += x[i] . r[j] over `count` rows.
void add_dots(const double* const* x, const double* const* r, std::ptrdiff_t count, double sums[kOfX][kOfR]) {
  const typename Lanes<double>::Tag d;
  const auto width = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  auto s00 = hn::Zero(d), s10 = s00, s20 = s00, s30 = s00, s01 = s00, s11 = s00, s21 = s00, s31 = s00;
  std::ptrdiff_t k = 0;
  for (; k + width <= count; k += width) {
    const auto r0 = hn::LoadU(d, r[0] + k), r1 = hn::LoadU(d, r[1] + k);
    const auto x0 = hn::LoadU(d, x[0] + k), x1 = hn::LoadU(d, x[1] + k);
    s00 = hn::MulAdd(x0, r0, s00);
    s01 = hn::MulAdd(x0, r1, s01);
    s10 = hn::MulAdd(x1, r0, s10);
    s11 = hn::MulAdd(x1, r1, s11);
    const auto x2 = hn::LoadU(d, x[2] + k), x3 = hn::LoadU(d, x[3] + k);
    s20 = hn::MulAdd(x2, r0, s20);
    s21 = hn::MulAdd(x2, r1, s21);
    s30 = hn::MulAdd(x3, r0, s30);
    s31 = hn::MulAdd(x3, r1, s31);
  }
  const auto add = [&](double& sum, auto lanes) { sum += hn::GetLane(hn::SumOfLanes(d, lanes)); };
  add(sums[0][0], s00), add(sums[0][1], s01), add(sums[1][0], s10), add(sums[1][1], s11);
  add(sums[2][0], s20), add(sums[2][1], s21), add(sums[3][0], s30), add(sums[3][1], s31);
  for (; k < count; ++k)
    for (int i = 0; i < kOfX; ++i)
      for (int j = 0; j < kOfR; ++j) sums[i][j] += x[i][k] * r[j][k];
}

/// products[i + num_x j] = X_i . R_j; where columns are left that fill no block, the last one stands for those that are
/// not there.
void multiply_columns(const double* X, std::ptrdiff_t x_stride, int num_x, const double* R, std::ptrdiff_t r_stride,
                      int num_r, std::ptrdiff_t rows, double* products, std::ptrdiff_t stride) {
  for (int j = 0; j < num_r; ++j) std::fill_n(products + j * stride, num_x, 0.0);
  for (std::ptrdiff_t begin = 0; begin < rows; begin += kRowsAtOnce) {
    const std::ptrdiff_t count = std::min(kRowsAtOnce, rows - begin);
    for (int j = 0; j < num_r; j += kOfR)
      for (int i = 0; i < num_x; i += kOfX) {
        const double *x[kOfX], *r[kOfR];
        for (int a = 0; a < kOfX; ++a) x[a] = X + begin + x_stride * std::min(i + a, num_x - 1);
        for (int b = 0; b < kOfR; ++b) r[b] = R + begin + r_stride * std::min(j + b, num_r - 1);
        double sums[kOfX][kOfR] = {};
        add_dots(x, r, count, sums);
        for (int b = 0; b < std::min(kOfR, num_r - j); ++b)
          for (int a = 0; a < std::min(kOfX, num_x - i); ++a) products[i + a + stride * (j + b)] += sums[a][b];
      }
  }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(multiply_columns);

void column_products(const Eigen::Ref<const Eigen::MatrixXd>& X, const Eigen::Ref<const Eigen::MatrixXd>& R,
                     Eigen::Ref<Eigen::MatrixXd> products) {
  HWY_DYNAMIC_DISPATCH(multiply_columns)
  (X.data(), X.outerStride(), static_cast<int>(X.cols()), R.data(), R.outerStride(), static_cast<int>(R.cols()),
   X.rows(), products.data(), products.outerStride());
}

}  // namespace hexaplast
#endif
