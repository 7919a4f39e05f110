// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// A material of which a hexahedron holds a fraction (0, 1], the rest of it being empty: at the same strain it carries
/// that fraction of the stress, and it yields and tears at the same strains.
Material filled(Material material, double fraction);

}  // namespace hexaplast
