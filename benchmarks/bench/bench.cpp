// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/bench.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include "base/simd.hpp"
#include "baselines/dense_peer.hpp"
#include "bench/bar.hpp"
#include "bench/stages.hpp"
#include "body_state.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/material/rows.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "mesh/lumped_mass.hpp"

namespace hexaplast::bench {

namespace {

using baselines::DensePeer;

constexpr double kOnePercent = 0.01, kTight = 1e-6, kReference = 1e-10;
constexpr double kNearlyNone = 1e-3;
constexpr double kFirstTolerance = 0.5, kLadder = 0.7;  // from one relative residual that is tried to the next
constexpr int kEnoughIterations = 5000;
constexpr int kWarmUpSteps = 3;

/// A linear solver and when it ends.
struct Solver {
  std::string name;    // as in Record
  std::string target;  // likewise
  int iterations;      // of cg
  double tolerance;    // relative residual, of the others; 0 for cg

  std::unique_ptr<LinearSolver> make() const {
    if (name == "cg")
      return std::make_unique<ConjugateGradients>(
          ConjugateGradientSettings{.iterations = iterations, .tolerance = 0, .threshold = 0});
    const Preconditioner preconditioner = name == "jacobi"      ? Preconditioner::kDiagonal
                                          : name == "multigrid" ? Preconditioner::kMultigrid
                                                                : Preconditioner::kAuto;
    return std::make_unique<PreconditionedConjugateGradients>(tolerance, kEnoughIterations, preconditioner);
  }
};

constexpr double kPoissonRatio = 0.45, kNearlyIncompressible = 0.49;

constexpr const char* kOnePercentTarget = "1 %";
constexpr const char* kTightTarget = "1e-6";
constexpr const char* kContactTarget = "residual 1 %";
constexpr double kContactTolerance = 0.01;

/// Bytes that the program has allocated and not returned.
double bytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// The dense peer on the same bar, timed again and again in between; the fastest counts.
class Peer {
 public:
  explicit Peer(const Body& body)
      : masses_(1000 * nodal_volumes(body.mesh().positions(), body.mesh().hexahedra())),
        peer_(body.mesh(), body.state().model.lame, masses_, clamped(body.mesh())),
        x_(body.mesh().positions()),
        v_(PointArray::Zero(x_.rows(), 3)),
        num_elements_(body.mesh().num_elements()) {}

  void time() {
    // short runs, so that a busy machine leaves some of them alone
    const int repetitions = std::clamp(20000 / num_elements_, 1, 8);
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      few_ms_ = std::min(few_ms_, step_ms(kFew));
      many_ms_ = std::min(many_ms_, step_ms(kMany));
    }
  }

  /// [ms] of a step with that many iterations.
  double ms(double iterations) const { return few_ms_ + (many_ms_ - few_ms_) * (iterations - kFew) / (kMany - kFew); }

  /// Iterations that its plain conjugate gradients need from the place of `bar`: to a velocity increment within one per
  /// cent, and to a relative residual of 1e-6.
  void count_iterations(const Bar& bar) {
    const auto solve = [&](const DensePeer::Stop& stop, PointArray& dv) {
      PointArray x = bar.positions(), v = bar.velocities();
      return peer_.step(Bar::gravity(), kBarDt, stop, x, v, dv).iterations;
    };
    PointArray exact(x_.rows(), 3), dv(x_.rows(), 3);
    solve({.iterations = kEnoughIterations, .tolerance = kReference}, exact);
    one_percent_ =
        solve({.iterations = kEnoughIterations,
               .tolerance = 0,
               .is_enough = [&](ConstPoints found) { return relative_error(masses_, found, exact) <= kOnePercent; }},
              dv);
    tight_ = solve({.iterations = kEnoughIterations, .tolerance = kTight}, dv);
  }

  /// [ms] of a step that is asked for the same as `solver` is.
  double ms(const Solver& solver) const {
    return ms(solver.name == "cg" ? solver.iterations : solver.target == kOnePercentTarget ? one_percent_ : tight_);
  }

 private:
  static constexpr int kFew = 5, kMany = 15;

  static std::vector<int> clamped(const HexMesh& mesh) {
    std::vector<int> nodes;
    const double min = mesh.positions().col(2).minCoeff();
    for (int n = 0; n < mesh.num_nodes(); ++n)
      if (mesh.positions()(n, 2) == min) nodes.push_back(n);
    return nodes;
  }

  double step_ms(int iterations) {
    PointArray x = x_, v = v_, dv(x_.rows(), 3);
    const auto begin = std::chrono::steady_clock::now();
    peer_.step(Bar::gravity(), kBarDt, {.iterations = iterations}, x, v, dv);
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  }

  Eigen::VectorXd masses_;
  DensePeer peer_;
  PointArray x_, v_;
  int num_elements_;
  int one_percent_ = 0, tight_ = 0;
  double few_ms_ = std::numeric_limits<double>::infinity(), many_ms_ = few_ms_;
};

/// All that is measured in one size.
class SizeRun {
 public:
  SizeRun(int size, const Options& options) : options_(options), size_(size) {
    set_num_threads(1);
    const Bar elastic = warmed_up({.size = size_});
    peer_.emplace(elastic.body());
    peer_->count_iterations(elastic);
  }

  Outcome measure() {
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      if (options_.flow) {
        measure_flow(precision);
        continue;
      }
      const std::vector<Solver> solvers = solvers_for(precision);
      for (const Mode mode : {Mode::kElastic, Mode::kPlasticIdle, Mode::kPlastic}) {
        peer_->time();
        measure_group({.size = size_, .mode = mode, .precision = precision}, solvers);
      }
    }
    if (!options_.flow) {
      measure_paper();
      measure_near_incompressibility();
      measure_contact();
    }
    peer_->time();
    for (std::size_t k = 0; k < outcome_.records.size(); ++k) {
      Record& record = outcome_.records[k];
      if (record.poisson_ratio == kPoissonRatio &&
          record.target != kContactTarget)  // where its iterations were counted
        record.ratio_to_dense_peer = peer_->ms(solver_of_[k]) * record.hex_per_ms / record.size;
    }
    for (std::string& failure : differing_hashes(outcome_.records)) outcome_.failures.push_back(std::move(failure));
    return std::move(outcome_);
  }

 private:
  /// A bar, the solver that steps it, and what both take.
  class Run {
   public:
    Run(const BarSettings& settings, Solver solver, double bytes_before)
        : settings_(settings), solver_(std::move(solver)), bar_(settings), method_(solver_.make()) {
      for (int step = 0; step < kWarmUpSteps; ++step) bar_.step(*method_);
      bytes_ = bytes_in_use() - bytes_before;
    }

    void step() {
      last_ = bar_.step(*method_);
      ms_.push_back(last_.ms);
      iterations_ += last_.solve.iterations;
    }

    Bar& bar() { return bar_; }

    Record record() {
      const StepTimes times(ms_);
      Record record;
      record.size = bar_.num_elements();
      record.shape = settings_.is_pressed ? "box on a plate" : "box";
      record.element = element_name(settings_.element);
      record.poisson_ratio = settings_.poisson_ratio;
      record.mode = name(settings_.mode);
      record.precision = settings_.precision == Precision::kDouble ? "double" : "mixed";
      record.solver = solver_.name;
      record.target = solver_.target;
      record.threads = num_threads();
      record.simd = simd_target();
      record.processor = processor_name();
      record.iterations = static_cast<double>(iterations_) / static_cast<double>(ms_.size());
      record.tolerance = solver_.tolerance;
      record.hex_per_ms = record.size / times.min;
      record.p50_ms = times.p50;
      record.p99_ms = times.p99;
      record.bytes_per_hex = bytes_ / record.size;
      record.residual = last_.solve.residual;
      record.yielded = static_cast<double>(last_.flow.yielded) / record.size;
      record.state_hash = bar_.hash();
      if (solver_.target == kOnePercentTarget) record.velocity_error = velocity_error();
      return record;
    }

   private:
    /// Of the next step, against a solve to 1e-10, which mixed precision reaches by corrections in double.
    double velocity_error() {
      PreconditionedConjugateGradients reference(kReference, kEnoughIterations, Preconditioner::kMultigrid);
      const PointArray exact = bar_.increment(reference);
      return relative_error(bar_.masses(), bar_.increment(*method_), exact);
    }

    BarSettings settings_;
    Solver solver_;
    Bar bar_;
    std::unique_ptr<LinearSolver> method_;
    double bytes_ = 0;
    std::vector<double> ms_;
    long iterations_ = 0;
    Bar::Step last_;
  };

  static Bar warmed_up(const BarSettings& settings) {
    Bar bar(settings);
    PreconditionedConjugateGradients solver(kTight, kEnoughIterations);
    for (int step = 0; step < kWarmUpSteps; ++step) bar.step(solver);
    return bar;
  }

  /// What a busy machine takes from a step it takes from all bars alike: they are stepped in turn.
  void measure_flow(Precision precision) {
    constexpr int kSteps = 20;  // later, what flows has folded where the bar is held
    std::vector<BarSettings> bars;
    for (const Mode mode : {Mode::kElastic, Mode::kPlasticPart, Mode::kPlastic})
      bars.push_back({.size = size_, .mode = mode, .precision = precision, .element = {}});
    bars.push_back({.size = size_, .precision = precision, .element = {.relaxation = {0.5, 0.1}}});
    std::vector<Solver> solvers;
    for (const BarSettings& bar : bars)
      solvers.push_back({"multigrid", kOnePercentTarget, 0, tolerance_for_one_percent("multigrid", bar)});
    for (const int threads : options_.threads) {
      set_num_threads(threads);
      peer_->time();
      std::vector<std::unique_ptr<Run>> runs(bars.size());
      std::vector<Record> records(bars.size());
      bool is_one_percent = false;
      while (!is_one_percent) {
        for (std::size_t k = 0; k < bars.size(); ++k) {
          runs[k].reset();
          runs[k] = std::make_unique<Run>(bars[k], solvers[k], bytes_in_use());
        }
        for (int step = 0; step < kSteps; ++step)
          for (const std::unique_ptr<Run>& run : runs) run->step();
        is_one_percent = true;
        for (std::size_t k = 0; k < bars.size(); ++k) {
          records[k] = runs[k]->record();
          if (records[k].velocity_error <= kOnePercent || solvers[k].tolerance <= kTight) continue;
          solvers[k].tolerance *= kLadder;
          is_one_percent = false;
        }
      }
      for (std::size_t k = 0; k < bars.size(); ++k)
        add(std::move(records[k]), bars[k], solvers[k], measure_stages(runs[k]->bar(), repetitions()));
    }
  }

  /// The paper's element and its joined rest shapes, by the plain implementation.
  void measure_paper() {
    peer_->time();
    for (const Mode mode : {Mode::kElastic, Mode::kPlastic})
      measure_group({.size = size_, .mode = mode, .element = published_element()}, {{"cg", "25 its", 25, 0}});
  }

  /// Bars that flow, free and on a plate, with one solver.
  void measure_contact() {
    for (const bool is_pressed : {false, true})
      measure_group({.size = size_, .mode = Mode::kPlastic, .precision = Precision::kMixed, .is_pressed = is_pressed},
                    {{"multigrid", kContactTarget, 0, kContactTolerance}});
  }

  void measure_near_incompressibility() {
    measure_group(
        {.size = size_, .precision = Precision::kMixed, .poisson_ratio = kNearlyIncompressible},
        {{"jacobi", kOnePercentTarget, 0, kFirstTolerance}, {"multigrid", kOnePercentTarget, 0, kFirstTolerance}});
  }

  std::vector<Solver> solvers_for(Precision precision) {
    std::vector<Solver> solvers;
    for (const int iterations : options_.quick ? std::vector<int>{25} : std::vector<int>{10, 25, 100})
      solvers.push_back({"cg", fmt::format("{} its", iterations), iterations, 0});
    const std::vector<std::string> names =
        options_.quick ? std::vector<std::string>{"auto"} : std::vector<std::string>{"jacobi", "multigrid", "auto"};
    for (const std::string& name : names) {
      solvers.push_back(
          {name, kOnePercentTarget, 0, tolerance_for_one_percent(name, {.size = size_, .precision = precision})});
      if (!options_.quick) solvers.push_back({name, kTightTarget, 0, kTight});
    }
    return solvers;
  }

  /// The largest relative residual, of a ladder, with which a velocity increment of a bar after its first steps is
  /// within three quarters of one per cent of the one to 1e-10. A cell whose body is elsewhere and needs a smaller one
  /// goes on from here.
  static double tolerance_for_one_percent(const std::string& solver, const BarSettings& settings) {
    Bar bar = warmed_up(settings);
    PreconditionedConjugateGradients reference(kReference, kEnoughIterations, Preconditioner::kMultigrid);
    const PointArray exact = bar.increment(reference);
    double tolerance = kFirstTolerance;
    while (tolerance > kTight) {
      const auto tested = Solver{solver, kOnePercentTarget, 0, tolerance}.make();
      if (relative_error(bar.masses(), bar.increment(*tested), exact) <= 0.75 * kOnePercent) break;
      tolerance *= kLadder;
    }
    return tolerance;
  }

  void measure_group(const BarSettings& bar, const std::vector<Solver>& solvers) {
    for (const int threads : options_.threads) {
      set_num_threads(threads);
      std::optional<Stages> stages;
      for (const Solver& solver : solvers) {
        Solver asked = solver;
        Record record = measure_steps(bar, asked, stages);
        while (record.velocity_error > kOnePercent && asked.tolerance > kTight) {
          asked.tolerance *= kLadder;
          record = measure_steps(bar, asked, stages);
        }
        add(std::move(record), bar, solver, *stages);
      }
    }
  }

  void add(Record record, const BarSettings& bar, const Solver& solver, const Stages& stages) {
    check(record, bar.mode);
    record.linearize_ns = stages.linearize_ns;
    record.operator_ns = stages.operator_ns;
    record.vectors_ns = stages.vectors_ns;
    record.flow_ns = stages.flow_ns;
    outcome_.records.push_back(std::move(record));
    solver_of_.push_back(solver);
  }

  int repetitions() const { return options_.quick ? 3 : 7; }

  /// The stages are measured where the first solver of a group has led its bar.
  Record measure_steps(const BarSettings& bar, const Solver& solver, std::optional<Stages>& stages) {
    Run run(bar, solver, bytes_in_use());
    // so many that the fastest is a quiet one; the same for any number of threads
    const double work = run.bar().num_elements() * (solver.name == "cg" ? solver.iterations : 40.0);
    const int num_steps = static_cast<int>(std::clamp((options_.quick ? 2e6 : 1e7) / work, 5.0, 100.0));
    for (int step = 0; step < num_steps; ++step) run.step();
    Record record = run.record();
    if (!stages) stages = measure_stages(run.bar(), repetitions());
    return record;
  }

  void check(const Record& record, Mode mode) {
    const auto fail = [&](const std::string& what) {
      outcome_.failures.push_back(fmt::format("{} hexahedra, {}, {}, {} {} {}, {} threads: {}", record.size,
                                              record.element, record.mode, record.precision, record.solver,
                                              record.target, record.threads, what));
    };
    if (record.tolerance > 0 && !(record.residual <= record.tolerance))
      fail(fmt::format("relative residual {:.2e}, must be {:.2e}", record.residual, record.tolerance));
    if (record.velocity_error > kOnePercent)
      fail(fmt::format("the velocity increment is {:.2f} % off, must be 1 %", 100 * record.velocity_error));
    // far from converged, a hexahedron of ten thousand may be between two loads
    const double expected = mode == Mode::kPlastic ? 1 : mode == Mode::kPlasticPart ? kYieldingPart : 0;
    if (std::abs(record.yielded - expected) >
        (mode == Mode::kPlasticPart ? kYieldingPart / 10 : kNearlyNone * expected))
      fail(fmt::format("{:.2f} % of the hexahedra yield", 100 * record.yielded));
  }

  const Options& options_;
  int size_;
  std::optional<Peer> peer_;
  Outcome outcome_;
  std::vector<Solver> solver_of_;  // per record
};

}  // namespace

StepTimes::StepTimes(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  min = ms.front();
  p50 = ms[(ms.size() - 1) / 2];
  p99 = ms[static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(ms.size()))) - 1];
}

std::string element_name(const Settings& settings) {
  const auto word = [&](const char* member) {
    const Row<Settings>& row = *find_row(settings_rows(), member, Names::kMembers);
    return row.words[static_cast<std::size_t>(row.at.get(settings))];
  };
  return fmt::format("{} {}{}", word("bending"), word("volumetric"), settings.num_branches() > 0 ? " relaxing" : "");
}

double time_peer(const Body& body, double iterations) {
  Peer peer(body);
  peer.time();
  return peer.ms(iterations);
}

Outcome run(const Options& options, const std::function<void(const std::vector<Record>&)>& on_size) {
  Outcome all;
  for (const int size : options.sizes) {
    Outcome one = SizeRun(size, options).measure();
    on_size(one.records);
    std::move(one.records.begin(), one.records.end(), std::back_inserter(all.records));
    std::move(one.failures.begin(), one.failures.end(), std::back_inserter(all.failures));
  }
  return all;
}

}  // namespace hexaplast::bench
