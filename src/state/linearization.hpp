// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <variant>
#include <vector>

#include "state/element_operator.hpp"
#include "state/history.hpp"
#include "state/recovery.hpp"

namespace hexaplast {

/// What the plastic step asks of every sample before it looks closer, in single precision: per block
/// [quantity][element of the block].
struct YieldScreen {
  static constexpr int kNorm = 0;                   ///< [Pa] at least the stress norm, per sample
  static constexpr int kMinDet = kCorners;          ///< smallest det F~
  static constexpr int kMinJacobian = kMinDet + 1;  ///< [m^3] smallest det J of the plastic rest shape's corners
  static constexpr int kQuantities = kMinJacobian + 1;
};

/// Numbers of a Gm: its lower triangle.                                                                        eq. P2
inline constexpr int kMeanPlastic = 6;
constexpr int of_mean_plastic(int row, int column) { return row * (row + 1) / 2 + column; }

/// Everything computed at one set of current positions, and at one plastic rest shape. May be thrown away at any time.
struct Linearization {
  explicit Linearization(const Model& model);

  // of the plastic rest shape
  long plastic_rest_version = -1;         ///< History::version that all below belongs to
  AlignedVector<double> plastic_rest;     ///< [m] slots
  std::vector<std::uint16_t> present;     ///< per block: a bit per element that is there and alive
  std::vector<unsigned char> is_general;  ///< per block: some element is no parallelepiped
  AlignedVector<double> volume;           ///< [m^3] of the plastic rest shape, [block][element]; 0 where nothing is
  std::vector<unsigned char> has_flowed;  ///< per block: some G of isolated rest shapes is not 1; empty of joined ones
  std::vector<double> least_yield;        ///< [Pa] per block: of the thresholds of what can flow; infinite: nothing can
  AlignedVector<float> mean_plastic;      ///< there: Gm, [block][kMeanPlastic][element]; empty of joined ones

  /// G per element of the history; null where nothing in a block has flowed by isolated rest shapes.
  const CornerTensors* flowed_at(const History& history, int block) const {
    return has_flowed.empty() || !has_flowed[block] ? nullptr : history.plastic_inverse.data();
  }
  const StiffnessKind& kind() const {
    return std::visit([](const auto& of) -> const StiffnessKind& { return of.kind; }, op);
  }
  const float* mean_plastic_of(int block) const {
    return has_flowed.empty() || !has_flowed[block]
               ? nullptr
               : mean_plastic.data() + static_cast<std::size_t>(block) * kMeanPlastic * kBlock;
  }

  /// What belongs to the current positions is to be computed anew, in all chunks.
  void forget() {
    is_current = false;
    std::ranges::fill(is_stale, 1);
  }

  // of the current positions
  bool is_current = false;              ///< what follows belongs to x and the plastic rest shape
  std::vector<unsigned char> is_stale;  ///< per chunk: where it does not
  bool is_screened = false;             ///< `screen` is filled
  long revision = 0;                    ///< grows with every linearization that is computed
  PointArray x;                         ///< [m] current positions
  AlignedVector<double> current;        ///< [m] slots
  AlignedVector<double> of_chunks;      ///< [N] slots: forces of the elements of each chunk
  AlignedVector<double> force;          ///< [N] slots: their sums at the nodes
  AlignedVector<float> screen;          ///< YieldScreen, per block
  std::vector<std::uint16_t> thin;      ///< per block: a bit per element some corner of which is below recovery_from
  Recovery recovery;                    ///< its forces stand beside those of the elements
  std::variant<ElementOperator<double, double>, ElementOperator<float, Half>, ElementOperator<float, float>> op;
};

}  // namespace hexaplast
