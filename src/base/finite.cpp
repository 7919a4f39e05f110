// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/finite.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

void require_finite(ConstPoints field, const char* what) {
  if (field.allFinite()) return;
  for (int n = 0; n < field.rows(); ++n)
    if (!field.row(n).allFinite())
      throw NumericalError(
          fmt::format("the {} of node {} is not finite: ({}, {}, {})", what, n, field(n, 0), field(n, 1), field(n, 2)));
}

}  // namespace hexaplast
