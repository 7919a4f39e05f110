// SPDX-License-Identifier: LGPL-2.1-or-later
// Nanoseconds per hexahedron of each stage, on the twisted and stretched bar of the shipped scenes refined to three
// sizes. Every benchmark checks what it computed: forces must sum to zero, products must be symmetric, and a step must
// end in the same state each time it is repeated from the same start.
#include <benchmark/benchmark.h>

#include <cmath>

#include "hexaplast/body.hpp"
#include "hexaplast/mesh/grid.hpp"

namespace {

using namespace hexaplast;

/// A bar of cells 3r x 3r x 10r under stretch and twist beyond yield.
struct Bar {
  Body body;
  PointArray x;

  explicit Bar(int refinement)
      : body(
            regular_grid({3 * refinement, 3 * refinement, 10 * refinement}, {-.15, -.15, 0}, {.15, .15, 1}),
            {Material{
                .yield_stress = 300, .flow_rate = 2, .rotation_yield = .01, .rotation_flow_rate = 1, .hardening = .2}}),
        x(body.mesh().positions()) {
    for (int n = 0; n < x.rows(); ++n) {
      const double angle = 1.5 * x(n, 2);
      const Vec3 at = x.row(n).transpose();
      x.row(n) << std::cos(angle) * at[0] - std::sin(angle) * at[1], std::sin(angle) * at[0] + std::cos(angle) * at[1],
          1.3 * at[2];
    }
  }
};

void count_elements(benchmark::State& state, const Bar& bar) {
  const double elements = static_cast<double>(state.iterations()) * bar.body.mesh().num_elements();
  state.counters["hex/ms"] = benchmark::Counter(elements * 1e-3, benchmark::Counter::kIsRate);
}

void linearize_and_force(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  PointArray f = PointArray::Zero(bar.x.rows(), 3);
  for (auto _ : state) {
    bar.body.linearize(bar.x);
    f.setZero();
    bar.body.add_force(f);
  }
  if (f.colwise().sum().norm() > 1e-12 * f.cwiseAbs().sum()) state.SkipWithError("forces do not sum to zero");
  count_elements(state, bar);
}

void stiffness_product(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  bar.body.linearize(bar.x);
  const PointArray a = bar.x.array().sin(), b = bar.x.array().cos();
  PointArray Ka = PointArray::Zero(a.rows(), 3), Kb = Ka;
  for (auto _ : state) {
    Ka.setZero();
    bar.body.add_stiffness_product(1, a, Ka);
  }
  bar.body.add_stiffness_product(1, b, Kb);
  const double left = b.cwiseProduct(Ka).sum(), right = a.cwiseProduct(Kb).sum();
  if (std::abs(left - right) > 1e-9 * std::abs(left)) state.SkipWithError("the product is not symmetric");
  count_elements(state, bar);
}

void plastic_flow(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  std::uint64_t first = 0;
  for (auto _ : state) {
    state.PauseTiming();
    bar.body.reset();
    state.ResumeTiming();
    const FlowReport report = bar.body.flow(bar.x, 0.01);
    state.PauseTiming();
    StateHash hash;
    bar.body.add_to(hash);
    if (first == 0) first = hash.value();
    if (hash.value() != first || report.yielded == 0) state.SkipWithError("the step did not repeat itself");
    state.ResumeTiming();
  }
  count_elements(state, bar);
}

BENCHMARK(linearize_and_force)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(stiffness_product)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(plastic_flow)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
