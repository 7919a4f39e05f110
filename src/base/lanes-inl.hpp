// SPDX-License-Identifier: LGPL-2.1-or-later
// Small dense algebra on one element per SIMD lane. Compiled once per instruction set: include it inside a file that
// foreach_target.h includes again for each, never from an ordinary header.
#if defined(HEXAPLAST_BASE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_LANES_INL
#undef HEXAPLAST_BASE_LANES_INL
#else
#define HEXAPLAST_BASE_LANES_INL
#endif

#include "base/number-inl.hpp"

#ifndef HEXAPLAST_ONE_NUMBER
#include <cstdint>

#include "base/blocks.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// As many numbers as one register of the instruction set holds, at most one block.
template <class T>
struct Lanes {
  using Scalar = T;
  using Tag = hn::CappedTag<T, kBlock>;
  using Register = hn::Vec<Tag>;
  static constexpr int kCount = static_cast<int>(HWY_MIN(HWY_LANES(T), kBlock));

  Lanes() = default;
  HEXAPLAST_INLINE Lanes(Register v) : v_(v) {}           // NOLINT: a register is what it is
  HEXAPLAST_INLINE Lanes(T s) : v_(hn::Set(Tag(), s)) {}  // NOLINT: numbers mix with lanes
  HEXAPLAST_INLINE operator Register() const { return v_; }
  HEXAPLAST_INLINE Register raw() const { return v_; }

  HEXAPLAST_INLINE Lanes& operator+=(Lanes b) { return *this = *this + b; }
  HEXAPLAST_INLINE Lanes& operator-=(Lanes b) { return *this = *this - b; }
  HEXAPLAST_INLINE Lanes& operator*=(Lanes b) { return *this = *this * b; }

  friend HEXAPLAST_INLINE Lanes operator+(Lanes a, Lanes b) { return hn::Add(a.v_, b.v_); }
  friend HEXAPLAST_INLINE Lanes operator-(Lanes a, Lanes b) { return hn::Sub(a.v_, b.v_); }
  friend HEXAPLAST_INLINE Lanes operator*(Lanes a, Lanes b) { return hn::Mul(a.v_, b.v_); }
  friend HEXAPLAST_INLINE Lanes operator/(Lanes a, Lanes b) { return hn::Div(a.v_, b.v_); }
  friend HEXAPLAST_INLINE Lanes operator-(Lanes a) { return hn::Neg(a.v_); }

  friend HEXAPLAST_INLINE auto operator<(Lanes a, Lanes b) { return hn::Lt(a.v_, b.v_); }
  friend HEXAPLAST_INLINE auto operator>(Lanes a, Lanes b) { return hn::Gt(a.v_, b.v_); }

 private:
  Register v_;
};

template <class T>
HEXAPLAST_INLINE Lanes<T> sqrt(Lanes<T> a) {
  return hn::Sqrt(typename Lanes<T>::Register(a));
}
template <class T>
HEXAPLAST_INLINE Lanes<T> abs(Lanes<T> a) {
  return hn::Abs(typename Lanes<T>::Register(a));
}
template <class T>
HEXAPLAST_INLINE Lanes<T> min(Lanes<T> a, Lanes<T> b) {
  return hn::Min(typename Lanes<T>::Register(a), typename Lanes<T>::Register(b));
}
template <class T>
HEXAPLAST_INLINE Lanes<T> max(Lanes<T> a, Lanes<T> b) {
  return hn::Max(typename Lanes<T>::Register(a), typename Lanes<T>::Register(b));
}
/// a where the mask holds, b elsewhere.
template <class T, class Mask>
HEXAPLAST_INLINE Lanes<T> select(Mask mask, Lanes<T> a, Lanes<T> b) {
  return hn::IfThenElse(mask, typename Lanes<T>::Register(a), typename Lanes<T>::Register(b));
}
template <class T>
HEXAPLAST_INLINE Lanes<T> split(Lanes<T> a, Lanes<T>& exponent) {
  using B = BitsOf<T>;
  const typename Lanes<T>::Tag d;
  const hn::RebindToUnsigned<typename Lanes<T>::Tag> u;
  const auto word = hn::Add(hn::BitCast(u, a.raw()), hn::Set(u, B::kOne - B::kRootOfHalf));
  const auto integer = hn::Or(hn::ShiftRight<B::kShift>(word), hn::Set(u, B::kInteger));
  exponent = hn::Sub(hn::BitCast(d, integer), hn::Set(d, B::kZero));
  return hn::BitCast(d, hn::Add(hn::And(word, hn::Set(u, B::kFraction)), hn::Set(u, B::kRootOfHalf)));
}
template <class T>
HEXAPLAST_INLINE bool any_positive(Lanes<T> a) {
  return !hn::AllFalse(typename Lanes<T>::Tag(), a > Lanes<T>(T(0)));
}

template <class T>
struct ScalarOfNumber<Lanes<T>> {
  using type = T;
};

template <class Mask>
HEXAPLAST_INLINE Mask both(Mask a, Mask b) {
  return hn::And(a, b);
}
template <class Mask>
HEXAPLAST_INLINE Mask not_of(Mask a) {
  return hn::Not(a);
}
template <class T, class Mask>
HEXAPLAST_INLINE bool all_true(Mask mask) {
  return hn::AllTrue(typename Lanes<T>::Tag(), mask);
}
/// One bit per lane.
template <class T, class Mask>
HEXAPLAST_INLINE std::uint32_t bits(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(typename Lanes<T>::Tag(), mask, bytes);
  std::uint32_t word = 0;
  for (int i = 0; i < (Lanes<T>::kCount + 7) / 8; ++i) word |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return word & ((1u << Lanes<T>::kCount) - 1);
}

/// Numbers of one block, as they are stored, in the precision of the lanes.
template <class T>
HEXAPLAST_INLINE Lanes<T> load(const T* from) {
  return hn::Load(typename Lanes<T>::Tag(), from);
}
template <class T>
HEXAPLAST_INLINE void store(Lanes<T> a, T* to) {
  hn::Store(typename Lanes<T>::Register(a), typename Lanes<T>::Tag(), to);
}
template <class T>
HEXAPLAST_INLINE Lanes<T> load_as(const T* from) {
  return load(from);
}
/// A half of lanes as it is stored.
using StoredHalf = hwy::float16_t;
HEXAPLAST_INLINE Lanes<float> load_as(const StoredHalf* from) {
  const hn::Rebind<StoredHalf, Lanes<float>::Tag> half;
  return hn::PromoteTo(Lanes<float>::Tag(), hn::Load(half, from));
}

template <class T>
HEXAPLAST_INLINE void store_as(Lanes<T> a, T* to) {
  store(a, to);
}
HEXAPLAST_INLINE void store_as(Lanes<double> a, float* to) {
  const hn::Rebind<float, Lanes<double>::Tag> d;
  hn::Store(hn::DemoteTo(d, Lanes<double>::Register(a)), d, to);
}
HEXAPLAST_INLINE void store_as(Lanes<double> a, StoredHalf* to) {
  const hn::Rebind<float, Lanes<double>::Tag> single;
  const hn::Rebind<StoredHalf, Lanes<double>::Tag> half;
  hn::Store(hn::DemoteTo(half, hn::DemoteTo(single, Lanes<double>::Register(a))), half, to);
}
HEXAPLAST_INLINE void store_as(Lanes<float> a, StoredHalf* to) {
  const hn::Rebind<StoredHalf, Lanes<float>::Tag> half;
  hn::Store(hn::DemoteTo(half, a.raw()), half, to);
}
// Lanes of doubles beside lanes of T: a register of T has the elements of kParts<T> registers of doubles.
template <class T>
inline constexpr int kParts = Lanes<T>::kCount / Lanes<double>::kCount;

HEXAPLAST_INLINE Lanes<double> narrow_as(const Lanes<double>* parts, double) { return *parts; }
HEXAPLAST_INLINE Lanes<float> narrow_as(const Lanes<double>* parts, float) {
  const hn::Rebind<float, Lanes<double>::Tag> part;
#if HWY_TARGET == HWY_SCALAR
  return hn::DemoteTo(part, parts->raw());
#else
  return hn::Combine(Lanes<float>::Tag(), hn::DemoteTo(part, parts[1].raw()), hn::DemoteTo(part, parts[0].raw()));
#endif
}
/// The elements of kParts<T> registers of doubles, rounded to T.
template <class T>
HEXAPLAST_INLINE Lanes<T> narrow(const Lanes<double>* parts) {
  return narrow_as(parts, T());
}

/// Stored numbers, rounded to T.
template <class T>
HEXAPLAST_INLINE Lanes<T> load_narrow(const double* from) {
  Lanes<double> parts[kParts<T>];
  for (int part = 0; part < kParts<T>; ++part) parts[part] = load(from + part * Lanes<double>::kCount);
  return narrow<T>(parts);
}

/// The elements of one of the parts.
HEXAPLAST_INLINE Lanes<double> widen(Lanes<double> a, int) { return a; }
HEXAPLAST_INLINE Lanes<double> widen(Lanes<float> a, [[maybe_unused]] int part) {
  const Lanes<double>::Tag d;
#if HWY_TARGET == HWY_SCALAR
  return hn::PromoteTo(d, a.raw());
#else
  const hn::Half<Lanes<float>::Tag> half;
  return hn::PromoteTo(d, part == 0 ? hn::LowerHalf(half, a.raw()) : hn::UpperHalf(half, a.raw()));
#endif
}

/// The lanes of which the bits are set from a, the others from b.
template <class T>
HEXAPLAST_INLINE Lanes<T> select_bits(std::uint32_t bits_of_a, Lanes<T> a, Lanes<T> b) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits_of_a), static_cast<std::uint8_t>(bits_of_a >> 8)};
  return hn::IfThenElse(hn::LoadMaskBits(typename Lanes<T>::Tag(), bytes), typename Lanes<T>::Register(a),
                        typename Lanes<T>::Register(b));
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#endif
