// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/lumped_mass.hpp"

#include <array>
#include <cmath>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

double six_tetrahedra_volume(const ElementPoints& corners) {
  // the other six corners, in the order in which they surround the diagonal 0-6
  constexpr std::array<int, 7> kAround{1, 2, 3, 7, 4, 5, 1};
  const auto from_first = [&](int corner) -> Vec3 { return (corners.row(corner) - corners.row(0)).transpose(); };

  double volume = 0;
  for (std::size_t i = 0; i + 1 < kAround.size(); ++i)
    volume += std::abs(from_first(6).dot(from_first(kAround[i]).cross(from_first(kAround[i + 1])))) / 6;
  return volume;
}

std::vector<double> element_volumes(ConstPoints x, std::span<const Hexahedron> hexahedra) {
  std::vector<double> volumes;
  volumes.reserve(hexahedra.size());
  for (const Hexahedron& corners : hexahedra) volumes.push_back(six_tetrahedra_volume(gather(x, corners)));
  return volumes;
}

Eigen::VectorXd nodal_volumes(ConstPoints x, std::span<const Hexahedron> hexahedra) {
  return lumped_masses(static_cast<int>(x.rows()), hexahedra, element_volumes(x, hexahedra));
}

Eigen::VectorXd lumped_masses(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses) {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(num_nodes);
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (const int node : hexahedra[e]) share[node] += masses[e] / kCorners;
  return share;
}

void add_gravity(const Eigen::VectorXd& masses, const Vec3& gravity, Points f) {
  for (int n = 0; n < f.rows(); ++n) f.row(n) += masses[n] * gravity.transpose();
}

double kinetic_energy(const Eigen::VectorXd& masses, ConstPoints v) {
  return masses.dot(v.rowwise().squaredNorm()) / 2;
}

}  // namespace hexaplast
