// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#include "solve/slot_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/slot_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

constexpr std::size_t kRun = 1024;  // numbers that are summed in T before the sum is taken into a double

/// Calls body(i) for every register of [0, size); size is a multiple of four numbers, slots begin at any of them.
template <class T, class Body>
HEXAPLAST_INLINE void for_each_register(std::size_t size, const Body& body) {
  std::size_t i = 0;
  for (; i + Lanes<T>::kCount <= size; i += Lanes<T>::kCount) body(typename Lanes<T>::Tag(), i);
  if constexpr (Lanes<T>::kCount > 4) {
    for (; i < size; i += 4) body(hn::CappedTag<T, 4>(), i);
  }
}

template <class T>
void update_direction(std::size_t size, T beta, const T* r, const T* inverse, const T* diagonal, T* p, T* Ap) {
  for_each_register<T>(
      size, [&](auto d, std::size_t i) __attribute__((always_inline)) {
        auto z = hn::LoadU(d, r + i);
        if (inverse) z = hn::Mul(z, hn::LoadU(d, inverse + i));
        const auto next = hn::MulAdd(hn::Set(d, beta), hn::LoadU(d, p + i), z);
        hn::StoreU(next, d, p + i);
        hn::StoreU(hn::Mul(next, hn::LoadU(d, diagonal + i)), d, Ap + i);
      });
}

template <class T>
double advance_all(std::size_t size, T alpha, const T* p, const T* Ap, const T* inverse, T* x, T* r, double& r_z) {
  double sum = 0;
  r_z = 0;
  for (std::size_t begin = 0; begin < size; begin += kRun) {
    const std::size_t count = HWY_MIN(kRun, size - begin);
    T rr = 0, rz = 0;
    const hn::CappedTag<T, 4> four;
    const typename Lanes<T>::Tag wide;
    auto rr_wide = hn::Zero(wide), rz_wide = hn::Zero(wide);
    auto rr_four = hn::Zero(four), rz_four = hn::Zero(four);
    for_each_register<T>(
        count, [&](auto d, std::size_t k) __attribute__((always_inline)) {
          const std::size_t i = begin + k;
          hn::StoreU(hn::MulAdd(hn::Set(d, alpha), hn::LoadU(d, p + i), hn::LoadU(d, x + i)), d, x + i);
          const auto next = hn::NegMulAdd(hn::Set(d, alpha), hn::LoadU(d, Ap + i), hn::LoadU(d, r + i));
          hn::StoreU(next, d, r + i);
          const auto z = inverse ? hn::Mul(next, hn::LoadU(d, inverse + i)) : next;
          if constexpr (std::is_same_v<decltype(d), typename Lanes<T>::Tag>) {
            rr_wide = hn::MulAdd(next, next, rr_wide);
            rz_wide = hn::MulAdd(next, z, rz_wide);
          } else {
            rr_four = hn::MulAdd(next, next, rr_four);
            rz_four = hn::MulAdd(next, z, rz_four);
          }
        });
    rr = hn::GetLane(hn::SumOfLanes(wide, rr_wide)) + hn::GetLane(hn::SumOfLanes(four, rr_four));
    rz = hn::GetLane(hn::SumOfLanes(wide, rz_wide)) + hn::GetLane(hn::SumOfLanes(four, rz_four));
    sum += static_cast<double>(rr);
    r_z += static_cast<double>(rz);
  }
  return sum;
}

template <class T>
double dot_all(std::size_t size, const T* a, const T* b) {
  double sum = 0;
  for (std::size_t begin = 0; begin < size; begin += kRun) {
    const std::size_t count = HWY_MIN(kRun, size - begin);
    const hn::CappedTag<T, 4> four;
    const typename Lanes<T>::Tag wide;
    auto sum_wide = hn::Zero(wide);
    auto sum_four = hn::Zero(four);
    for_each_register<T>(
        count, [&](auto d, std::size_t k) __attribute__((always_inline)) {
          const auto left = hn::LoadU(d, a + begin + k), right = hn::LoadU(d, b + begin + k);
          if constexpr (std::is_same_v<decltype(d), typename Lanes<T>::Tag>)
            sum_wide = hn::MulAdd(left, right, sum_wide);
          else
            sum_four = hn::MulAdd(left, right, sum_four);
        });
    sum +=
        static_cast<double>(hn::GetLane(hn::SumOfLanes(wide, sum_wide)) + hn::GetLane(hn::SumOfLanes(four, sum_four)));
  }
  return sum;
}

void smooth_float(std::size_t size, float a, float b, const float* inverse, const float* diagonal, float* r, float* d_,
                  float* x) {
  const bool begins = a == 0;  // whatever an earlier solve has left in d_
  for_each_register<float>(
      size, [&](auto d, std::size_t i) __attribute__((always_inline)) {
        const auto residual = hn::LoadU(d, r + i);
        const auto scaled = hn::Mul(hn::Mul(hn::Set(d, b), hn::LoadU(d, inverse + i)), residual);
        const auto before = begins ? hn::Zero(d) : hn::LoadU(d, d_ + i);
        const auto next = hn::MulAdd(hn::Set(d, a), before, scaled);
        hn::StoreU(next, d, d_ + i);
        hn::StoreU(hn::Add(hn::LoadU(d, x + i), next), d, x + i);
        if (diagonal) hn::StoreU(hn::NegMulAdd(hn::LoadU(d, diagonal + i), next, residual), d, r + i);
      });
}

#define HEXAPLAST_SLOT_KERNELS(T)                                                                                 \
  void turn_##T(std::size_t n, T beta, const T* r, const T* inverse, const T* diagonal, T* p, T* Ap) {            \
    update_direction(n, beta, r, inverse, diagonal, p, Ap);                                                       \
  }                                                                                                               \
  double advance_##T(std::size_t n, T alpha, const T* p, const T* Ap, const T* inverse, T* x, T* r, double& rz) { \
    return advance_all(n, alpha, p, Ap, inverse, x, r, rz);                                                       \
  }                                                                                                               \
  double dot_##T(std::size_t n, const T* a, const T* b) { return dot_all(n, a, b); }
HEXAPLAST_SLOT_KERNELS(double)
HEXAPLAST_SLOT_KERNELS(float)

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

#define HEXAPLAST_EXPORT_SLOT_KERNELS(T)                                                                              \
  HWY_EXPORT(turn_##T);                                                                                               \
  HWY_EXPORT(advance_##T);                                                                                            \
  HWY_EXPORT(dot_##T);                                                                                                \
  template <>                                                                                                         \
  void update_search_direction(std::size_t n, T beta, const T* r, const T* inverse, const T* diagonal, T* p, T* Ap) { \
    HWY_DYNAMIC_DISPATCH(turn_##T)(n, beta, r, inverse, diagonal, p, Ap);                                             \
  }                                                                                                                   \
  template <>                                                                                                         \
  double advance(std::size_t n, T alpha, const T* p, const T* Ap, const T* inverse, T* x, T* r, double& r_z) {        \
    return HWY_DYNAMIC_DISPATCH(advance_##T)(n, alpha, p, Ap, inverse, x, r, r_z);                                    \
  }                                                                                                                   \
  template <>                                                                                                         \
  double slot_dot(std::size_t n, const T* a, const T* b) {                                                            \
    return HWY_DYNAMIC_DISPATCH(dot_##T)(n, a, b);                                                                    \
  }
HEXAPLAST_EXPORT_SLOT_KERNELS(double)
HEXAPLAST_EXPORT_SLOT_KERNELS(float)

HWY_EXPORT(smooth_float);
void smooth(std::size_t n, float a, float b, const float* inverse, const float* diagonal, float* r, float* d,
            float* x) {
  HWY_DYNAMIC_DISPATCH(smooth_float)(n, a, b, inverse, diagonal, r, d, x);
}

}  // namespace hexaplast
#endif
