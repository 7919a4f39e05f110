// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbers that lie side by side in each element to one element per lane and back, transposed in registers.
#if defined(HEXAPLAST_BASE_TRANSPOSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_TRANSPOSE_INL
#undef HEXAPLAST_BASE_TRANSPOSE_INL
#else
#define HEXAPLAST_BASE_TRANSPOSE_INL
#endif

#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Rows become columns: number c of row r goes to number r of row c. As many rows as lanes.
HEXAPLAST_INLINE void transpose([[maybe_unused]] Lanes<double>* row) {
  using V = Lanes<double>;
  [[maybe_unused]] const V::Tag d;
#if HWY_TARGET != HWY_SCALAR
  if constexpr (V::kCount >= 2) {
    for (int r = 0; r < V::kCount; r += 2) {
      const V a = row[r], b = row[r + 1];
      row[r] = hn::InterleaveLower(d, a.raw(), b.raw());
      row[r + 1] = hn::InterleaveUpper(d, a.raw(), b.raw());
    }
  }
  if constexpr (V::kCount >= 4) {
    for (int r = 0; r < V::kCount; ++r) {
      if (r & 2) continue;
      const V a = row[r], b = row[r + 2];
      row[r] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b.raw()), a.raw());
      row[r + 2] = hn::OddEvenBlocks(b.raw(), hn::SwapAdjacentBlocks(a.raw()));
    }
  }
  if constexpr (V::kCount >= 8) {
    for (int r = 0; r < 4; ++r) {
      const V a = row[r], b = row[r + 4];
      row[r] = hn::ConcatLowerLower(d, b.raw(), a.raw());
      row[r + 4] = hn::ConcatUpperUpper(d, b.raw(), a.raw());
    }
  }
#endif
}

/// number[n] = from[lane][n], n < kNumbers.
template <int kNumbers>
HEXAPLAST_INLINE void load_elements(const std::array<const double*, kBlock>& from, Lanes<double>* number) {
  using V = Lanes<double>;
  constexpr int kWhole = kNumbers / V::kCount * V::kCount;
  for (int n = 0; n < kWhole; n += V::kCount) {
    for (int lane = 0; lane < V::kCount; ++lane) number[n + lane] = hn::LoadU(V::Tag(), from[lane] + n);
    transpose(number + n);
  }
  for (int n = kWhole; n < kNumbers; ++n) {
    alignas(64) double numbers[V::kCount];
    for (int lane = 0; lane < V::kCount; ++lane) numbers[lane] = from[lane][n];
    number[n] = load(numbers);
  }
}

/// to[lane][n] = number[n], n < kNumbers, for the lanes whose bits are set.
template <int kNumbers>
HEXAPLAST_INLINE void store_elements(const Lanes<double>* number, std::uint32_t lanes,
                                     const std::array<double*, kBlock>& to) {
  using V = Lanes<double>;
  constexpr int kWhole = kNumbers / V::kCount * V::kCount;
  for (int n = 0; n < kWhole; n += V::kCount) {
    V row[V::kCount];
    for (int k = 0; k < V::kCount; ++k) row[k] = number[n + k];
    transpose(row);
    for (int lane = 0; lane < V::kCount; ++lane)
      if (lanes >> lane & 1) hn::StoreU(row[lane].raw(), V::Tag(), to[lane] + n);
  }
  for (int n = kWhole; n < kNumbers; ++n) {
    alignas(64) double numbers[V::kCount];
    store(number[n], numbers);
    for (int lane = 0; lane < V::kCount; ++lane)
      if (lanes >> lane & 1) to[lane][n] = numbers[lane];
  }
}

/// of(element) side by side, one element per lane.
template <class T = double, class Of>
HEXAPLAST_INLINE Lanes<T> gather_numbers(const int* elements, const Of& of) {
  alignas(64) T numbers[Lanes<T>::kCount];
  for (int lane = 0; lane < Lanes<T>::kCount; ++lane) numbers[lane] = static_cast<T>(of(elements[lane]));
  return load(numbers);
}

/// address(element), one element per lane.
template <class Number, class Address>
HEXAPLAST_INLINE std::array<Number*, kBlock> addresses(const int* elements, const Address& address) {
  std::array<Number*, kBlock> at;
  for (int lane = 0; lane < Lanes<double>::kCount; ++lane) at[lane] = address(elements[lane]);
  return at;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
