// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/axial_pull.hpp"

#include <cmath>

#include "base/require.hpp"

namespace hexaplast {

double axial_pull(const HexMesh& mesh, const EndSections& ends, ConstPoints forces) {
  require_rows("axial_pull", "forces", forces, mesh.num_nodes());
  constexpr double kInTheMiddle = 1e-6;  // of the length: such nodes belong to neither half
  const auto X = mesh.positions().col(ends.axis);
  const double middle = (X.minCoeff() + X.maxCoeff()) / 2;
  double beyond = 0, before = 0;
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (X(n) > middle + kInTheMiddle * ends.length) beyond += forces(n, ends.axis);
    if (X(n) < middle - kInTheMiddle * ends.length) before -= forces(n, ends.axis);
  }
  return std::abs(before) > std::abs(beyond) ? before : beyond;
}

}  // namespace hexaplast
