// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/filling.hpp"

namespace hexaplast {

Material filled(Material material, double fraction) {
  material.young_modulus *= fraction;
  material.yield_stress *= fraction;
  material.fracture_stress *= fraction;
  return material;
}

}  // namespace hexaplast
