// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// What callers owe, checked in every build. `call` is the function that was called, `name` its argument.

/// Throws InputError unless there are as many rows, entries or nodes as expected.
void require_count(const char* call, const char* name, Eigen::Index given, Eigen::Index expected);

/// Throws InputError unless `field` has `expected` rows.
inline void require_rows(const char* call, const char* name, ConstPoints field, Eigen::Index expected) {
  require_count(call, name, field.rows(), expected);
}

/// Throws InputError unless 0 < dt < inf [s].
void require_time_step(double dt);

/// Throws InputError unless every one of `nodes` is a row of something that has `num_rows`.
void require_nodes(const char* call, std::span<const int> nodes, Eigen::Index num_rows);

/// Throws NumericalError naming the first node whose row is not finite; `what` is the field's name, e.g. "velocity".
void require_finite(ConstPoints field, const char* what);

}  // namespace hexaplast
