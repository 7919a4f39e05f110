// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/beyond_yield.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "body_state.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/newton_raphson.hpp"
#include "loaded_body.hpp"
#include "plain/plain.hpp"
#include "support/dense.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast::support {
namespace {

Settings settings_of(RestShape rest_shape, YieldStressMeasure measure = YieldStressMeasure::kBiot) {
  return {.yield_stress_measure = measure, .rest_shape = rest_shape, .volume_restitution = 0.1};  // steps of 1 s
}

/// A body in equilibrium, and plastic steps from one to the next.
class Equilibrium {
 public:
  Equilibrium(Body& body, MechanicalSystem& system, double residual)
      : x(body.mesh().positions()),
        body_(body),
        system_(system),
        newton_({.iterations = 50, .relative_successive = 0, .relative_initial = 0, .absolute_residual = residual}) {}

  PointArray x;

  void find() {
    if (newton_.solve(system_, cholesky_, 0, x).status == NewtonStatus::kNotConverged)
      throw std::runtime_error("no equilibrium");
  }
  /// dt [s], each from an equilibrium, and to one at the end.
  void flow(int steps, double dt = 1) {
    for (int step = 0; step < steps; ++step) {
      find();
      body_.flow(x, dt);
    }
    find();
  }

 private:
  Body& body_;
  MechanicalSystem& system_;
  CholeskySolver cholesky_;
  NewtonRaphson newton_;
};

// Cantilever
// ---------------------------------------------------------------------------------------------------------------------

constexpr double kLength = 0.2, kWidth = 0.01, kHeight = 0.02, kYoung = 2.1e6, kYield = 2350;

}  // namespace

BentCantilever bend(const Cantilever& beam) {
  constexpr double kFlowRate = 0.2;  // [1/s], in steps of 1 s
  const HexMesh mesh =
      regular_grid(beam.cells, Vec3(0, -kWidth / 2, -kHeight / 2), Vec3(kLength, kWidth / 2, kHeight / 2));
  Body body(mesh,
            {Material{.young_modulus = kYoung,
                      .poisson_ratio = beam.poisson_ratio,
                      .yield_stress = kYield,
                      .flow_rate = kFlowRate}},
            settings_of(beam.rest_shape));
  const std::vector<int> end = nodes_at(mesh, 0, kLength);
  double load = beam.load * kYield * kWidth * kHeight * kHeight / 6 / kLength;  // [N]
  LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 1), nodes_at(mesh, 0, 0),
                    [&](double, ConstPoints, Points f) {
                      for (const int n : end) f(n, 2) -= load / static_cast<double>(end.size());
                    });
  Equilibrium at(body, system, 1e-9);
  const auto deflection_after = [&](double time) {
    at.flow(static_cast<int>(std::lround(time / kFlowRate)));
    double sum = 0;
    for (const int n : end) sum -= at.x(n, 2) - mesh.positions()(n, 2);
    return sum / static_cast<double>(end.size());
  };
  BentCantilever found;
  found.loaded = deflection_after(beam.time);
  found.creep = (deflection_after(1) - found.loaded) / found.loaded;
  load = 0;
  found.released = deflection_after(1);
  found.residual_energy = body.energy(at.x);
  return found;
}

BentCantilever bend_in_theory(const Cantilever& beam) {
  const double of_yield = 2 * kYield * kLength * kLength / (3 * kYoung * kHeight), elastic = beam.load * of_yield;
  const double loaded = beam.load <= 1
                            ? elastic
                            : (5 - (3 + beam.load) * std::sqrt(3 - 2 * beam.load)) / (beam.load * beam.load) * of_yield;
  return {.loaded = loaded, .released = loaded - elastic};
}

// Strip
// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// 1 x 1 x cells hexahedra of height and length 1, whose ends turn against each other. Stress is small beside the
/// modulus.
class BentStrip {
 public:
  BentStrip(int cells, double width, bool is_plate, double poisson_ratio)
      : body_(regular_grid({1, 1, cells}, Vec3(-0.5, 0, -0.5), Vec3(0.5, width, 0.5)),
              {Material{.young_modulus = kModulus, .poisson_ratio = poisson_ratio, .yield_stress = 1, .flow_rate = 1}},
              settings_of(RestShape::kIsolated)),
        yield_moment_(width / 6),
        system_(body_, held(body_.mesh(), is_plate), {}),
        at_(body_, system_, 1e-11) {}

  /// Over that of first yield in uniaxial stress, at a curvature over that of it, after some plastic steps of rate 1.
  double moment(double curvature, int num_flows) {
    const PointArray& X = body_.mesh().positions();
    at_.x.col(0) = X.col(0).array() * (1 + curvature * 2 / kModulus * X.col(2).array());
    at_.flow(num_flows);
    const PointArray f = force_at(body_, at_.x);
    double sum = 0;
    for (int n = 0; n < X.rows(); ++n)
      if (X(n, 0) > 0) sum -= f(n, 0) * X(n, 2);
    return sum / yield_moment_;
  }

 private:
  static constexpr double kModulus = 1000;  // Young's, over the yield stress

  static std::vector<GuidedBody::Held> held(const HexMesh& mesh, bool is_plate) {
    std::vector<GuidedBody::Held> held;
    for (int n = 0; n < mesh.num_nodes(); ++n) {
      const Vec3 X = mesh.positions().row(n);
      const bool is_in_middle = X.y() < 1e-9;
      held.push_back({n, 0});
      if (is_plate || is_in_middle) held.push_back({n, 1});
      if (is_in_middle && X.z() < -0.499) held.push_back({n, 2});
    }
    return held;
  }

  Body body_;
  double yield_moment_;
  GuidedBody system_;
  Equilibrium at_;
};

}  // namespace

double limit_moment(int cells_across, bool is_plate, double poisson_ratio) {
  BentStrip strip(cells_across, is_plate ? 1 : 0.05, is_plate, poisson_ratio);
  double moment = 0;
  for (int step = 1; step <= 100; ++step) moment = strip.moment(0.2 * step, 10);
  return moment / exact_limit_moment(is_plate);
}

double exact_limit_moment(bool is_plate) { return is_plate ? std::sqrt(3.0) : 1.5; }

namespace {

constexpr int kPerYield = 10, kTurn = 3 * kPerYield, kSteps = 9 * kPerYield;

double curvature_at(int step) { return (step > kTurn ? 2 * kTurn - step : step) / static_cast<double>(kPerYield); }

}  // namespace

std::vector<double> bend_to_and_fro(int cells_across) {
  BentStrip strip(cells_across, 0.05, false, 0);
  std::vector<double> moments;
  for (int step = 1; step <= kSteps; ++step) moments.push_back(strip.moment(curvature_at(step), 4));
  return moments;
}

BendingLoop loop_of(const std::vector<double>& moments) {
  const auto beam = [](double curvature) { return curvature <= 1 ? curvature : 1.5 - 0.5 / (curvature * curvature); };
  BendingLoop loop;
  std::vector<double> expected;
  double before = 0;
  for (int step = 1; step <= kSteps; ++step) {
    const bool is_way_back = step > kTurn;
    const double curvature = curvature_at(step), moment = moments[step - 1];
    expected.push_back(is_way_back ? beam(3) - 2 * beam((3 - curvature) / 2) : beam(curvature));
    if (is_way_back && before > 0 && moment <= 0)
      loop.residual_curvature = curvature - moment / (before - moment) / kPerYield;
    if (is_way_back && std::abs(curvature - 0.9) < 1e-9) loop.reversed_moment = moment;
    before = moment;
  }
  loop.rms = rms(moments, expected);
  return loop;
}

double rms(const std::vector<double>& found, const std::vector<double>& expected) {
  double squares = 0;
  for (std::size_t n = 0; n < found.size(); ++n) squares += std::pow(found[n] - expected[n], 2);
  return std::sqrt(squares / static_cast<double>(found.size()));
}

// Tube
// ---------------------------------------------------------------------------------------------------------------------

namespace {

constexpr double kBore = 1, kOuter = 2, kFront = 1.5, kTubeModulus = 1000, kTubePoissonRatio = 0.49;
const double kShearYield = 1 / std::numbers::sqrt3;
const double kPressure = kShearYield * (2 * std::log(kFront / kBore) + 1 - kFront * kFront / (kOuter * kOuter));

/// Residual hoop stress of an incompressible tube: that under pressure less that of the elastic tube.
double residual_hoop(double r) {
  const double b2 = kOuter * kOuter, c2 = kFront * kFront;
  const double loaded =
      r < kFront ? kShearYield * (1 + c2 / b2 - 2 * std::log(kFront / r)) : kShearYield * c2 * (1 / b2 + 1 / (r * r));
  return loaded - kPressure * kBore * kBore / (b2 - kBore * kBore) * (1 + b2 / (r * r));
}

/// Mean Cauchy stress of a hexahedron: of the forces of its corners.
Mat3 mean_stress(const Body& body, int e, const PointArray& x) {
  const Model& model = body.state().model;
  const History& history = body.state().history;
  const Hexahedron& corners = body.mesh().hexahedra()[e];
  const ElementPoints current = gather(x, corners);
  const plain::Element element(gather(body.mesh().positions(), corners), current, model.lame[e], model.settings,
                               history.plastic_inverse_of(e));
  return -element.force().transpose() * current / body.initial_volume(e);
}

}  // namespace

ExpandedTube expand_tube(int cells_across) {
  constexpr int kRamp = 20, kHold = 200;
  const int around = 2 * cells_across;
  const HexMesh grid =
      regular_grid({cells_across, around, 1}, Vec3(kBore, 0, 0), Vec3(kOuter, std::numbers::pi / 2, 0.1));
  PointArray X = grid.positions();
  for (int n = 0; n < grid.num_nodes(); ++n) {
    const double r = grid.positions()(n, 0), angle = grid.positions()(n, 1);
    X(n, 0) = r * std::cos(angle);
    X(n, 1) = r * std::sin(angle);
  }
  const HexMesh mesh(X, grid.hexahedra());
  std::vector<GuidedBody::Held> held;
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    held.push_back({n, 2});
    for (const int axis : {0, 1})
      if (std::abs(X(n, axis)) < 1e-9) held.push_back({n, axis});
  }
  PointArray loads = PointArray::Zero(mesh.num_nodes(), 3);  // of the pressure, over it
  for (const std::array<int, 4>& face : mesh.boundary_faces()) {
    const auto is_inside = [&](int n) { return std::abs(grid.positions()(n, 0) - kBore) < 1e-9; };
    if (!std::ranges::all_of(face, is_inside)) continue;
    const Vec3 p = X.row(face[0]), q = X.row(face[1]), r = X.row(face[2]), s = X.row(face[3]);
    const Vec3 area = (r - p).cross(s - q) / 2;  // outwards
    for (const int n : face) loads.row(n) -= area / 4;
  }

  Body body(
      mesh,
      {Material{.young_modulus = kTubeModulus, .poisson_ratio = kTubePoissonRatio, .yield_stress = 1, .flow_rate = 1}},
      settings_of(RestShape::kIsolated));
  double pressure = 0;
  GuidedBody system(body, held, [&](double, ConstPoints, Points f) { f += pressure * loads; });
  Equilibrium at(body, system, 1e-11);
  for (int step = 1; step <= kRamp; ++step) {
    pressure = kPressure * step / kRamp;
    at.flow(step < kRamp ? 4 : kHold);
  }
  ExpandedTube found;
  found.outer_displacement = at.x(nodes_at(grid, 0, kOuter).front(), 0) - kOuter;  // at the angle 0

  pressure = 0;
  at.flow(4);
  for (int ring = 0; ring < cells_across; ++ring) {
    double sum = 0;
    for (int k = 0; k < around; ++k) {
      const double angle = (k + 0.5) / around * std::numbers::pi / 2;
      const Vec3 along(-std::sin(angle), std::cos(angle), 0);
      sum += along.dot(mean_stress(body, ring + cells_across * k, at.x) * along);
    }
    found.hoop.push_back(sum / around);
  }
  return found;
}

ExpandedTube tube_in_theory(int cells_across) {
  ExpandedTube exact;
  exact.outer_displacement =
      2 * (1 - kTubePoissonRatio * kTubePoissonRatio) * kShearYield * kFront * kFront / (kTubeModulus * kOuter);
  for (int ring = 0; ring < cells_across; ++ring) {
    const double low = kBore + (kOuter - kBore) * ring / cells_across, h = (kOuter - kBore) / cells_across;
    double moment = 0, area = 0;  // by the midpoint rule
    for (int k = 0; k < 100; ++k) {
      const double r = low + (k + 0.5) / 100 * h;
      moment += residual_hoop(r) * r;
      area += r;
    }
    exact.hoop.push_back(moment / area);
  }
  return exact;
}

// Block
// ---------------------------------------------------------------------------------------------------------------------

std::array<double, 3> stretch_block(int moves_per_percent, int flows_per_move) {
  constexpr double kTau = 50, kArea = 9;
  Body body(block({3, 3, 4}, 1),
            {Material{.young_modulus = 5000, .poisson_ratio = 0.45, .yield_stress = kTau, .flow_rate = 1}},
            settings_of(RestShape::kIsolated, YieldStressMeasure::kCauchy));
  const HexMesh& mesh = body.mesh();
  std::vector<int> ends = nodes_at(mesh, 2, 0);
  const std::vector<int> top = nodes_at(mesh, 2, 4);
  ends.insert(ends.end(), top.begin(), top.end());
  LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 0.0), ends, {});
  Equilibrium at(body, system, 1e-7 * kTau);
  std::array<double, 3> force{};
  double reached = 1;
  for (int percent = 1; percent <= 30; ++percent) {
    for (int k = 1; k <= moves_per_percent; ++k) {
      const double next = 1 + 0.01 * (percent - 1 + k / static_cast<double>(moves_per_percent));
      at.x.col(2) *= next / reached;
      reached = next;
      at.flow(flows_per_move);
    }
    if (percent % 10 != 0) continue;
    const PointArray f = force_at(body, at.x);
    for (const int n : top) force[percent / 10 - 1] -= f(n, 2) / (kTau * kArea);
  }
  return force;
}

std::vector<PulledPatch> pull_patch(double edge, double height, RecoveryMode recovery) {
  constexpr double kMove = 0.25e-3, kRow = 2e-3;
  constexpr int kFlows = 4, kMoves = 8;  // to the next row
  const auto cells = [&](double length) { return static_cast<int>(std::lround(length / edge)); };
  const HexMesh mesh = regular_grid({cells(0.06), cells(0.06), cells(0.03)}, Vec3::Zero(), Vec3(0.06, 0.06, 0.03));
  Settings settings = settings_of(RestShape::kIsolated, YieldStressMeasure::kCauchy);
  settings.recovery = recovery;
  Body body(mesh, {Material{.young_modulus = 2000, .poisson_ratio = 0.45, .yield_stress = 160, .flow_rate = 1}},
            settings);
  const PointArray& X = mesh.positions();
  std::vector<int> held = nodes_at(mesh, 2, 0), patch;
  for (const int n : nodes_at(mesh, 2, 0.03))
    if ((X.row(n).head<2>().array() - 0.03).abs().maxCoeff() < 0.0101) patch.push_back(n);
  held.insert(held.end(), patch.begin(), patch.end());
  LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 0.0), held, {});
  Equilibrium at(body, system, 1e-6);
  std::vector<PulledPatch> rows;
  for (double reached = 0; reached < height - kRow / 2; reached += kRow) {
    for (int k = 1; k <= kMoves; ++k) {
      for (const int n : patch) at.x(n, 2) = X(n, 2) + reached + k * kMove;
      at.flow(kFlows);
    }
    PulledPatch& row = rows.emplace_back();
    const PointArray f = force_at(body, at.x);
    for (const int n : patch) row.force -= f(n, 2);
    for (const Hexahedron& corners : mesh.hexahedra())
      for (const double ratio : corner_ratios(gather(X, corners), gather(at.x, corners)))
        row.least_corner = std::min(row.least_corner, ratio);
  }
  return rows;
}

}  // namespace hexaplast::support
