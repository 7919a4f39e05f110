// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <variant>

#include "state/element_operator.hpp"
#include "state/history.hpp"
#include "state/recovery.hpp"

namespace hexaplast {

/// What the plastic step asks of every sample before it looks closer, in single precision: per block
/// [quantity][element of the block].
struct YieldScreen {
  static constexpr int kNorm = 0;                   ///< [Pa] at least the stress norm, per sample
  static constexpr int kCosine = kCorners;          ///< of the angle between the rotations of sample and centre
  static constexpr int kMinDet = 2 * kCorners;      ///< smallest det F~
  static constexpr int kMinJacobian = kMinDet + 1;  ///< [m^3] smallest det J of the plastic rest shape's corners
  static constexpr int kQuantities = kMinJacobian + 1;
};

/// Everything computed at one set of current positions, and at one plastic rest shape. May be thrown away at any time.
struct Linearization {
  explicit Linearization(const Model& model);

  // of the plastic rest shape
  long plastic_rest_version = -1;         ///< History::version that all below belongs to
  AlignedVector<double> plastic_rest;     ///< [m] slots
  std::vector<std::uint16_t> present;     ///< per block: a bit per element that is there and alive
  std::vector<unsigned char> is_general;  ///< per block: some element is no parallelepiped
  AlignedVector<double> volume;           ///< [m^3] of the plastic rest shape, [block][element]; 0 where nothing is

  // of the current positions
  bool is_current = false;              ///< what follows belongs to x and the plastic rest shape
  long revision = 0;                    ///< no two that differ in what follows have the same
  PointArray x;                         ///< [m] current positions
  AlignedVector<double> current;        ///< [m] slots
  AlignedVector<double> force;          ///< [N] slots
  AlignedVector<float> screen;          ///< YieldScreen, per block
  std::vector<unsigned char> may_fold;  ///< per block: some corner may have lost most of its volume
  Recovery recovery;                    ///< its forces stand beside those of the elements
  std::variant<ElementOperator<double, double>, ElementOperator<float, Half>, ElementOperator<float, float>> op;
};

}  // namespace hexaplast
