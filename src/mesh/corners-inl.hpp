// SPDX-License-Identifier: LGPL-2.1-or-later
// Nodal values to the corners of one element per lane and back, without hardware gather or scatter: four numbers per
// node are loaded at once and transposed in registers.
#if defined(HEXAPLAST_MESH_CORNERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_MESH_CORNERS_INL
#undef HEXAPLAST_MESH_CORNERS_INL
#else
#define HEXAPLAST_MESH_CORNERS_INL
#endif

#include "base/lanes-inl.hpp"
#include "hexaplast/base/hexahedron.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Corner values of one element per lane.
template <class V>
struct CornerLanes {
  V at[kCorners][3];
};

#if HWY_TARGET == HWY_SCALAR

template <class T>
HWY_INLINE void gather_corner(const T* field, const int* slot, Lanes<T>* at) {
  for (int i = 0; i < 3; ++i) at[i] = Lanes<T>(field[4 * static_cast<std::ptrdiff_t>(*slot) + i]);
}
template <class T>
HWY_INLINE void scatter_corner(const Lanes<T>* at, T* field, const int* slot) {
  for (int i = 0; i < 3; ++i) field[4 * static_cast<std::ptrdiff_t>(*slot) + i] += hn::GetLane(at[i].raw());
}

#else

/// The 128-bit pieces at base + offset[0], base + offset[stride], ... side by side in one register.
template <class D, class T>
HWY_INLINE hn::Vec<D> join_pieces(D d, const T* base, const int* slot, int stride) {
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
HWY_INLINE void add_pieces(D d, hn::Vec<D> pieces, T* base, const int* slot, int stride) {
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

/// One register of four floats per node becomes three of one coordinate each.
HWY_INLINE void gather_corner(const float* field, const int* slot, Lanes<float>* at) {
  using D = Lanes<float>::Tag;
  const D d;
  const hn::Vec<D> a = join_pieces(d, field, slot, 4), b = join_pieces(d, field, slot + 1, 4),
                   c = join_pieces(d, field, slot + 2, 4), e = join_pieces(d, field, slot + 3, 4);
  const hn::Vec<D> ac = hn::InterleaveLower(d, a, c), be = hn::InterleaveLower(d, b, e);
  at[0] = hn::InterleaveLower(d, ac, be);
  at[1] = hn::InterleaveUpper(d, ac, be);
  at[2] = hn::InterleaveLower(d, hn::InterleaveUpper(d, a, c), hn::InterleaveUpper(d, b, e));
}
HWY_INLINE void gather_corner(const double* field, const int* slot, Lanes<double>* at) {
  using D = Lanes<double>::Tag;
  const D d;
  const hn::Vec<D> a = join_pieces(d, field, slot, 2), b = join_pieces(d, field, slot + 1, 2);
  at[0] = hn::InterleaveLower(d, a, b);
  at[1] = hn::InterleaveUpper(d, a, b);
  at[2] = hn::InterleaveLower(d, join_pieces(d, field + 2, slot, 2), join_pieces(d, field + 2, slot + 1, 2));
}

HWY_INLINE void scatter_corner(const Lanes<float>* at, float* field, const int* slot) {
  using D = Lanes<float>::Tag;
  const D d;
  const hn::Vec<D> none = hn::Zero(d), x = at[0], y = at[1], z = at[2];
  const hn::Vec<D> xz = hn::InterleaveLower(d, x, z), y_ = hn::InterleaveLower(d, y, none);
  const hn::Vec<D> XZ = hn::InterleaveUpper(d, x, z), Y_ = hn::InterleaveUpper(d, y, none);
  add_pieces(d, hn::InterleaveLower(d, xz, y_), field, slot, 4);
  add_pieces(d, hn::InterleaveUpper(d, xz, y_), field, slot + 1, 4);
  add_pieces(d, hn::InterleaveLower(d, XZ, Y_), field, slot + 2, 4);
  add_pieces(d, hn::InterleaveUpper(d, XZ, Y_), field, slot + 3, 4);
}
HWY_INLINE void scatter_corner(const Lanes<double>* at, double* field, const int* slot) {
  using D = Lanes<double>::Tag;
  const D d;
  const hn::Vec<D> none = hn::Zero(d), x = at[0], y = at[1], z = at[2];
  add_pieces(d, hn::InterleaveLower(d, x, y), field, slot, 2);
  add_pieces(d, hn::InterleaveUpper(d, x, y), field, slot + 1, 2);
  add_pieces(d, hn::InterleaveLower(d, z, none), field + 2, slot, 2);
  add_pieces(d, hn::InterleaveUpper(d, z, none), field + 2, slot + 1, 2);
}

#endif

/// slots: [corner][element of the block], from the first of the lanes on.
template <class T>
HWY_INLINE void gather(const T* field, const int* slots, CornerLanes<Lanes<T>>& corners) {
  unrolled<kCorners>([&](auto a)
                         __attribute__((always_inline)) { gather_corner(field, slots + a * kBlock, corners.at[a]); });
}
template <class T>
HWY_INLINE void scatter_add(const CornerLanes<Lanes<T>>& corners, T* field, const int* slots) {
  unrolled<kCorners>([&](auto a)
                         __attribute__((always_inline)) { scatter_corner(corners.at[a], field, slots + a * kBlock); });
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
