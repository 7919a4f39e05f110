// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/large_strain.hpp"

#include <stdexcept>

#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/newton_raphson.hpp"
#include "loaded_body.hpp"
#include "support/calculix_bar.hpp"
#include "support/dense.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {
namespace {

Material rubber(double poisson_ratio) { return {.poisson_ratio = poisson_ratio}; }

/// [-] Force along `axis` that holds the nodes at the far end of a cube of 1 m, over Young's modulus.
double pull(Body& cube, const PointArray& x, int end, int axis) {
  const PointArray f = force_at(cube, x);
  double sum = 0;
  for (const int n : nodes_at(cube.mesh(), end, 1)) sum -= f(n, axis);
  return sum / cube.materials()[0].young_modulus;
}

}  // namespace

Strained uniaxial(double poisson_ratio, double stretch, const Settings& settings) {
  Body cube(block({1, 1, 1}, 1), {rubber(poisson_ratio)}, settings);
  const auto strained = [&](double across) {
    return mapped(cube.mesh().positions(), Mat3(Vec3(stretch, across, across).asDiagonal()));
  };
  double low = 0.3, high = 2;  // the sides are free
  while (high - low > 1e-14) {
    const double across = (low + high) / 2;
    (pull(cube, strained(across), 1, 1) > 0 ? high : low) = across;
  }
  return {.force = pull(cube, strained(low), 0, 0), .volume_ratio = stretch * low * low};
}

double shear_stress(double poisson_ratio, double shear, const Settings& settings) {
  Body cube(block({1, 1, 1}, 1), {rubber(poisson_ratio)}, settings);
  PointArray x = cube.mesh().positions();
  x.col(0) += shear * x.col(2);
  return pull(cube, x, 2, 0) * 2 * (1 + poisson_ratio);
}

Strained held_block(double poisson_ratio, double stretch, const Settings& settings) {
  constexpr int kSteps = 8;
  Body body(block({4, 4, 4}, 0.25), {rubber(poisson_ratio)}, settings);
  const HexMesh& mesh = body.mesh();
  std::vector<int> ends = nodes_at(mesh, 0, 0);
  for (const int n : nodes_at(mesh, 0, 1)) ends.push_back(n);
  LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 0.0), ends, {});
  NewtonRaphson newton({.iterations = 200,
                        .relative_successive = 0,
                        .relative_initial = 0,
                        .absolute_residual = 1e-8 * body.materials()[0].young_modulus,
                        .line_search_iterations = 3});
  CholeskySolver solver;
  PointArray x = mesh.positions();
  double reached = 1;
  for (int step = 1; step <= kSteps; ++step) {
    const double next = 1 + step * (stretch - 1) / kSteps;
    x.col(0) *= next / reached;
    reached = next;
    if (newton.solve(system, solver, 0, x).status == NewtonStatus::kNotConverged)
      throw std::runtime_error("no equilibrium");
  }
  return {.force = pull(body, x, 0, 0), .volume_ratio = body.volume(x) / body.initial_volume()};
}

double large_deflection(double poisson_ratio, int across, double force, const Settings& settings) {
  Body body(block({10 * across, across, across}, 0.1 / across), {rubber(poisson_ratio)}, settings);
  const HexMesh& mesh = body.mesh();
  const std::vector<int> tip = nodes_at(mesh, 0, 1);
  const std::vector<double> weight = face_weights(mesh, tip);
  PointArray loads = PointArray::Zero(mesh.num_nodes(), 3);
  for (const int n : tip) loads(n, 2) = force * weight[n];
  const PointArray x = elastic_equilibrium(body, nodes_at(mesh, 0, 0), loads, 20);
  double sum = 0;
  for (const int n : tip) sum += weight[n] * (x(n, 2) - mesh.positions()(n, 2));
  return sum;
}

}  // namespace hexaplast::support
