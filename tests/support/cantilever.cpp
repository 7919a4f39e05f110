// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/cantilever.hpp"

#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast::support {

double relative_deflection(int thickness, double poisson_ratio, GradientScheme gradient) {
  constexpr double kLength = 1, kWidth = 0.1, kForce = 1e-6;
  Material m;
  m.poisson_ratio = poisson_ratio;
  const double E = m.young_modulus, G = E / (2 * (1 + poisson_ratio));
  const HexMesh mesh = block({10 * thickness, thickness, thickness}, kWidth / thickness);
  const std::vector<int> tip = nodes_at(mesh, 0, kLength);

  // one step of 10^6 s from rest: inertia has no part in it, what is left is the linear static answer
  SimulationSetup setup;
  setup.density = 1e-3;
  setup.dt = 1e6;
  setup.fixed = nodes_at(mesh, 0, 0);
  setup.load = [&](double, ConstPoints, Points f) {
    // the end face's load per node: a quarter cell's share for every cell that the node belongs to
    for (const int n : tip) f(n, 2) += kForce * mesh.incident(n).size() / (4.0 * thickness * thickness);
  };
  Settings settings;
  settings.gradient = gradient;
  Simulation beam(Body(mesh, {m}, settings), std::move(setup));
  beam.step();

  double deflection = 0;
  for (const int n : tip) deflection += (beam.x(n, 2) - mesh.positions()(n, 2)) / tip.size();
  const double area = kWidth * kWidth, inertia = area * area / 12;
  return deflection /
         (kForce * kLength * kLength * kLength / (3 * E * inertia) + kForce * kLength / (5.0 / 6 * G * area));
}

}  // namespace hexaplast::support
