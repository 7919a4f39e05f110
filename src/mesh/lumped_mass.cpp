// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/lumped_mass.hpp"

#include <array>
#include <cmath>

#include "base/require.hpp"
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
  for (const Hexahedron& corners : hexahedra) {
    require_nodes("element_volumes", corners, x.rows());
    volumes.push_back(six_tetrahedra_volume(gather(x, corners)));
  }
  return volumes;
}

Eigen::VectorXd nodal_volumes(ConstPoints x, std::span<const Hexahedron> hexahedra) {
  return nodal_masses(static_cast<int>(x.rows()), hexahedra, element_volumes(x, hexahedra));
}

Eigen::VectorXd nodal_masses(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses) {
  require_count("nodal_masses", "masses", std::ssize(masses), std::ssize(hexahedra));
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(num_nodes);
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    require_nodes("nodal_masses", hexahedra[e], num_nodes);
    for (const int node : hexahedra[e]) mass[node] += masses[e] / kCorners;
  }
  return mass;
}

void add_gravity(const Eigen::VectorXd& masses, const Vec3& gravity, Points f) {
  require_rows("add_gravity", "f", f, masses.size());
  for (int n = 0; n < f.rows(); ++n) f.row(n) += masses[n] * gravity.transpose();
}

double kinetic_energy(const Eigen::VectorXd& masses, ConstPoints v) {
  require_rows("kinetic_energy", "v", v, masses.size());
  return masses.dot(v.rowwise().squaredNorm()) / 2;
}

}  // namespace hexaplast
