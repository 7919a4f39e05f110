// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

/// The residual r = b - A x of a system of several bodies, each of which counts by itself:      theory.md section 9.5
///
///   size = |b| max_i |r_i| / max(|b_i|, |(F x)_i|)
///
/// i: the parts of a MatrixFreeSystem, as one where constraints couple them. F: its terms beside the bodies, as contact
/// is, by which a body that is moved loads one on which nothing else acts. |r_i| that is rounding beside |b| counts as
/// 0.
class BodyResiduals {
 public:
  /// For a system, which outlives the calls of `size`, and its right-hand side.
  void setup(const MatrixFreeSystem& system, ConstPoints b);

  /// That of r and x times `unit`; 0 where there are not several bodies. x may be a correction to that of `size_at`.
  double size(ConstPoints r, ConstPoints x, double unit);

  /// The same, of an x to which corrections follow.
  double size_at(ConstPoints r, ConstPoints x);

 private:
  struct Part {
    NodeGroup nodes;
    std::size_t body = 0;  // the first of the parts that are one with it
  };
  struct Norms {
    double load = 0, corrected = 0;  // |b_i|, and |(F x)_i| of `size_at`
    double transmitted = 0, residual = 0;
  };

  const MatrixFreeSystem* system_ = nullptr;
  double norm_b_ = 0, nothing_ = 0;
  std::vector<Part> parts_;   // empty: not several bodies
  std::vector<Norms> norms_;  // per part, those of a body at its first one
  PointArray product_;
};

}  // namespace hexaplast
