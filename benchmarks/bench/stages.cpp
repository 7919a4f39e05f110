// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/stages.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "body_state.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "kernel_backend.hpp"

namespace hexaplast::bench {

namespace {

template <class Work>
double min_seconds(int repetitions, const Work& work) {
  double min = std::numeric_limits<double>::infinity();
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto begin = std::chrono::steady_clock::now();
    work(repetition);
    min = std::min(min, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return min;
}

/// [s] of one product with the operator that `bar` was linearized to, as the solvers carry it out.
template <class T>
double time_product(const ChunkedOperator<T>& op, int repetitions) {
  const Partition& partition = op.partition();
  AlignedVector<T> p = slot_vector<T>(partition), Ap = p;
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = static_cast<T>(std::sin(0.1 * static_cast<double>(k)));
  return min_seconds(repetitions, [&](int) {
    parallel_for(partition.num_chunks, [&](int chunk) { op.add_product(chunk, T(1e-3), p.data(), Ap.data()); });
  });
}

/// Time of one iteration of plain conjugate gradients [s]: the difference between many and few.
double time_iteration(Bar& bar, int repetitions) {
  constexpr int kFew = 5, kMany = 25;
  ConjugateGradients few({.iterations = kFew, .tolerance = 0, .threshold = 0});
  ConjugateGradients many({.iterations = kMany, .tolerance = 0, .threshold = 0});
  const double few_seconds = min_seconds(repetitions, [&](int) { bar.increment(few); });
  const double many_seconds = min_seconds(repetitions, [&](int) { bar.increment(many); });
  return (many_seconds - few_seconds) / (kMany - kFew);
}

/// On copies of the history, so that every repetition starts from the same one [s].
double time_flow(Bar& bar, int repetitions) {
  const Body::State& body = bar.body().state();
  History history = body.history;
  KernelBackend kernels(body.model, history, body.branches);
  FlowWorkspace work(body.model, history);
  double seconds = std::numeric_limits<double>::infinity();
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    history = body.history;
    kernels.linearize(bar.positions());
    seconds = std::min(seconds, min_seconds(1, [&](int) { flow(body.model, kernels.at, kBarDt, history, work); }));
  }
  return seconds;
}

}  // namespace

Stages measure_stages(Bar& bar, int repetitions) {
  Stages stages;
  const double ns = 1e9 / bar.num_elements();

  // a body does not linearize twice at the same place
  const PointArray nudged = bar.positions().array() + 1e-9;
  stages.linearize_ns = ns * min_seconds(2 * repetitions, [&](int repetition) {
                          bar.body().linearize(repetition % 2 == 0 ? nudged : bar.positions());
                        });
  auto* const kernels = dynamic_cast<KernelBackend*>(bar.body().state().backend.get());
  if (!kernels) return stages;

  bar.body().linearize(bar.positions());
  stages.operator_ns =
      ns * std::visit([&](const auto& op) { return time_product(op, 5 * repetitions); }, kernels->at.op);
  stages.vectors_ns = std::max(0.0, ns * time_iteration(bar, repetitions) - stages.operator_ns);
  if (bar.body().can_flow()) stages.flow_ns = ns * time_flow(bar, repetitions);
  return stages;
}

}  // namespace hexaplast::bench
