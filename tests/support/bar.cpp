// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/bar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "solve/loads.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {
namespace {

constexpr double kCell = 0.1;  // [m]
constexpr int kSlices = 10;

int node_at(int i, int j, int k) { return i + 4 * (j + 4 * k); }

constexpr double kBarStep = 0.01;  // [s]

/// Fraction of the full load in the step that begins at `time`: its fraction at the end of the step, so that the first
/// step is loaded and the one that ends at two seconds is the last.
double load_fraction(double time) { return time + kBarStep / 2 < 2 ? std::min(1.0, (time + kBarStep) / 0.5) : 0.0; }

void add_stretch(double fraction, Points f) {
  const double force = 90.0 / 4 * fraction;  // [N] per node of the central face
  for (const int i : {1, 2}) {
    for (const int j : {1, 2}) {
      f(node_at(i, j, 0), 2) -= force;
      f(node_at(i, j, kSlices), 2) += force;
    }
  }
}

void add_twist(double fraction, ConstPoints x, Points f) {
  const double force = 20 * fraction;  // [N] per edge
  const Vec3 axis(0, 0, 1), centre(1.5 * kCell, 1.5 * kCell, 0);
  for (const int k : {0, kSlices}) {
    const int a = node_at(1, 1, k), b = node_at(2, 1, k), c = node_at(2, 2, k), d = node_at(1, 2, k);
    const std::array edges{a, b, b, c, c, d, d, a};
    add_tangential_forces(edges, 2, axis, centre, k == 0 ? -force : force, x, f);
  }
}

}  // namespace

Material bar_material(BarLoad load, const std::string& strength) {
  const int level = strength == "high" ? 0 : strength == "medium" ? 1 : strength == "low" ? 2 : 3;
  if (level == 3) throw std::invalid_argument("no bar of strength " + strength);

  Material m{.yield_stress = std::array{300.0, 500.0, 800.0}[level], .hardening = 0.2};
  if (load == BarLoad::kStretch) {
    m.flow_rate = std::array{4.0, 2.0, 0.5}[level];
  } else {
    m.flow_rate = std::array{2.0, 1.0, 0.5}[level];
    m.rotation_flow_rate = std::array{1.0, 0.5, 0.25}[level];
    m.rotation_yield = std::array{0.03, 0.1, 0.2}[level];
  }
  return m;
}

MovingBody bar(BarLoad load, const std::string& strength, double fracture_stress) {
  Material material = bar_material(load, strength);
  material.fracture_stress = fracture_stress;
  Settings settings = published_element();
  settings.yield_norm = YieldNorm::kFrobenius;
  HexMesh mesh = block({3, 3, kSlices}, kCell);

  Motion setup;
  setup.dt = kBarStep;
  setup.euler = {.rayleigh_mass = 0.1, .rayleigh_stiffness = 0.1};
  setup.fixed = nodes_at(mesh, 2, kSlices / 2 * kCell);
  setup.load = [load](double time, ConstPoints x, Points f) {
    if (load == BarLoad::kStretch)
      add_stretch(load_fraction(time), f);
    else
      add_twist(load_fraction(time), x, f);
  };
  return MovingBody(Body(std::move(mesh), {material}, settings), std::move(setup));
}

}  // namespace hexaplast::support
