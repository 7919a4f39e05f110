// SPDX-License-Identifier: LGPL-2.1-or-later
// A stand-in for Highway with one lane, whose functions run on host and device: what base/lanes-inl.hpp names. Found
// before the real <hwy/highway.h>, so that the -inl.hpp headers of src compile as they are.
#ifndef HEXAPLAST_DEVICE_HIGHWAY
#define HEXAPLAST_DEVICE_HIGHWAY
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __CUDACC__
#include <cuda_fp16.h>
#define HXP_BOTH __host__ __device__
#else
#define HXP_BOTH
#endif
#define HWY_INLINE HXP_BOTH inline __attribute__((always_inline))
#define HWY_NOINLINE HXP_BOTH inline  // a call would put its arguments on a stack
#define HWY_BEFORE_NAMESPACE() static_assert(true, "")
#define HWY_AFTER_NAMESPACE() static_assert(true, "")
#define HWY_NAMESPACE N_DEVICE
#define HWY_SCALAR 1
#define HWY_TARGET HWY_SCALAR
#define HWY_LANES(T) 1
#define HWY_MIN(a, b) ((a) < (b) ? (a) : (b))
#define HWY_LIKELY(x) (x)
#define HWY_UNLIKELY(x) (x)

namespace hwy {
struct float16_t {
  std::uint16_t bits;
};
namespace HWY_NAMESPACE {
template <class T_>
struct Simd {
  using T = T_;
};
template <class T>
struct Vec1 {
  T raw;
};
struct Mask1 {
  bool raw;
};
template <class T, std::size_t N>
using CappedTag = Simd<T>;
template <class D>
using Vec = Vec1<typename D::T>;
template <class U, class D>
using Rebind = Simd<U>;

HWY_INLINE auto Add(auto a, auto b) { return decltype(a){a.raw + b.raw}; }
HWY_INLINE auto Sub(auto a, auto b) { return decltype(a){a.raw - b.raw}; }
HWY_INLINE auto Mul(auto a, auto b) { return decltype(a){a.raw * b.raw}; }
HWY_INLINE auto Div(auto a, auto b) { return decltype(a){a.raw / b.raw}; }
HWY_INLINE auto Min(auto a, auto b) { return a.raw < b.raw ? a : b; }
HWY_INLINE auto Max(auto a, auto b) { return a.raw > b.raw ? a : b; }
HWY_INLINE auto Neg(auto a) { return decltype(a){-a.raw}; }
HWY_INLINE Mask1 Lt(auto a, auto b) { return {a.raw < b.raw}; }
HWY_INLINE Mask1 Gt(auto a, auto b) { return {a.raw > b.raw}; }
HWY_INLINE Mask1 And(Mask1 a, Mask1 b) { return {a.raw && b.raw}; }
HWY_INLINE Mask1 Not(Mask1 a) { return {!a.raw}; }
HWY_INLINE auto IfThenElse(Mask1 m, auto a, auto b) { return m.raw ? a : b; }
HWY_INLINE auto GetLane(auto a) { return a.raw; }
HWY_INLINE bool AllTrue(auto, Mask1 m) { return m.raw; }
HWY_INLINE bool AllFalse(auto, Mask1 m) { return !m.raw; }
HWY_INLINE std::size_t StoreMaskBits(auto, Mask1 m, std::uint8_t* b) { return *b = m.raw, 1; }
HWY_INLINE Mask1 LoadMaskBits(auto, const std::uint8_t* b) { return {(*b & 1) != 0}; }
template <class D>
HWY_INLINE Vec<D> Set(D, typename D::T s) {
  return {s};
}
template <class D>
HWY_INLINE Vec<D> Load(D, const typename D::T* from) {
  return {*from};
}
template <class D>
HWY_INLINE void Store(Vec<D> a, D, typename D::T* to) {
  *to = a.raw;
}

#ifdef __CUDACC__
HWY_INLINE float from_half(float16_t h) {
  __half_raw raw;
  raw.x = h.bits;
  return __half2float(__half(raw));
}
HWY_INLINE float16_t to_half(float f) {
  const __half_raw raw = __float2half_rn(f);
  return {raw.x};
}
#else
HWY_INLINE float from_half(float16_t h) { return static_cast<float>(__builtin_bit_cast(_Float16, h)); }
HWY_INLINE float16_t to_half(float f) { return __builtin_bit_cast(float16_t, static_cast<_Float16>(f)); }
#endif
HWY_INLINE Vec1<float> PromoteTo(Simd<float>, Vec1<float16_t> a) { return {from_half(a.raw)}; }
HWY_INLINE Vec1<double> PromoteTo(Simd<double>, Vec1<float> a) { return {static_cast<double>(a.raw)}; }
HWY_INLINE Vec1<float> DemoteTo(Simd<float>, Vec1<double> a) { return {static_cast<float>(a.raw)}; }
HWY_INLINE Vec1<float16_t> DemoteTo(Simd<float16_t>, Vec1<float> a) { return {to_half(a.raw)}; }

// of the C library, which has them on the device too
HWY_INLINE Vec1<float> Abs(Vec1<float> a) { return {::fabsf(a.raw)}; }
HWY_INLINE Vec1<double> Abs(Vec1<double> a) { return {::fabs(a.raw)}; }
HWY_INLINE Vec1<float> Sqrt(Vec1<float> a) { return {::sqrtf(a.raw)}; }
HWY_INLINE Vec1<double> Sqrt(Vec1<double> a) { return {::sqrt(a.raw)}; }
HWY_INLINE Vec1<float> Log(Simd<float>, Vec1<float> a) { return {::logf(a.raw)}; }
HWY_INLINE Vec1<double> Log(Simd<double>, Vec1<double> a) { return {::log(a.raw)}; }
}  // namespace HWY_NAMESPACE
}  // namespace hwy
#endif
