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
#include "mesh/lumped_mass.hpp"

namespace hexaplast::bench {

namespace {

using baselines::DensePeer;

constexpr double kOnePercent = 0.01, kTight = 1e-6, kReference = 1e-10;
constexpr double kNearlyAll = 0.999;
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
  SizeRun(int size, const Options& options, const MachineLimits& limits)
      : options_(options), limits_(limits), size_(size), elastic_(settings(Mode::kElastic, Precision::kDouble)) {
    set_num_threads(1);
    peer_.emplace(elastic_.body());
    PreconditionedConjugateGradients solver(kTight, kEnoughIterations);
    for (int step = 0; step < kWarmUpSteps; ++step) elastic_.step(solver);
    peer_->count_iterations(elastic_);
  }

  Outcome measure() {
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      const std::vector<Solver> solvers = solvers_for(precision);
      for (const Mode mode : {Mode::kElastic, Mode::kPlasticIdle, Mode::kPlastic}) {
        peer_->time();
        for (const int threads : options_.threads) measure_group(mode, precision, threads, solvers);
      }
    }
    measure_forms();
    measure_contact();
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
  BarSettings settings(Mode mode, Precision precision) const {
    return {size_, mode, precision, poisson_ratio_, element_, is_pressed_};
  }

  /// The default element that flows, free and on a plate, with one solver.
  void measure_contact() {
    element_ = {};
    poisson_ratio_ = kPoissonRatio;
    for (const bool is_pressed : {false, true}) {
      is_pressed_ = is_pressed;
      for (const int threads : options_.threads)
        measure_group(Mode::kPlastic, Precision::kMixed, threads,
                      {{"multigrid", kContactTarget, 0, kContactTolerance}});
    }
    is_pressed_ = false;
  }

  /// The default element and a faster one, elastic, in mixed precision: as many iterations as the published one, and to
  /// one per cent near incompressibility, where that locks.
  void measure_forms() {
    const Settings forms[] = {{}, {.bending = Bending::kBlended}};
    peer_->time();
    for (const Settings& form : forms) {
      element_ = form;
      for (const int threads : options_.threads)
        measure_group(Mode::kElastic, Precision::kMixed, threads, {{"cg", "25 its", 25, 0}});
    }
    poisson_ratio_ = kNearlyIncompressible;
    for (const Settings& form : {published_element(), forms[0], forms[1]}) {
      element_ = form;
      for (const int threads : options_.threads)
        for (const char* solver : {"jacobi", "multigrid"})
          measure_group(Mode::kElastic, Precision::kMixed, threads, {{solver, kOnePercentTarget, 0, kFirstTolerance}});
    }
  }

  std::vector<Solver> solvers_for(Precision precision) {
    std::vector<Solver> solvers;
    for (const int iterations : options_.quick ? std::vector<int>{25} : std::vector<int>{10, 25, 100})
      solvers.push_back({"cg", fmt::format("{} its", iterations), iterations, 0});
    const std::vector<std::string> names =
        options_.quick ? std::vector<std::string>{"auto"} : std::vector<std::string>{"jacobi", "multigrid", "auto"};
    for (const std::string& name : names) {
      solvers.push_back({name, kOnePercentTarget, 0, tolerance_for_one_percent(name, precision)});
      if (!options_.quick) solvers.push_back({name, kTightTarget, 0, kTight});
    }
    return solvers;
  }

  /// The largest relative residual, of a ladder, with which a velocity increment of the elastic body is within three
  /// quarters of one per cent of the one to 1e-10 in double precision. A cell whose body is elsewhere and needs a
  /// smaller one goes on from here.
  double tolerance_for_one_percent(const std::string& solver, Precision precision) {
    if (exact_.size() == 0) {
      PreconditionedConjugateGradients reference(kReference, kEnoughIterations, Preconditioner::kMultigrid);
      exact_ = elastic_.increment(reference);
    }
    Bar bar(settings(Mode::kElastic, precision));
    bar.place(elastic_.positions(), elastic_.velocities());
    double tolerance = kFirstTolerance;
    while (tolerance > kTight) {
      const auto tested = Solver{solver, kOnePercentTarget, 0, tolerance}.make();
      if (relative_error(bar.masses(), bar.increment(*tested), exact_) <= 0.75 * kOnePercent) break;
      tolerance *= kLadder;
    }
    return tolerance;
  }

  void measure_group(Mode mode, Precision precision, int threads, const std::vector<Solver>& solvers) {
    set_num_threads(threads);
    std::optional<Stages> stages;
    for (const Solver& solver : solvers) {
      Solver asked = solver;
      Record record = measure_steps(mode, precision, threads, asked, stages);
      while (record.velocity_error > kOnePercent && asked.tolerance > kTight) {
        asked.tolerance *= kLadder;
        record = measure_steps(mode, precision, threads, asked, stages);
      }
      check(record, mode);
      const double operator_seconds = 1e-9 * stages->operator_ns;
      record.linearize_ns = stages->linearize_ns;
      record.operator_ns = stages->operator_ns;
      record.vectors_ns = stages->vectors_ns;
      record.flow_ns = stages->flow_ns;
      record.averaging_ns = stages->averaging_ns;
      record.operator_gflops = 1e-9 * stages->operator_flops / operator_seconds;
      record.operator_gbs = 1e-9 * stages->operator_bytes / operator_seconds;
      record.peak_gflops = limits_.peak_gflops(precision, threads);
      record.read_gbs = limits_.read_gbs(stages->operator_footprint, threads);
      outcome_.records.push_back(std::move(record));
      solver_of_.push_back(solver);
    }
  }

  /// The stages are measured where the first solver of a group has led its bar.
  Record measure_steps(Mode mode, Precision precision, int threads, const Solver& solver,
                       std::optional<Stages>& stages) {
    const double bytes_before = bytes_in_use();
    Bar bar(settings(mode, precision));
    const std::unique_ptr<LinearSolver> method = solver.make();
    for (int step = 0; step < kWarmUpSteps; ++step) bar.step(*method);
    const double bytes = bytes_in_use() - bytes_before;

    // so many that the fastest is a quiet one; the same for any number of threads
    const double work = bar.num_elements() * (solver.name == "cg" ? solver.iterations : 40.0);
    const int num_steps = static_cast<int>(std::clamp((options_.quick ? 2e6 : 1e7) / work, 5.0, 100.0));
    std::vector<double> ms;
    long iterations = 0;
    Bar::Step last;
    for (int step = 0; step < num_steps; ++step) {
      last = bar.step(*method);
      ms.push_back(last.ms);
      iterations += last.solve.iterations;
    }

    const StepTimes times(std::move(ms));
    Record record;
    record.size = bar.num_elements();
    record.shape = is_pressed_ ? "box on a plate" : "box";
    record.element = element_name(element_);
    record.poisson_ratio = poisson_ratio_;
    record.mode = name(mode);
    record.precision = precision == Precision::kDouble ? "double" : "mixed";
    record.solver = solver.name;
    record.target = solver.target;
    record.threads = threads;
    record.simd = simd_target();
    record.processor = MachineLimits::processor();
    record.iterations = static_cast<double>(iterations) / num_steps;
    record.tolerance = solver.tolerance;
    record.hex_per_ms = record.size / times.min;
    record.p50_ms = times.p50;
    record.p99_ms = times.p99;
    record.bytes_per_hex = bytes / record.size;
    record.residual = last.solve.residual;
    record.yielded = static_cast<double>(last.flow.yielded) / record.size;
    record.state_hash = bar.hash();
    if (solver.target == kOnePercentTarget) record.velocity_error = velocity_error(bar, *method);
    if (!stages) stages = measure_stages(bar, options_.quick ? 3 : 7);
    return record;
  }

  /// Of the next step, against a solve to 1e-10, which mixed precision reaches by corrections in double.
  static double velocity_error(Bar& bar, LinearSolver& solver) {
    PreconditionedConjugateGradients reference(kReference, kEnoughIterations, Preconditioner::kMultigrid);
    const PointArray exact = bar.increment(reference);
    return relative_error(bar.masses(), bar.increment(solver), exact);
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
    if (mode == Mode::kPlastic ? record.yielded < kNearlyAll : record.yielded > 0)
      fail(fmt::format("{:.2f} % of the hexahedra yield", 100 * record.yielded));
  }

  const Options& options_;
  const MachineLimits& limits_;
  int size_;
  Settings element_ = published_element();
  double poisson_ratio_ = kPoissonRatio;
  bool is_pressed_ = false;
  Bar elastic_;  // a few steps on its way; the reference of the others
  std::optional<Peer> peer_;
  PointArray exact_;  // [m/s] its next velocity increment
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
  return fmt::format("{} {}", word("bending"), word("volumetric"));
}

double time_peer(const Body& body, double iterations) {
  Peer peer(body);
  peer.time();
  return peer.ms(iterations);
}

std::vector<std::string> differing_hashes(const std::vector<Record>& records) {
  std::vector<std::string> differing;
  for (std::size_t a = 0; a < records.size(); ++a)
    for (std::size_t b = a + 1; b < records.size(); ++b) {
      const Record &one = records[a], &other = records[b];
      if (one.size != other.size || one.shape != other.shape || one.element != other.element ||
          one.poisson_ratio != other.poisson_ratio || one.mode != other.mode || one.precision != other.precision ||
          one.solver != other.solver || one.target != other.target || one.state_hash == other.state_hash)
        continue;
      differing.push_back(fmt::format("{} hexahedra, {}, {} {} {}: state {} with {} threads, {} with {}", one.size,
                                      one.mode, one.precision, one.solver, one.target, one.state_hash, one.threads,
                                      other.state_hash, other.threads));
    }
  return differing;
}

Outcome run(const Options& options, const MachineLimits& limits,
            const std::function<void(const std::vector<Record>&)>& on_size) {
  Outcome all;
  for (const int size : options.sizes) {
    Outcome one = SizeRun(size, options, limits).measure();
    on_size(one.records);
    std::move(one.records.begin(), one.records.end(), std::back_inserter(all.records));
    std::move(one.failures.begin(), one.failures.end(), std::back_inserter(all.failures));
  }
  return all;
}

}  // namespace hexaplast::bench
