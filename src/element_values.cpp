// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>

#include "base/require.hpp"
#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast {

std::vector<double> plastic_strains(const Body& body) {
  std::vector<double> means;
  means.reserve(body.plastic_strain().size());
  for (const CornerValues& corners : body.plastic_strain()) {
    double mean = 0;
    for (const double strain : corners) mean += strain / kCorners;
    means.push_back(mean);
  }
  return means;
}

std::vector<double> present_yield_stresses(const Body& body) {
  std::vector<double> largest;
  largest.reserve(body.yield_stress().size());
  for (const CornerValues& corners : body.yield_stress())
    largest.push_back(*std::max_element(corners.begin(), corners.end()));
  return largest;
}

std::vector<double> element_volumes(const Body& body, ConstPoints x) {
  require_rows("element_volumes", "x", x, body.mesh().num_nodes());
  const std::vector<Hexahedron>& hexahedra = body.mesh().hexahedra();
  std::vector<double> volumes(hexahedra.size(), 0);
  for (std::size_t e = 0; e < volumes.size(); ++e)
    if (body.alive()[e]) volumes[e] = volume(gather(x, hexahedra[e]));
  return volumes;
}

std::vector<double> plastic_volume_ratios(const Body& body) {
  // of isolated rest shapes the mesh, whose volumes flow keeps
  std::vector<double> ratios = element_volumes(body, body.state().history.plastic_rest_positions);
  for (std::size_t e = 0; e < ratios.size(); ++e) ratios[e] /= body.initial_volume(static_cast<int>(e));
  return ratios;
}

}  // namespace hexaplast
