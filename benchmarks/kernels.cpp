// SPDX-License-Identifier: LGPL-2.1-or-later
// Time of each stage on the twisted and stretched bar of the shipped scenes, refined to two sizes, in both precisions.
// Every benchmark checks what it computed: forces must sum to zero, products must be symmetric, and a step must end in
// the same state each time it is repeated from the same start.
#include <benchmark/benchmark.h>

#include <cmath>
#include <variant>

#include "base/simd.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/layout/linear_system.hpp"
#include "layout/chunked_operator.hpp"
#include "layout/partition.hpp"

namespace {

using namespace hexaplast;

/// A bar of cells 3r x 3r x 10r under stretch and twist beyond yield.
struct Bar {
  Body body;
  PointArray x;

  Bar(std::int64_t refinement, Precision precision)
      : body(mesh(static_cast<int>(refinement)), {material()}, {.precision = precision}), x(body.mesh().positions()) {
    for (int n = 0; n < x.rows(); ++n) {
      const double angle = 1.5 * x(n, 2);
      const Vec3 at = x.row(n).transpose();
      x.row(n) << std::cos(angle) * at[0] - std::sin(angle) * at[1], std::sin(angle) * at[0] + std::cos(angle) * at[1],
          1.3 * at[2];
    }
  }

  static HexMesh mesh(int refinement) {
    return regular_grid({3 * refinement, 3 * refinement, 10 * refinement}, {-.15, -.15, 0}, {.15, .15, 1});
  }
  static Material material() { return {.yield_stress = 300, .flow_rate = 2, .hardening = .2}; }
};

void count_elements(benchmark::State& state, const Bar& bar) {
  const double elements = static_cast<double>(state.iterations()) * bar.body.mesh().num_elements();
  state.counters["hex/ms"] = benchmark::Counter(elements * 1e-3, benchmark::Counter::kIsRate);
}

template <Precision kPrecision>
void linearize_and_force(benchmark::State& state) {
  Bar bar(state.range(0), kPrecision);
  const PointArray beside = bar.x.array() + 1e-9;  // a body does not linearize twice at the same place
  PointArray f = PointArray::Zero(bar.x.rows(), 3);
  bool is_beside = false;
  for (auto _ : state) {
    bar.body.linearize((is_beside = !is_beside) ? beside : bar.x);
    f.setZero();
    bar.body.add_force(f);
  }
  if (f.colwise().sum().norm() > 1e-12 * f.cwiseAbs().sum()) state.SkipWithError("forces do not sum to zero");
  count_elements(state, bar);
}

/// The product as solvers have it: on the kernels' own vectors.
template <Precision kPrecision>
void stiffness_product(benchmark::State& state) {
  Bar bar(state.range(0), kPrecision);
  bar.body.linearize(bar.x);
  MatrixFreeSystem system;
  bar.body.describe(-1, system);
  const auto measure = [&]<class T>(const ChunkedOperator<T>& op) {
    const Partition& partition = op.partition();
    const auto product = [&](const PointArray& field, AlignedVector<T>& p, AlignedVector<T>& Ap) {
      to_slots(partition, field, p);
      std::fill(Ap.begin(), Ap.end(), T(0));
      for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, T(1), p.data(), Ap.data());
    };
    AlignedVector<T> a = slot_vector<T>(partition), b = a, La = a, Lb = a;
    product(bar.x.array().cos(), b, Lb);
    product(bar.x.array().sin(), a, La);

    double left = 0, right = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      left += static_cast<double>(b[k]) * static_cast<double>(La[k]);
      right += static_cast<double>(a[k]) * static_cast<double>(Lb[k]);
    }
    const double tolerance = kPrecision == Precision::kDouble ? 1e-9 : 1e-3;
    if (std::abs(left - right) > tolerance * std::abs(left)) state.SkipWithError("the product is not symmetric");
    for (auto _ : state)
      for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, T(1), a.data(), La.data());
  };
  if (system.bodies[0].double_operator)
    measure(*system.bodies[0].double_operator);
  else
    measure(*system.bodies[0].single_operator);
  count_elements(state, bar);
}

void plastic_flow(benchmark::State& state) {
  Bar bar(state.range(0), Precision::kDouble);
  std::uint64_t first = 0;
  for (auto _ : state) {
    state.PauseTiming();
    bar.body.reset();
    bar.body.linearize(bar.body.plastic_rest_positions());
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

BENCHMARK(linearize_and_force<Precision::kDouble>)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(linearize_and_force<Precision::kMixed>)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(stiffness_product<Precision::kDouble>)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(stiffness_product<Precision::kMixed>)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(plastic_flow)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::AddCustomContext("simd", hexaplast::simd_target());
  benchmark::RunSpecifiedBenchmarks();
}
