// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/require.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

void require_count(const char* call, const char* name, Eigen::Index given, Eigen::Index expected) {
  if (given != expected) throw InputError(fmt::format("{}: {} has {} rows, must have {}", call, name, given, expected));
}

void require_time_step(double dt) {
  if (!(dt > 0) || !std::isfinite(dt)) throw InputError(fmt::format("dt = {} s: must be in (0, inf)", dt));
}

void require_nodes(const char* call, std::span<const int> nodes, Eigen::Index num_rows) {
  for (const int n : nodes)
    if (n < 0 || n >= num_rows) throw InputError(fmt::format("{}: node {} must lie in [0, {})", call, n, num_rows));
}

void require_finite(ConstPoints field, const char* what) {
  if (field.allFinite()) return;
  for (int n = 0; n < field.rows(); ++n)
    if (!field.row(n).allFinite())
      throw NumericalError(
          fmt::format("the {} of node {} is not finite: ({}, {}, {})", what, n, field(n, 0), field(n, 1), field(n, 2)));
}

}  // namespace hexaplast
