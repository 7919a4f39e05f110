// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/calculix_bar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "hexaplast/solve/cholesky.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {
namespace {

constexpr double kCell = 0.01, kSide = 3 * kCell;  // [m]
constexpr int kSlices = 10, kAxis = 2;

/// The bar of a case, with the origin on its axis at the lower end.
HexMesh bar_mesh(int refine) {
  const Vec3 min(-kSide / 2, -kSide / 2, 0), max(kSide / 2, kSide / 2, kSlices * kCell);
  return regular_grid({3 * refine, 3 * refine, kSlices * refine}, min, max);
}

std::vector<int> central(const HexMesh& mesh, std::vector<int> end) {
  std::erase_if(
      end, [&](int n) { return mesh.positions().row(n).head<2>().cwiseAbs().maxCoeff() > kCell / 2 * (1 + 1e-9); });
  return end;
}

/// Full load [N] on every node.
PointArray end_loads(const BarCase& bar, const HexMesh& mesh) {
  PointArray loads = PointArray::Zero(mesh.num_nodes(), 3);
  for (const double sense : {-1.0, 1.0}) {
    const std::vector<int> end = nodes_at(mesh, kAxis, sense < 0 ? 0 : kSlices * kCell);
    const std::vector<double> weight =
        face_weights(mesh, bar.load == EndLoad::kCentralStretch ? central(mesh, end) : end);
    if (bar.load != EndLoad::kFaceTwist) {
      for (const int n : end) loads(n, kAxis) = sense * bar.force * weight[n];
      continue;
    }
    double moment = 0;  // [m^2] of the forces share (-y, x)
    for (const int n : end) moment += weight[n] * mesh.positions().row(n).head<2>().squaredNorm();
    const double scale = 2 * bar.force * kCell / moment;
    for (const int n : end) {
      loads(n, 0) = -sense * scale * weight[n] * mesh.positions()(n, 1);
      loads(n, 1) = sense * scale * weight[n] * mesh.positions()(n, 0);
    }
  }
  return loads;
}

double mean_height(const std::vector<int>& nodes, ConstPoints x) {
  double sum = 0;
  for (const int n : nodes) sum += x(n, kAxis);
  return sum / static_cast<double>(nodes.size());
}

/// [deg] Mean turn about the axis of the corners of a layer and of its central ninth, as the reference tells it.
double twist(const HexMesh& mesh, const std::vector<int>& layer, ConstPoints x) {
  double sum = 0;
  int count = 0;
  for (const int n : layer) {
    const Vec3 X = mesh.positions().row(n);
    const bool is_on_diagonal = std::abs(std::abs(X.x()) - std::abs(X.y())) < 1e-9;
    const bool is_central = std::abs(std::abs(X.x()) - kCell / 2) < 1e-9;
    const bool is_corner = std::abs(std::abs(X.x()) - kSide / 2) < 1e-9;
    if (!is_on_diagonal || !(is_central || is_corner)) continue;
    sum += std::remainder(std::atan2(x(n, 1), x(n, 0)) - std::atan2(X.y(), X.x()), 2 * std::numbers::pi);
    ++count;
  }
  return sum / count * 180 / std::numbers::pi;
}

BarState measure(const Body& body, ConstPoints x) {
  const HexMesh& mesh = body.mesh();
  std::vector<std::vector<int>> layers;
  for (int k = 0; k <= kSlices; ++k) layers.push_back(nodes_at(mesh, kAxis, k * kCell));

  BarState state;
  const double length = kSlices * kCell;
  state.mean_elongation = (mean_height(layers.back(), x) - mean_height(layers.front(), x)) / length - 1;
  state.central_elongation =
      (mean_height(central(mesh, layers.back()), x) - mean_height(central(mesh, layers.front()), x)) / length - 1;
  state.volume_ratio = body.volume(x) / body.initial_volume();
  for (const std::vector<int>& layer : layers) state.twist_deg.push_back(twist(mesh, layer, x));
  return state;
}

/// Far below the errors that are looked for, well above rounding.
NewtonSettings settings_for(double force) {
  return {.iterations = 400,
          .relative_successive = 0,
          .relative_initial = 0,
          .absolute_residual = 1e-7 * force,
          .line_search_iterations = 3};
}

}  // namespace

double Schedule::weight(double time) const {
  if (time < ramp) return time / ramp;
  if (time <= hold) return 1;
  return std::max(0.0, 1 - (time - hold) / (release - hold));
}

Material calculix_material(double yield_stress, double flow_rate) {
  return {.young_modulus = 5000,
          .poisson_ratio = 0.45,
          .yield_stress = yield_stress,
          .flow_rate = flow_rate,
          .hardening = 0.2};
}

std::vector<double> face_weights(const HexMesh& mesh, const std::vector<int>& nodes) {
  std::vector<double> weight(mesh.num_nodes(), 0.0);
  const auto is_among = [&](int n) { return std::ranges::find(nodes, n) != nodes.end(); };
  double faces = 0;
  for (const std::array<int, 4>& face : mesh.boundary_faces()) {
    if (!std::ranges::all_of(face, is_among)) continue;
    for (const int n : face) weight[n] += 0.25;
    ++faces;
  }
  for (double& value : weight) value /= faces;
  return weight;
}

BarRun run_bar(const BarCase& bar) {
  Body body(bar_mesh(bar.refine), {bar.material}, bar.settings);
  const HexMesh& mesh = body.mesh();
  const PointArray loads = end_loads(bar, mesh);
  LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 0.0), nodes_at(mesh, kAxis, kSlices / 2 * kCell),
                    [&](double time, ConstPoints, Points f) { f += bar.schedule.weight(time) * loads; });
  NewtonRaphson newton(settings_for(bar.force));
  CholeskySolver solver;

  PointArray x = mesh.positions();
  BarRun run;
  const auto balance = [&](double time) {
    if (newton.solve(system, solver, time, x).status == NewtonStatus::kNotConverged) ++run.unsolved;
  };
  const int steps = static_cast<int>(std::lround(bar.schedule.end / bar.dt));
  const int peak = static_cast<int>(std::lround(bar.schedule.hold / bar.dt));
  for (int step = 1; step <= steps; ++step) {
    balance(step * bar.dt);
    if (step == peak) run.peak = measure(body, x);
    body.flow(x, bar.dt);
  }
  balance(bar.schedule.end);
  run.residual = measure(body, x);
  return run;
}

Json row_of(const Json& rows, const Json& wanted) {
  for (const Json& row : rows)
    if (std::ranges::all_of(wanted.items(), [&](const auto& item) { return row[item.key()] == item.value(); }))
      return row;
  throw std::runtime_error("no row has " + wanted.dump());
}

double twist_deg(const Json& state, std::size_t layer) {
  return (state["twist_central_deg"][layer].get<double>() + state["twist_corner_deg"][layer].get<double>()) / 2;
}

PointArray elastic_equilibrium(Body& body, const std::vector<int>& fixed, const PointArray& loads, int load_steps) {
  LoadedBody system(body, std::vector<double>(body.mesh().num_nodes(), 0.0), fixed,
                    [&](double weight, ConstPoints, Points f) { f += weight * loads; });
  NewtonRaphson newton(settings_for(loads.norm()));
  CholeskySolver solver;
  PointArray x = body.mesh().positions();
  for (int step = 1; step <= load_steps; ++step) {
    if (newton.solve(system, solver, static_cast<double>(step) / load_steps, x).status == NewtonStatus::kNotConverged)
      throw std::runtime_error("no equilibrium");
  }
  return x;
}

}  // namespace hexaplast::support
