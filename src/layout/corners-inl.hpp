// SPDX-License-Identifier: LGPL-2.1-or-later
// Nodal values to the corners of one element per lane and back, without hardware gather or scatter: four numbers per
// node are loaded at once and transposed in registers.
#if defined(HEXAPLAST_LAYOUT_CORNERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_LAYOUT_CORNERS_INL
#undef HEXAPLAST_LAYOUT_CORNERS_INL
#else
#define HEXAPLAST_LAYOUT_CORNERS_INL
#endif

#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"
#include "hexaplast/base/types.hpp"
#include "layout/partition.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Corners of elements that are not there become those of the unit cube, so that everything computed of them is finite.
template <class V>
HEXAPLAST_INLINE void replace_absent(std::uint32_t present, CornerLanes<V>& x) {
  using T = typename V::Scalar;
  constexpr std::uint32_t kAll = (1u << V::kCount) - 1;
  if ((present & kAll) == kAll) [[likely]]
    return;
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) x.at[a][i] = select_bits(present, x.at[a][i], V(T(kCornerSign[a][i] > 0 ? 1 : 0)));
}

#if HWY_TARGET == HWY_SCALAR

template <bool kInRuns, class T>
HEXAPLAST_INLINE void gather_corner(const T* field, const int* slot, Lanes<T>* at) {
  for (int i = 0; i < 3; ++i) at[i] = Lanes<T>(field[4 * static_cast<std::ptrdiff_t>(*slot) + i]);
}
template <bool kInRuns, class T>
HEXAPLAST_INLINE void scatter_corner(const Lanes<T>* at, T* field, const int* slot) {
  for (int i = 0; i < 3; ++i) field[4 * static_cast<std::ptrdiff_t>(*slot) + i] += hn::GetLane(at[i].raw());
}

#else

/// The 128-bit pieces at base + offset[0], base + offset[stride], ... side by side in one register.
template <class D, class T>
HEXAPLAST_INLINE hn::Vec<D> join_pieces(D d, const T* base, const int* slot, int stride) {
  if constexpr (hn::MaxLanes(D()) * sizeof(T) <= 16) {
    return hn::Load(d, base + 4 * static_cast<std::ptrdiff_t>(*slot));
  } else {
    const hn::Half<D> half;
    constexpr int kPieces = static_cast<int>(hn::MaxLanes(hn::Half<D>()) * sizeof(T) / 16);
    return hn::Combine(d, join_pieces(half, base, slot + kPieces * stride, stride),
                       join_pieces(half, base, slot, stride));
  }
}

/// Adds the 128-bit pieces of a register to memory, in ascending order.
template <class D, class T>
HEXAPLAST_INLINE void add_pieces(D d, hn::Vec<D> pieces, T* base, const int* slot, int stride) {
  if constexpr (hn::MaxLanes(D()) * sizeof(T) <= 16) {
    T* to = base + 4 * static_cast<std::ptrdiff_t>(*slot);
    hn::Store(hn::Add(hn::Load(d, to), pieces), d, to);
  } else {
    const hn::Half<D> half;
    constexpr int kPieces = static_cast<int>(hn::MaxLanes(hn::Half<D>()) * sizeof(T) / 16);
    add_pieces(half, hn::LowerHalf(half, pieces), base, slot, stride);
    add_pieces(half, hn::UpperHalf(half, pieces), base, slot + kPieces * stride, stride);
  }
}

/// Four registers of whole nodes: in blocks of runs those from slot[0], slot[1], slot[2], slot[3] on, of which each
/// register then holds the nodes that belong to every fourth lane; otherwise collected one by one.
template <bool kInRuns>
HEXAPLAST_INLINE void load_nodes(const float* field, const int* slot, hn::Vec<Lanes<float>::Tag>* nodes) {
  using D = Lanes<float>::Tag;
  const D d;
  for (int k = 0; k < 4; ++k)
    nodes[k] =
        kInRuns ? hn::LoadU(d, field + 4 * static_cast<std::ptrdiff_t>(slot[k])) : join_pieces(d, field, slot + k, 4);
}
template <bool kInRuns>
HEXAPLAST_INLINE void add_nodes(const hn::Vec<Lanes<float>::Tag>* nodes, float* field, const int* slot) {
  using D = Lanes<float>::Tag;
  const D d;
  for (int k = 0; k < 4; ++k) {
    if constexpr (kInRuns) {
      float* to = field + 4 * static_cast<std::ptrdiff_t>(slot[k]);
      hn::StoreU(hn::Add(hn::LoadU(d, to), nodes[k]), d, to);
    } else {
      add_pieces(d, nodes[k], field, slot + k, 4);
    }
  }
}

/// One register of four floats per node becomes three of one coordinate each.
template <bool kInRuns>
HEXAPLAST_INLINE void gather_corner(const float* field, const int* slot, Lanes<float>* at) {
  using D = Lanes<float>::Tag;
  const D d;
  hn::Vec<D> n[4];
  load_nodes<kInRuns>(field, slot, n);
  const hn::Vec<D> ac = hn::InterleaveLower(d, n[0], n[2]), be = hn::InterleaveLower(d, n[1], n[3]);
  at[0] = hn::InterleaveLower(d, ac, be);
  at[1] = hn::InterleaveUpper(d, ac, be);
  at[2] = hn::InterleaveLower(d, hn::InterleaveUpper(d, n[0], n[2]), hn::InterleaveUpper(d, n[1], n[3]));
}
template <bool kInRuns>
HEXAPLAST_INLINE void scatter_corner(const Lanes<float>* at, float* field, const int* slot) {
  using D = Lanes<float>::Tag;
  const D d;
  const hn::Vec<D> none = hn::Zero(d), x = at[0], y = at[1], z = at[2];
  const hn::Vec<D> xz = hn::InterleaveLower(d, x, z), y_ = hn::InterleaveLower(d, y, none);
  const hn::Vec<D> XZ = hn::InterleaveUpper(d, x, z), Y_ = hn::InterleaveUpper(d, y, none);
  const hn::Vec<D> nodes[4] = {hn::InterleaveLower(d, xz, y_), hn::InterleaveUpper(d, xz, y_),
                               hn::InterleaveLower(d, XZ, Y_), hn::InterleaveUpper(d, XZ, Y_)};
  add_nodes<kInRuns>(nodes, field, slot);
}

/// Registers of doubles hold one node, or two of a run, or half of one: the last has no use for runs.
inline constexpr bool kHoldsNodes = Lanes<double>::kCount >= 4;

template <bool kInRuns>
HEXAPLAST_INLINE void gather_corner(const double* field, const int* slot, Lanes<double>* at) {
  using D = Lanes<double>::Tag;
  const D d;
  if constexpr (kInRuns && kHoldsNodes) {
    hn::Vec<D> n[4];
    for (int k = 0; k < 4; ++k) n[k] = hn::LoadU(d, field + 4 * static_cast<std::ptrdiff_t>(slot[k]));
    // pairs of 128 bits: x of two nodes, z of them, and so on
    const hn::Vec<D> low = hn::InterleaveLower(d, n[0], n[1]), high = hn::InterleaveLower(d, n[2], n[3]);
    at[0] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(high), low);
    at[1] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(hn::InterleaveUpper(d, n[2], n[3])),
                              hn::InterleaveUpper(d, n[0], n[1]));
    at[2] = hn::OddEvenBlocks(high, hn::SwapAdjacentBlocks(low));
  } else {
    const hn::Vec<D> a = join_pieces(d, field, slot, 2), b = join_pieces(d, field, slot + 1, 2);
    at[0] = hn::InterleaveLower(d, a, b);
    at[1] = hn::InterleaveUpper(d, a, b);
    at[2] = hn::InterleaveLower(d, join_pieces(d, field + 2, slot, 2), join_pieces(d, field + 2, slot + 1, 2));
  }
}
template <bool kInRuns>
HEXAPLAST_INLINE void scatter_corner(const Lanes<double>* at, double* field, const int* slot) {
  using D = Lanes<double>::Tag;
  const D d;
  const hn::Vec<D> none = hn::Zero(d), x = at[0], y = at[1], z = at[2];
  if constexpr (kInRuns && kHoldsNodes) {
    const hn::Vec<D> low = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(z), x), low_y = hn::OddEvenBlocks(none, y);
    const hn::Vec<D> high = hn::OddEvenBlocks(z, hn::SwapAdjacentBlocks(x)),
                     high_y = hn::OddEvenBlocks(none, hn::SwapAdjacentBlocks(y));
    const hn::Vec<D> nodes[4] = {hn::InterleaveLower(d, low, low_y), hn::InterleaveUpper(d, low, low_y),
                                 hn::InterleaveLower(d, high, high_y), hn::InterleaveUpper(d, high, high_y)};
    for (int k = 0; k < 4; ++k) {
      double* to = field + 4 * static_cast<std::ptrdiff_t>(slot[k]);
      hn::StoreU(hn::Add(hn::LoadU(d, to), nodes[k]), d, to);
    }
  } else {
    add_pieces(d, hn::InterleaveLower(d, x, y), field, slot, 2);
    add_pieces(d, hn::InterleaveUpper(d, x, y), field, slot + 1, 2);
    add_pieces(d, hn::InterleaveLower(d, z, none), field + 2, slot, 2);
    add_pieces(d, hn::InterleaveUpper(d, z, none), field + 2, slot + 1, 2);
  }
}

#endif

template <bool kInRuns, class T>
HEXAPLAST_INLINE void gather_corners(const T* field, const int* slots, CornerLanes<Lanes<T>>& corners) {
  unrolled<kCorners>([&](auto a) __attribute__((always_inline)) {
    gather_corner<kInRuns>(field, slots + a * kBlock, corners.at[a]);
  });
}
/// No two corners of an edge follow each other: along a run their nodes overlap, and a load that overlaps the store
/// before it waits.
inline constexpr int kScatterOrder[kCorners] = {0, 2, 5, 7, 1, 3, 4, 6};

template <bool kInRuns, class T>
HEXAPLAST_INLINE void scatter_corners(const CornerLanes<Lanes<T>>& corners, T* field, const int* slots) {
  unrolled<kCorners>([&](auto k) __attribute__((always_inline)) {
    constexpr int a = kScatterOrder[k];
    scatter_corner<kInRuns>(corners.at[a], field, slots + a * kBlock);
  });
}

/// Corner values of the elements of a block, from place `lane` on.
template <class T>
HEXAPLAST_INLINE void gather(const Partition& partition, int block, int lane, const T* field,
                             CornerLanes<Lanes<T>>& corners) {
  const int* slots = partition.corners(block) + lane;
  if (partition.is_run[block])
    gather_corners<true>(field, slots, corners);
  else
    gather_corners<false>(field, slots, corners);
}

/// The same in double precision about the first corner, rounded to T.
template <class T>
HEXAPLAST_INLINE void gather_about_corner(const Partition& partition, int block, int lane, const double* field,
                                          CornerLanes<Lanes<T>>& corners) {
  CornerLanes<Lanes<double>> parts[kParts<T>];
  for (int part = 0; part < kParts<T>; ++part) {
    gather(partition, block, lane + part * Lanes<double>::kCount, field, parts[part]);
    for (int a = kCorners - 1; a >= 0; --a)
      for (int i = 0; i < 3; ++i) parts[part].at[a][i] -= parts[part].at[0][i];
  }
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) {
      Lanes<double> numbers[kParts<T>];
      for (int part = 0; part < kParts<T>; ++part) numbers[part] = parts[part].at[a][i];
      corners.at[a][i] = narrow<T>(numbers);
    }
}

/// field += corner values of these elements.
template <class T>
HEXAPLAST_INLINE void scatter_add(const CornerLanes<Lanes<T>>& corners, const Partition& partition, int block, int lane,
                                  T* field) {
  const int* slots = partition.corners(block) + lane;
  if (partition.is_run[block])
    scatter_corners<true>(corners, field, slots);
  else
    scatter_corners<false>(corners, field, slots);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
