// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mesh/trilinear.hpp"

namespace hexaplast {

double scaled_jacobian(const ElementPoints& x) {
  double min = std::numeric_limits<double>::infinity();
  for (int a = 0; a < kCorners; ++a) {
    const Mat3 J = corner_jacobian(x, a);
    min = std::min(min, J.determinant() / J.colwise().norm().prod());
  }
  return min;
}

MeshQuality quality(const HexMesh& mesh) {
  MeshQuality found;
  for (int n = 0; n < mesh.num_nodes(); ++n) found.num_unused_nodes += mesh.incident(n).empty();
  if (mesh.num_elements() == 0) return found;

  found.min_scaled_jacobian = found.shortest_edge = std::numeric_limits<double>::infinity();
  for (int e = 0; e < mesh.num_elements(); ++e) {
    const ElementPoints x = gather(mesh.positions(), mesh.hexahedra()[e]);
    found.volume += volume(x);
    for (int a = 0; a < kCorners; ++a) {
      const Eigen::RowVector3d edges = 2 * corner_jacobian(x, a).colwise().norm();  // its columns are half edges
      found.shortest_edge = std::min(found.shortest_edge, edges.minCoeff());
      found.longest_edge = std::max(found.longest_edge, edges.maxCoeff());
    }
    const double shape = scaled_jacobian(x);
    found.num_inverted += shape <= 0;
    if (shape < found.min_scaled_jacobian) {
      found.min_scaled_jacobian = shape;
      found.worst_element = e;
    }
  }
  return found;
}

std::vector<std::string> check_shapes(const MeshQuality& quality) {
  std::vector<std::string> sentences;
  if (quality.num_inverted > 0) {
    sentences.push_back(
        fmt::format("{} of the hexahedra {} inverted at a corner; the worst is hexahedron {}: its scaled Jacobian is "
                    "{:.3g}, and results are wrong unless it is positive",
                    quality.num_inverted, quality.num_inverted == 1 ? "is" : "are", quality.worst_element,
                    quality.min_scaled_jacobian));
  } else if (quality.min_scaled_jacobian < kPoorShape) {
    sentences.push_back(
        fmt::format("hexahedron {} is badly shaped: its scaled Jacobian is {:.3g}, results are poor below {}",
                    quality.worst_element, quality.min_scaled_jacobian, kPoorShape));
  }
  return sentences;
}

}  // namespace hexaplast
