// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/material/filling.hpp"

namespace hexaplast {

Material filled(Material material, double share) {
  material.young_modulus *= share;
  material.yield_stress *= share;
  material.fracture_stress *= share;
  return material;
}

}  // namespace hexaplast
