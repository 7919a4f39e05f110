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

namespace hexaplast::bench {

namespace {

// Additions and multiplications per hexahedron of one product, as theory.md section 9.3 writes it. Boxes: modes and
// their transpose 2 x 72, two gradients 2 x 84, what is assumed 90 + 2 x 108, columns of the samples 156 + 219, eight
// samples of Z, stress and back 51 + 14 + 45 ...
constexpr double kBoxFlops = 2 * 72 + 2 * 84 + 90 + 2 * 108 + 156 + 219 + 8 * (51 + 14 + 45);
// ... general shapes: edges and their transpose 36 + 72, mean columns and hourglass modes with their transposes
// 2 x (144 + 36 + 54), what is assumed 90 + 2 x 108 + 27 + 45, H and its transpose 144 + 120, scaled edges 2 x 36,
// gradients 2 x 72 + 2 x 84, and eight samples with R 2 x 45 + 27 + 54 + 17 + 45 + 36
constexpr double kGeneralFlops = 36 + 72 + 2 * (144 + 36 + 54) + 90 + 2 * 108 + 27 + 45 + 144 + 120 + 2 * 36 + 2 * 72 +
                                 2 * 84 + 8 * (2 * 45 + 27 + 54 + 17 + 45 + 36);

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

template <class T, class Coef>
void describe_operator(const ElementOperator<T, Coef>& op, int num_elements, Stages& stages) {
  const Partition& partition = op.partition();
  double general = 0;
  for (const unsigned char is_general : op.is_general) general += is_general != 0;
  const double fraction = general / partition.num_blocks;
  stages.operator_flops = fraction * kGeneralFlops + (1 - fraction) * kBoxFlops;
  // coefficients and corner slots stream through; p is read, Ap read and written
  stages.operator_footprint = op.bytes() + partition.corner.size() * sizeof(int) +
                              3 * 4 * static_cast<std::size_t>(partition.num_slots) * sizeof(T);
  stages.operator_bytes = static_cast<double>(stages.operator_footprint) / num_elements;
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
  const Model& model = body.model;
  Linearization at = body.at;
  FlowWorkspace work(model, body.history);
  double seconds = std::numeric_limits<double>::infinity();
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    History history = body.history;
    linearize(model, history, bar.positions(), at);
    seconds = std::min(seconds, min_seconds(1, [&](int) { flow(model, at, kBarDt, history, work); }));
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
  if (bar.body().state().is_plain()) return stages;  // the rest is of the kernels

  bar.body().linearize(bar.positions());
  std::visit(
      [&](const auto& op) {
        describe_operator(op, bar.num_elements(), stages);
        stages.operator_ns = ns * time_product(op, 5 * repetitions);
      },
      bar.body().state().at.op);
  stages.vectors_ns = std::max(0.0, ns * time_iteration(bar, repetitions) - stages.operator_ns);
  if (bar.body().can_flow()) stages.flow_ns = ns * time_flow(bar, repetitions);
  return stages;
}

}  // namespace hexaplast::bench
