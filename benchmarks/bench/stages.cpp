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

// Additions and multiplications per hexahedron of one product, as theory.md section 9.3 writes it:
// edges 36, blending 2 x 108, eight samples of Z 45, trace 3, 2 mu 1, stress 12, back 54, edges to corners 72 ...
constexpr double kBoxFlops = 36 + 2 * 108 + 8 * (45 + 3 + 1 + 12 + 54) + 72;
// ... and with general rest shapes H and its transpose 144 + 120, scaled edges 2 x 36 in place of the blending, and
// twice 54 more per sample
constexpr double kGeneralFlops = 36 + 2 * 36 + 144 + 120 + 8 * (45 + 3 + 1 + 12 + 54 + 2 * 54) + 72;

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
  const double fraction = op.per_sample ? 1 : general / partition.num_blocks;
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

/// Flow and averaging on copies of the history, so that every repetition starts from the same one.
void time_flow(Bar& bar, int repetitions, double ns, Stages& stages) {
  const Body::State& body = bar.body().state();
  const Model& model = body.model;
  Linearization at = body.at;
  PreconditionedConjugateGradients solver = averaging_solver(model);
  FlowWorkspace work(model, body.history);
  std::optional<Averaging> averaging;
  if (work.averaging) averaging.emplace(model);

  double flow_seconds = std::numeric_limits<double>::infinity(), averaging_seconds = flow_seconds;
  bool flows = false;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    History history = body.history;
    linearize(model, history, bar.positions(), at);
    flow_seconds = std::min(
        flow_seconds, min_seconds(1, [&](int) { flows = flow(model, at, kBarDt, solver, history, work).yielded > 0; }));
    if (!averaging) {
      averaging_seconds = 0;
      continue;
    }
    // the rest shapes have flowed; the averaging starts again from the positions before
    history.plastic_rest_positions = body.history.plastic_rest_positions;
    history.averaging_increment = body.history.averaging_increment;
    ++history.version;
    averaging_seconds =
        std::min(averaging_seconds, min_seconds(1, [&](int) { averaging->advance(model, solver, history); }));
  }
  stages.averaging_ns = flows ? ns * averaging_seconds : 0;
  stages.flow_ns = std::max(0.0, ns * flow_seconds - stages.averaging_ns);
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

  bar.body().linearize(bar.positions());
  std::visit(
      [&](const auto& op) {
        describe_operator(op, bar.num_elements(), stages);
        stages.operator_ns = ns * time_product(op, 5 * repetitions);
      },
      bar.body().state().at.op);
  stages.vectors_ns = std::max(0.0, ns * time_iteration(bar, repetitions) - stages.operator_ns);
  if (bar.body().state().model.can_stretch) time_flow(bar, repetitions, ns, stages);
  return stages;
}

}  // namespace hexaplast::bench
