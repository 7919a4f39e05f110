// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/batch.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/simd.hpp"
#include "bench/bar.hpp"
#include "bench/record.hpp"
#include "hexaplast/base/hash.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"

namespace hexaplast::bench {

namespace {

constexpr int kIterations = 25;
constexpr double kNearlyAllOfThem = 0.999;
constexpr int kBatchWarmUp = 2;  // first steps, which allocate

/// How the bodies of a batch take their turns.
enum class Way { kAlone, kLoops, kTogether, kIndependent };

struct Kind {
  int size, num_bodies;
  Mode mode;
  Precision precision;
};

/// Bars of one kind; no two have the same stiffness, so that none can be taken for another.
class Batch {
 public:
  explicit Batch(const Kind& kind) : errors_(static_cast<std::size_t>(kind.num_bodies)) {
    for (int k = 0; k < kind.num_bodies; ++k) {
      BarSettings bar;
      bar.mode = kind.mode;
      bar.precision = kind.precision;
      bar.young_modulus = 5000 + 10.0 * k;
      bar.cells = batch_cells(kind.size);
      bars_.push_back(std::make_unique<Bar>(bar));
      solvers_.push_back(std::make_unique<ConjugateGradients>(
          ConjugateGradientSettings{.iterations = kIterations, .tolerance = 0, .threshold = 0}));
    }
    min_yielded_.assign(errors_.size(), kind.mode == Mode::kPlastic ? 1 : 0);
  }

  void run(Way way, int num_steps) {
    const int count = static_cast<int>(bars_.size());
    switch (way) {
      case Way::kAlone:
      case Way::kLoops:
        for (int k = 0; k < count; ++k) advance(k, num_steps);
        return;
      case Way::kTogether:
        for (int step = 0; step < num_steps; ++step) parallel_for(count, [&](int k) { advance(k, 1); });
        return;
      case Way::kIndependent:
        parallel_for(count, [&](int k) { advance(k, num_steps); });
    }
  }

  std::vector<std::string> hashes() const {
    std::vector<std::string> found;
    for (const std::unique_ptr<Bar>& bar : bars_) found.push_back(bar->hash());
    return found;
  }

  /// The first error of a body; empty: none.
  std::string error() const {
    for (std::size_t k = 0; k < errors_.size(); ++k)
      if (!errors_[k].empty()) return fmt::format("body {}: {}", k + 1, errors_[k]);
    return {};
  }

  /// The smallest fraction of hexahedra that have yielded in a step of a body.
  double min_yielded() const { return std::ranges::min(min_yielded_); }

 private:
  // nothing may be thrown out of a parallel loop, and a body that fails is not stepped any further
  void advance(int k, int num_steps) noexcept {
    const auto at = static_cast<std::size_t>(k);
    try {
      for (int step = 0; step < num_steps && errors_[at].empty(); ++step) {
        const Bar::Step done = bars_[at]->step(*solvers_[at]);
        min_yielded_[at] =
            std::min(min_yielded_[at], static_cast<double>(done.flow.yielded) / bars_[at]->num_elements());
      }
    } catch (const std::exception& error) {
      errors_[at] = error.what();
    }
  }

  std::vector<std::unique_ptr<Bar>> bars_;
  std::vector<std::unique_ptr<ConjugateGradients>> solvers_;
  std::vector<std::string> errors_;
  std::vector<double> min_yielded_;  // share, per body
};

/// What is measured in one way.
struct Measured {
  double wall = std::numeric_limits<double>::infinity(), processor = wall;  // [s] of a repetition
  std::vector<std::string> hashes;
};

/// [s] that the processors have worked for this program, waiting of threads that spin included.
double processor_time() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class KindRun {
 public:
  KindRun(const Kind& kind, const BatchOptions& options, BatchOutcome& outcome)
      : kind_(kind),
        options_(options),
        outcome_(outcome),
        num_steps_(options.quick ? 4 : std::clamp(2000 / kind.size, 4, 20)),
        num_rounds_(options.quick ? 2 : 5),
        size_(batch_cells(kind.size)[0] * batch_cells(kind.size)[1] * batch_cells(kind.size)[2]) {}

  void measure(const std::function<void(const BatchRecord&)>& on_record) {
    for (const int threads : options_.threads) {
      Measured alone, loops, together, independent;
      measure_way(Way::kAlone, 1, alone);
      if (threads > 1) measure_way(Way::kLoops, threads, loops);
      measure_way(Way::kTogether, threads, together);
      measure_way(Way::kIndependent, threads, independent);
      const auto rate = [&](const Measured& one) {
        return BatchRate{.per_core = static_cast<double>(kind_.num_bodies) * num_steps_ / one.processor,
                         .speed_up = alone.wall / one.wall};
      };
      BatchRecord record;
      record.size = size_;
      record.bodies = kind_.num_bodies;
      record.mode = name(kind_.mode);
      record.precision = kind_.precision == Precision::kDouble ? "double" : "mixed";
      record.threads = threads;
      record.simd = simd_target();
      record.processor = processor_name();
      record.alone = rate(alone);
      record.loops = threads > 1 ? rate(loops) : record.alone;
      record.together = rate(together);
      record.independent = rate(independent);
      StateHash hash;
      for (const std::string& one : together.hashes) hash.add(one.data(), one.size());
      record.state_hash = hash.text();
      outcome_.records.push_back(record);
      on_record(record);
    }
  }

 private:
  void measure_way(Way way, int threads, Measured& found) {
    set_num_threads(threads);
    Batch batch(kind_);
    batch.run(way, kBatchWarmUp);
    for (int round = 0; round < num_rounds_; ++round) {
      const auto begin = std::chrono::steady_clock::now();
      const double before = processor_time();
      batch.run(way, num_steps_);
      found.processor = std::min(found.processor, processor_time() - before);
      found.wall =
          std::min(found.wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    found.hashes = batch.hashes();
    if (alone_.empty()) alone_ = found.hashes;

    std::vector<std::string> wrong = {batch.error(), differing_bodies(alone_, found.hashes)};
    if (const double yielded = batch.min_yielded(); kind_.mode == Mode::kPlastic && yielded < kNearlyAllOfThem)
      wrong.push_back(fmt::format("only {:.2f} % of the hexahedra yield", 100 * yielded));
    for (const std::string& what : wrong) {
      if (what.empty()) continue;
      const std::string sentence =
          fmt::format("{} hexahedra, {}, {} threads: {}", size_, name(kind_.mode), threads, what);
      if (std::ranges::find(outcome_.failures, sentence) == outcome_.failures.end())
        outcome_.failures.push_back(sentence);
    }
  }

  Kind kind_;
  const BatchOptions& options_;
  BatchOutcome& outcome_;
  int num_steps_, num_rounds_;
  int size_;                        // hexahedra of each body
  std::vector<std::string> alone_;  // hash of each body, stepped alone
};

}  // namespace

std::array<int, 3> batch_cells(int size) {
  constexpr int kLength = 10;
  const int width = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(size) / kLength))));
  return {width, width, kLength};
}

std::string differing_bodies(const std::vector<std::string>& alone, const std::vector<std::string>& found) {
  std::size_t first = 0, count = 0;
  for (std::size_t k = alone.size(); k-- > 0;)
    if (alone[k] != found[k]) first = k, ++count;
  if (count == 0) return {};
  return fmt::format("{} of {} bodies have another state than alone; body {}: {} instead of {}", count, alone.size(),
                     first + 1, found[first], alone[first]);
}

BatchOutcome run_batch(const BatchOptions& options, const std::function<void(const BatchRecord&)>& on_record) {
  BatchOutcome outcome;
  for (const int size : options.sizes)
    for (const Precision precision : {Precision::kDouble, Precision::kMixed})
      for (const Mode mode : {Mode::kElastic, Mode::kPlastic})
        KindRun({size, options.num_bodies, mode, precision}, options, outcome).measure(on_record);
  return outcome;
}

std::string to_json(const std::vector<BatchRecord>& records) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  const auto of = [](const BatchRate& rate) {
    return nlohmann::ordered_json{{"steps_per_core_second", std::round(rate.per_core)},
                                  {"speed_up", std::round(1000 * rate.speed_up) / 1000}};
  };
  for (const BatchRecord& r : records)
    array.push_back({{"size", r.size},
                     {"bodies", r.bodies},
                     {"mode", r.mode},
                     {"precision", r.precision},
                     {"threads", r.threads},
                     {"simd", r.simd},
                     {"processor", r.processor},
                     {"alone", of(r.alone)},
                     {"loops", of(r.loops)},
                     {"together", of(r.together)},
                     {"independent", of(r.independent)},
                     {"state_hash", r.state_hash}});
  return array.dump(1) + "\n";
}

std::string batch_head() {
  return fmt::format("{:>6} {:>6} {:<8} {:<6} {:>2} | {:>7} | {:>13} | {:>13} | {:>13}  {}\n", "hex", "bodies", "mode",
                     "prec.", "th", "alone", "loops", "together", "independent", "state hash");
}

std::string batch_row(const BatchRecord& r) {
  const auto of = [](const BatchRate& rate) { return fmt::format("{:.0f} {:>4.2f}x", rate.per_core, rate.speed_up); };
  return fmt::format("{:>6} {:>6} {:<8} {:<6} {:>2} | {:>7.0f} | {:>13} | {:>13} | {:>13}  {}\n", r.size, r.bodies,
                     r.mode, r.precision, r.threads, r.alone.per_core, of(r.loops), of(r.together), of(r.independent),
                     r.state_hash);
}

}  // namespace hexaplast::bench
