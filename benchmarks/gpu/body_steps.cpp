// SPDX-License-Identifier: LGPL-2.1-or-later
// body_steps DEVICE [HEXAHEDRA...]: time steps of blocks that flow everywhere, on the CPU and on a device, as a program
// takes them: with all transfers. Prints lines of JSON, which scripts/gpu_check reads.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/moving_body.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"

namespace {

using namespace hexaplast;

constexpr double kEdge = 0.003;  // [m]

MovingBody block(int size, bool has_tolerance, const std::string& device) {
  const int n = std::max(1, static_cast<int>(std::lround(std::cbrt(size / 2.0)))), height = 2 * n;
  const HexMesh mesh = regular_grid({n, n, height}, {0, 0, 0}, {n * kEdge, n * kEdge, height * kEdge});
  Body body(mesh, {{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 1, .flow_rate = 2}},
            {.precision = Precision::kMixed});
  body.use_device(device);
  Motion motion{.density = 1000, .dt = .01};
  const int of_end = (n + 1) * (n + 1);
  for (int node = 0; node < of_end; ++node) motion.fixed.push_back(node);
  motion.load = [=](double, ConstPoints, Points f) {
    f.bottomRows(of_end).col(2).array() += 300 * n * kEdge * n * kEdge / of_end;
  };
  std::unique_ptr<LinearSolver> solver;
  if (has_tolerance)
    solver = std::make_unique<PreconditionedConjugateGradients>(.01, 2000, Preconditioner::kAuto);
  else
    solver = std::make_unique<ConjugateGradients>(
        ConjugateGradientSettings{.iterations = 25, .tolerance = 0, .threshold = 0});
  MovingBody moving(std::move(body), std::move(motion), std::move(solver));
  moving.positions.col(2) *= 1.05;  // all of it is beyond yield at once
  return moving;
}

struct Times {
  double median, p99, yielded, iterations;
};

Times run(MovingBody& moving, int steps) {
  std::vector<double> ms;
  double yielded = 0, iterations = 0;
  for (int k = -2; k < steps; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    const FlowReport report = moving.step();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    if (k < 0) continue;
    ms.push_back(time.count());
    yielded += static_cast<double>(report.yielded) / moving.body.mesh().num_elements() / steps;
    iterations += static_cast<double>(moving.latest.iterations) / steps;
  }
  std::ranges::sort(ms);
  return {ms[ms.size() / 2], ms[std::min(ms.size() - 1, ms.size() * 99 / 100)], yielded, iterations};
}

void compare(int size, bool has_tolerance, const std::string& device) {
  const int steps = size > 500000 ? 5 : size > 50000 ? 20 : 50;
  MovingBody on_cpu = block(size, has_tolerance, "cpu"), first = block(size, has_tolerance, device),
             second = block(size, has_tolerance, device);
  const Times cpu = run(on_cpu, steps), found = run(first, steps);
  run(second, steps);
  const double length = on_cpu.positions.col(2).maxCoeff();
  std::printf(
      R"({"step": "%s", "hexahedra": %d, "flow": %.3g, "iterations": %.4g, "ms": %.4g, "p99 ms": %.4g, "CPU iterations": %.4g, "CPU ms": %.4g})"
      "\n",
      has_tolerance ? "to 1 %" : "25 iterations", on_cpu.body.mesh().num_elements(), found.yielded, found.iterations,
      found.median, found.p99, cpu.iterations, cpu.median);
  std::printf(R"({"check": "positions, %s", "hexahedra": %d, "error": %g, "limit": %g})"
              "\n",
              has_tolerance ? "to 1 %" : "25 iterations", on_cpu.body.mesh().num_elements(),
              (first.positions - on_cpu.positions).cwiseAbs().maxCoeff() / length, has_tolerance ? 2e-3 : 1e-4);
  std::printf(R"({"check": "other hash in a repeat", "hexahedra": %d, "error": %d, "limit": 0})"
              "\n",
              on_cpu.body.mesh().num_elements(), first.state_hash() != second.state_hash());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: body_steps DEVICE HEXAHEDRA...\n", stderr);
    return 2;
  }
  for (int k = 2; k < argc; ++k)
    for (const bool has_tolerance : {false, true}) compare(std::atoi(argv[k]), has_tolerance, argv[1]);
}
