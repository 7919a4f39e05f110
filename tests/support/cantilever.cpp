// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/cantilever.hpp"

#include <array>
#include <stdexcept>

#include "hexaplast/geometry/grid.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast::support {

double relative_deflection(const HexMesh& mesh, std::span<const double> weights, double poisson_ratio,
                           const Settings& settings) {
  constexpr double kLength = 1, kWidth = 0.1, kForce = 1e-6;
  Material m;
  m.poisson_ratio = poisson_ratio;
  const double E = m.young_modulus, G = E / (2 * (1 + poisson_ratio));
  const std::vector<int> tip = nodes_at(mesh, 0, kLength);

  // one step of 10^6 s from rest: inertia has no part in it, what is left is the linear static answer
  Motion setup;
  setup.density = 1e-3;
  setup.dt = 1e6;
  setup.fixed = nodes_at(mesh, 0, 0);
  setup.load = [&](double, ConstPoints, Points f) {
    for (std::size_t k = 0; k < tip.size(); ++k) f(tip[k], 2) += kForce * weights[k];
  };
  MovingBody beam(Body(mesh, {m}, settings), std::move(setup));
  beam.step();

  double deflection = 0;
  for (std::size_t k = 0; k < tip.size(); ++k)
    deflection += weights[k] * (beam.positions(tip[k], 2) - mesh.positions()(tip[k], 2));
  const double area = kWidth * kWidth, inertia = area * area / 12;
  return deflection /
         (kForce * kLength * kLength * kLength / (3 * E * inertia) + kForce * kLength / (5.0 / 6 * G * area));
}

BeamMesh beam_mesh(const std::string& name) {
  if (name == "cubes")
    return {regular_grid({20, 2, 2}, Vec3::Zero(), Vec3(1, 0.1, 0.1)),
            {1. / 16, 1. / 8, 1. / 16, 1. / 8, 1. / 4, 1. / 8, 1. / 16, 1. / 8, 1. / 16},
            calculix("locking")};
  const Json all = calculix("locking_meshes");
  for (const Json& each : all["meshes"]) {
    if (each["name"] != name) continue;
    const std::array<int, 3> cells = each["cells"];
    const HexMesh grid = regular_grid(cells, Vec3::Zero(), Vec3(1, 0.1, 0.1));
    return {HexMesh(matrix(each["positions"]), grid.hexahedra()), each["tip_load"], each};
  }
  throw std::runtime_error("no mesh is called " + name);
}

}  // namespace hexaplast::support
