// SPDX-License-Identifier: LGPL-2.1-or-later
// One number, where a formula may have lanes. With HEXAPLAST_ONE_NUMBER defined there are no lanes, and no Highway:
// what a formula includes then is what a compiler for a device can read.
#if defined(HEXAPLAST_BASE_NUMBER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_NUMBER_INL
#undef HEXAPLAST_BASE_NUMBER_INL
#else
#define HEXAPLAST_BASE_NUMBER_INL
#endif

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "base/inline.hpp"

#ifndef HEXAPLAST_ONE_NUMBER
#include "hwy/highway.h"
#elif !defined(HWY_NAMESPACE)
#define HWY_NAMESPACE one_number
#define HWY_BEFORE_NAMESPACE() static_assert(true)
#define HWY_AFTER_NAMESPACE() static_assert(true)
#endif

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

template <class N>
struct ScalarOfNumber {
  using type = N;
};
/// float or double: what one lane of N holds.
template <class N>
using ScalarOf = typename ScalarOfNumber<N>::type;

template <std::floating_point T>
HEXAPLAST_INLINE T sqrt(T a) {
  return std::sqrt(a);
}
template <std::floating_point T>
HEXAPLAST_INLINE T abs(T a) {
  return std::abs(a);
}
template <std::floating_point T>
HEXAPLAST_INLINE T min(T a, T b) {
  return b < a ? b : a;
}
template <std::floating_point T>
HEXAPLAST_INLINE T max(T a, T b) {
  return a < b ? b : a;
}
/// a where the condition holds, b elsewhere.
template <std::floating_point T>
HEXAPLAST_INLINE T select(bool condition, T a, T b) {
  return condition ? a : b;
}

/// Bit patterns that split() needs.
template <class T>
struct BitsOf {
  using Word = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  static constexpr int kShift = std::numeric_limits<T>::digits - 1;  // of the exponent
  static constexpr Word kOne = __builtin_bit_cast(Word, T(1));
  static constexpr Word kRootOfHalf = __builtin_bit_cast(Word, T(std::numbers::sqrt2 / 2));
  static constexpr Word kFraction = (Word(1) << kShift) - 1;
  static constexpr Word kInteger = __builtin_bit_cast(Word, T(Word(1) << kShift));  // + k has k in its last bits
  static constexpr T kZero = T((Word(1) << kShift) + std::numeric_limits<T>::max_exponent - 1);
};
/// m in [sqrt(1/2), sqrt(2)) and the exponent of a = m 2^exponent, a positive number that is not subnormal.
template <std::floating_point T>
HEXAPLAST_INLINE T split(T a, T& exponent) {
  using B = BitsOf<T>;
  const typename B::Word word = __builtin_bit_cast(typename B::Word, a) + (B::kOne - B::kRootOfHalf);
  exponent = __builtin_bit_cast(T, (word >> B::kShift) | B::kInteger) - B::kZero;
  return __builtin_bit_cast(T, (word & B::kFraction) + B::kRootOfHalf);
}

template <std::floating_point T>
HEXAPLAST_INLINE bool any_positive(T a) {
  return a > 0;
}

// Conditions are masks where a formula has lanes.
HEXAPLAST_INLINE bool both(bool a, bool b) { return a && b; }
HEXAPLAST_INLINE bool not_of(bool a) { return !a; }
template <class T>
HEXAPLAST_INLINE bool all_true(bool condition) {
  return condition;
}
/// One bit per lane.
template <class T>
HEXAPLAST_INLINE std::uint32_t bits(bool condition) {
  return condition ? 1 : 0;
}

/// a where the bit is set, b elsewhere.
template <std::floating_point T>
HEXAPLAST_INLINE T select_bits(std::uint32_t bit_of_a, T a, T b) {
  return bit_of_a != 0 ? a : b;
}

#ifdef HEXAPLAST_ONE_NUMBER
// Stored numbers, where there are no lanes to load.
template <std::floating_point T>
HEXAPLAST_INLINE T load(const T* from) {
  return *from;
}
template <std::floating_point T>
HEXAPLAST_INLINE T load_as(const T* from) {
  return *from;
}
template <std::floating_point T>
HEXAPLAST_INLINE void store_as(T a, T* to) {
  *to = a;
}
/// Bits of a 16-bit floating point number.
struct StoredHalf {
  std::uint16_t bits;
};
#ifndef __CUDA_ARCH__
#if defined(__clang__) && __clang_major__ < 15
using NativeHalf = __fp16;
#else
using NativeHalf = _Float16;
#endif
#endif
HEXAPLAST_INLINE float load_as(const StoredHalf* from) {
#ifdef __CUDA_ARCH__
  float a;
  asm("cvt.f32.f16 %0, %1;" : "=f"(a) : "h"(from->bits));
  return a;
#else
  return static_cast<float>(__builtin_bit_cast(NativeHalf, from->bits));
#endif
}
HEXAPLAST_INLINE void store_as(float a, StoredHalf* to) {
#ifdef __CUDA_ARCH__
  asm("cvt.rn.f16.f32 %0, %1;" : "=h"(to->bits) : "f"(a));
#else
  to->bits = __builtin_bit_cast(std::uint16_t, static_cast<NativeHalf>(a));
#endif
}
#endif

/// Calls f with std::integral_constant 0 ... N-1, written out: the compiler is to see constants, not a loop.
template <int N, class F>
HEXAPLAST_INLINE void unrolled(const F& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, static_cast<int>(I)>()), ...);
  }
  (std::make_index_sequence<N>());
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
