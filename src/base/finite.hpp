// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Throws NumericalError naming the first node whose row is not finite; `what` is the field's name, e.g. "velocity".
void require_finite(ConstPoints field, const char* what);

}  // namespace hexaplast
