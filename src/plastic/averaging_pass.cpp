// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plastic/averaging_pass.cpp"
#include "hwy/foreach_target.h"
//
#include "base/transpose-inl.hpp"
#include "kinematics/gradients-inl.hpp"
#include "plastic/averaging_pass.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

template <class V>
HWY_INLINE void take_mean_out(CornerLanes<V>& u) {
  for (int i = 0; i < 3; ++i) {
    V mean = u.at[0][i];
    for (int a = 1; a < kCorners; ++a) mean += u.at[a][i];
    mean *= V(typename V::Scalar(1.0 / kCorners));
    for (int a = 0; a < kCorners; ++a) u.at[a][i] -= mean;
  }
}

template <class V>
HWY_INLINE void cross(const V* a, const V* b, V* c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/// u <- (1 + r) P u - B (B^T B)^-1 B^T u, or P u.
void add_product(const AveragingOperator& op, int chunk, double factor, const double* p, double* Ap) {
  using V = Lanes<double>;
  using Op = AveragingOperator;
  const Partition& partition = op.partition();
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      const double* coef = op.coef.data() + static_cast<std::size_t>(block) * Op::kComponents * kBlock + lane;
      const V element_weight = load(coef + Op::kWeight * kBlock), weight = V(factor) * element_weight;
      if (!bits<double>(element_weight > V(0.0))) continue;
      CornerLanes<V> u;
      gather(partition, block, lane, p, u);
      take_mean_out(u);
      if (op.projects) {
        V moment[3] = {V(0.0), V(0.0), V(0.0)};
        for (int a = 0; a < kCorners; ++a) {
          V arm[3], c[3];
          for (int i = 0; i < 3; ++i) arm[i] = load(coef + (Op::kArm + 3 * a + i) * kBlock);
          cross(arm, u.at[a], c);
          for (int i = 0; i < 3; ++i) moment[i] += c[i];
        }
        V J[6], spin[3];
        for (int k = 0; k < 6; ++k) J[k] = load(coef + (Op::kInertia + k) * kBlock);
        spin[0] = J[0] * moment[0] + J[5] * moment[1] + J[4] * moment[2];
        spin[1] = J[5] * moment[0] + J[1] * moment[1] + J[3] * moment[2];
        spin[2] = J[4] * moment[0] + J[3] * moment[1] + J[2] * moment[2];
        const V definite(1 + kRegularisation);
        for (int a = 0; a < kCorners; ++a) {
          V arm[3], c[3];
          for (int i = 0; i < 3; ++i) arm[i] = load(coef + (Op::kArm + 3 * a + i) * kBlock);
          cross(spin, arm, c);
          for (int i = 0; i < 3; ++i) u.at[a][i] = weight * (definite * u.at[a][i] - c[i]);
        }
      } else {
        for (int k = 0; k < 3 * kCorners; ++k) u.at[k / 3][k % 3] *= weight;
      }
      scatter_add(u, partition, block, lane, Ap);
    }
  }
}

/// Of P, which is close enough for a preconditioner of both: 7/8 per element.
void add_diagonal(const AveragingOperator& op, int chunk, double factor, double* diagonal) {
  using V = Lanes<double>;
  using Op = AveragingOperator;
  const Partition& partition = op.partition();
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      CornerLanes<V> part;
      const double* weight =
          op.coef.data() + (static_cast<std::size_t>(block) * Op::kComponents + Op::kWeight) * kBlock;
      const V one = V(factor * (1 - 1.0 / kCorners)) * load(weight + lane);
      for (auto& corner : part.at)
        for (V& entry : corner) entry = one;
      scatter_add(part, partition, block, lane, diagonal);
    }
}

/// Arms and (B^T B)^-1 = (sum |arm|^2 I - arm arm^T)^-1; a shape flattened to a line keeps its free turn out by the
/// floor.
HWY_INLINE void store_arms(const CornerLanes<Lanes<double>>& arm, double* coef) {
  using V = Lanes<double>;
  for (int k = 0; k < 3 * kCorners; ++k) store(arm.at[k / 3][k % 3], coef + (AveragingOperator::kArm + k) * kBlock);
  const Mat<V> outer = outer_sum(arm, arm);
  const V squares = outer(0, 0) + outer(1, 1) + outer(2, 2);
  Mat<V> inertia;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) inertia(i, j) = V(0.0) - outer(i, j);
  for (int i = 0; i < 3; ++i) inertia(i, i) += squares * V(1 + 1e-14);
  V det;
  const Mat<V> inverse = reciprocal(inertia, det);
  const V J[6] = {inverse(0, 0), inverse(1, 1), inverse(2, 2), inverse(1, 2), inverse(2, 0), inverse(0, 1)};
  for (int k = 0; k < 6; ++k) store(J[k], coef + (AveragingOperator::kInertia + k) * kBlock);
}

/// A rest shape for elements that are not there: [axis][corner].
constexpr std::array<double, 3 * kCorners> kCube = [] {
  std::array<double, 3 * kCorners> cube{};
  for (int n = 0; n < 3 * kCorners; ++n) cube[n] = 0.5 * kCornerSign[n % kCorners][n / kCorners];
  return cube;
}();

HWY_INLINE void fit_lanes(const FitPass& pass, int block, int lane, double& misfit, double& size) {
  using V = Lanes<double>;
  const std::uint32_t present = static_cast<std::uint32_t>(pass.present[block]) >> lane;
  const int* elements = pass.partition.element_of_place.data() + block * kBlock + lane;
  CornerLanes<V> x, t;
  gather(pass.partition, block, lane, pass.plastic_rest, x);
  replace_absent(present, x);
  take_mean_out(x);

  // rest shapes of the elements that are there, a cube for the others
  std::array<const double*, kBlock> shapes;
  for (int k = 0; k < V::kCount; ++k) shapes[k] = present >> k & 1 ? pass.rest_shape[elements[k]].data() : kCube.data();
  V numbers[3 * kCorners];
  load_elements<3 * kCorners>(shapes, numbers);
  CornerLanes<V> y;
  for (int n = 0; n < 3 * kCorners; ++n) y.at[n % kCorners][n / kCorners] = numbers[n];

  const Mat<V> R = safe_polar(outer_sum(x, y)).R;
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) t.at[a][i] = R(i, 0) * y.at[a][0] + R(i, 1) * y.at[a][1] + R(i, 2) * y.at[a][2];
  V map[9];
  for (int n = 0; n < 9; ++n) map[n] = R(n % 3, n / 3);
  store_elements<9>(map, present,
                    addresses<double>(elements, [&](int e) { return e < 0 ? nullptr : pass.rotation_map[e].data(); }));

  V misfits(0.0), t_t(0.0);
  CornerLanes<V> difference;
  const V one = select_bits(present, V(1.0), V(0.0));
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) {
      difference.at[a][i] = one * (t.at[a][i] - x.at[a][i]);
      misfits += difference.at[a][i] * difference.at[a][i];
      t_t += t.at[a][i] * t.at[a][i];
    }
  misfit += hn::GetLane(hn::SumOfLanes(V::Tag(), misfits.raw()));
  size += hn::GetLane(hn::SumOfLanes(V::Tag(), (one * t_t).raw()));
  if (pass.gradient) scatter_add(difference, pass.partition, block, lane, pass.gradient);

  if (pass.coef) {
    store_arms(x, pass.coef + static_cast<std::size_t>(block) * AveragingOperator::kComponents * kBlock + lane);
  }
}

void fit(const FitPass& pass, int chunk) {
  for (int block = pass.partition.first_block[chunk]; block < pass.partition.first_block[chunk + 1]; ++block) {
    double misfit = 0, size = 0;
    for (int lane = 0; lane < kBlock && pass.present[block]; lane += Lanes<double>::kCount)
      fit_lanes(pass, block, lane, misfit, size);
    pass.misfit[block] = misfit;
    if (pass.size) pass.size[block] = size;
  }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

AveragingOperator::AveragingOperator(std::shared_ptr<const Partition> partition)
    : coef(static_cast<std::size_t>(partition->num_blocks) * kComponents * kBlock, 0),
      partition_(std::move(partition)) {}

HWY_EXPORT(add_product);
void AveragingOperator::add_product(int chunk, double factor, const double* p, double* Ap) const {
  HWY_DYNAMIC_DISPATCH(add_product)(*this, chunk, factor, p, Ap);
}

HWY_EXPORT(add_diagonal);
void AveragingOperator::add_diagonal(int chunk, double factor, double* diagonal) const {
  HWY_DYNAMIC_DISPATCH(add_diagonal)(*this, chunk, factor, diagonal);
}

HWY_EXPORT(fit);
void fit_elements(const FitPass& pass, int chunk) { HWY_DYNAMIC_DISPATCH(fit)(pass, chunk); }

}  // namespace hexaplast
#endif
