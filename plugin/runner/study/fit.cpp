// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <thread>

#include "formats/text.hpp"
#include "hexaplast/base/parallel.hpp"
#include "record/files.hpp"
#include "runner/exit_code.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/directory_lock.hpp"
#include "runner/run/interrupt.hpp"
#include "runner/run/progress.hpp"
#include "runner/run/scene_record.hpp"
#include "runner/standard_output.hpp"
#include "runner/study/evaluations.hpp"
#include "runner/study/experiments.hpp"
#include "runner/study/factor.hpp"
#include "runner/study/fit_result.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

constexpr int kMaxWeightings = 3;           // searches with weights from the noise of the one before
constexpr double kMinNoise = 1e-3;          // of the noisiest column: one that has less weighs no more
constexpr double kSameNoise = 1.3;          // factor between columns up to which weights change nothing worthwhile
constexpr double kNoNoiseToWeighBy = 1e-6;  // of the largest value

/// An experiment as the command line gives it.
struct Planned {
  SceneOptions scene;
  std::filesystem::path target;
  std::vector<std::string> compare;
  std::vector<std::string> own = {};  ///< PATH.attribute=VALUE for this one alone
};

std::vector<Planned> planned(const FitOptions& options) {
  std::vector<Planned> all = {{options.scene, options.target, options.compare}};
  for (const std::vector<std::string>& words : options.experiments) {
    if (words.size() < 2)
      throw UsageError(fmt::format("--experiment {}: must be SCENE CURVE.csv [COLUMN,...] [PATH.attribute=VALUE ...]",
                                   fmt::join(words, " ")));
    Planned one{options.scene, words[1], {}};
    one.scene.file = words[0];
    for (std::size_t k = 2; k < words.size(); ++k) {
      if (words[k].find('=') != std::string::npos)
        one.own.push_back(words[k]);
      else
        for (const std::string_view column : split(words[k], ',')) one.compare.emplace_back(column);
    }
    one.scene.overrides.insert(one.scene.overrides.end(), one.own.begin(), one.own.end());
    all.push_back(std::move(one));
  }
  return all;
}

/// The free attributes, which every scene must have; they begin with the value of the first.
std::vector<FreeAttribute> read_free(const std::vector<std::string>& texts, const std::vector<Planned>& experiments,
                                     std::vector<std::string>& scene_hashes) {
  std::vector<FreeAttribute> free;
  for (const Planned& experiment : experiments) try {
      scene::Scene scene = read_scene(experiment.scene);
      scene.diagnostics().throw_errors();
      scene_hashes.push_back(hash_scene(scene));
      for (const std::string& text : texts) {
        FreeAttribute one = parse_free(text, scene);
        for (const std::string& own : experiment.own)
          if (own.starts_with(one.name + "="))
            throw UsageError(
                fmt::format("--experiment {} {}: {}: must not be a free attribute, which has the same value "
                            "in all experiments",
                            experiment.scene.file.string(), experiment.target.string(), own));
        if (scene_hashes.size() > 1) continue;
        if (std::ranges::find(free, one.name, &FreeAttribute::name) != free.end())
          throw UsageError(fmt::format("--free {}: this attribute is free already", text));
        free.push_back(std::move(one));
      }
    } catch (const scene::OverrideError& error) {
      if (experiments.size() == 1) throw;
      throw scene::OverrideError(fmt::format("{} (of the scene {})", error.what(), experiment.scene.file.string()));
    }
  return free;
}

// Warnings of a scene are the same in every run: those of the first one are enough.
class QuietRuns {
 public:
  QuietRuns() { sink().set_level(spdlog::level::err); }
  ~QuietRuns() { sink().set_level(level_); }
  QuietRuns(const QuietRuns&) = delete;
  QuietRuns& operator=(const QuietRuns&) = delete;

 private:
  static spdlog::sinks::sink& sink() { return *spdlog::default_logger()->sinks().front(); }
  spdlog::level::level_enum level_ = sink().level();
};

using Weights = std::vector<double>;  // per column

/// Residuals of the columns, each times its weight.
std::vector<double> weighted(std::vector<double> residuals, const std::vector<ComparedColumn>& columns,
                             const Weights& weights) {
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t row = 0; row < columns[c].num_rows; ++row) residuals[columns[c].begin + row] *= weights[c];
  return residuals;
}

/// The inverse of deviations, as far as they are worth telling apart.
Weights inverse(const std::vector<double>& deviations) {
  const double max = std::ranges::max(deviations);
  Weights weights;
  for (const double deviation : deviations)
    weights.push_back(max > kNoNoiseToWeighBy ? max / std::max(deviation, kMinNoise * max) : 1);
  return weights;
}

/// By the noise that curves show by themselves: how far rows lie from the middle of their neighbours, in the median. A
/// search that begins with them does not follow the noise of one column away from what another one tells.
Weights first_weights(const std::vector<ComparedColumn>& columns) {
  std::vector<double> deviations;
  for (const ComparedColumn& compared : columns) {
    const std::vector<double>& values = compared.column->values;
    std::vector<double> bends = {0};
    for (std::size_t row = 1; row + 1 < values.size(); ++row)
      bends.push_back(std::abs(values[row] - (values[row - 1] + values[row + 1]) / 2));
    std::ranges::nth_element(bends, bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2));
    deviations.push_back(bends[bends.size() / 2] / compared.greatest);
  }
  return inverse(deviations);
}

/// By the noise that a fit with the weights `now` has left; none where they would be much the same.
std::optional<Weights> weights_by(const std::vector<CurveNoise>& noise, const Weights& now) {
  std::vector<double> deviations;
  for (std::size_t c = 0; c < noise.size(); ++c) deviations.push_back(noise[c].deviation / now[c]);
  const Weights weights = inverse(deviations);
  double change = 1;
  for (std::size_t c = 0; c < noise.size(); ++c) {
    const double factor = weights[c] / now[c] / (weights[0] / now[0]);
    change = std::max({change, factor, 1 / factor});
  }
  if (change < kSameNoise) return {};
  return weights;
}

/// The search for the best point, and what is known of it.
class FitSearch {
 public:
  FitSearch(const Experiments& experiments, const std::vector<FreeAttribute>& free, const FitOptions& options,
            Evaluations& evaluations)
      : experiments_(experiments),
        free_(free),
        options_(options),
        evaluations_(evaluations),
        weights_(first_weights(experiments.columns())) {}

  FitResult carry_out() {
    Point start;
    for (const FreeAttribute& one : free_) start.push_back(one.start());
    FitResult result;
    result.start = evaluations_.first(start);  // what is wrong with it is wrong with the scene

    const QuietRuns quiet;
    result.calibration = find_best(start, true, options_.evaluations);
    Eigen::MatrixXd slopes = find_slopes(result.calibration);
    for (int round = 0; round < kMaxWeightings && weights_.size() > 1; ++round) {
      const Confidence confidence = confidence_in(result.calibration, slopes);
      const int left = options_.evaluations - result.calibration.num_evaluations;
      const std::optional<Weights> weights =
          confidence.has_noise ? weights_by(confidence.noise, weights_) : std::nullopt;
      if (!weights || left < 1) break;
      weights_ = *weights;
      Calibration again = find_best(result.calibration.best, false, left);
      again.num_evaluations += result.calibration.num_evaluations;
      again.num_failed += result.calibration.num_failed;
      result.calibration = std::move(again);
      slopes = find_slopes(result.calibration);
    }
    progress_.clear();
    tell(result, slopes);
    return result;
  }

 private:
  Residuals residuals() {
    return [this](const std::vector<Point>& points) {
      std::vector<std::optional<std::vector<double>>> found = evaluations_.at(points);
      for (std::optional<std::vector<double>>& values : found)
        if (values) values = weighted(experiments_.residuals(*values), experiments_.columns(), weights_);
      return found;
    };
  }

  Calibration find_best(const Point& start, bool looks_around, int max_evaluations) {
    const int before = num_evaluations_;
    return calibrate(residuals(), start, {.max_evaluations = max_evaluations, .looks_around = looks_around},
                     [&](int done, double rms) {
                       num_evaluations_ = before + done;
                       progress_.show(num_evaluations_, fmt::format("residual {:.4f} %", 100 * rms));
                     });
  }
  Eigen::MatrixXd find_slopes(const Calibration& calibration) {
    return slopes_at(residuals(), calibration.best, calibration.residuals);
  }

  Confidence confidence_in(const Calibration& calibration, const Eigen::MatrixXd& slopes) const {
    std::vector<Eigen::Index> estimated;
    for (std::size_t p = 0; p < free_.size(); ++p)
      if (!is_limit(calibration.best[p])) estimated.push_back(static_cast<Eigen::Index>(p));
    std::vector<Eigen::Index> num_rows;
    for (const ComparedColumn& compared : experiments_.columns())
      num_rows.push_back(static_cast<Eigen::Index>(compared.num_rows));
    const std::vector<double>& r = calibration.residuals;
    return confidence_of(slopes, Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size())),
                         num_rows, estimated, kHardlyKnown);
  }

  /// What has been found of the parameters and the columns.
  void tell(FitResult& result, const Eigen::MatrixXd& slopes) {
    const std::vector<ComparedColumn>& columns = experiments_.columns();
    const Point& best = result.calibration.best;
    result.confidence = confidence_in(result.calibration, slopes);
    Eigen::MatrixXd unweighted = slopes;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      unweighted.middleRows(static_cast<Eigen::Index>(columns[c].begin),
                            static_cast<Eigen::Index>(columns[c].num_rows)) /= weights_[c];
      result.confidence.noise[c].deviation *= columns[c].greatest / weights_[c];
    }
    const std::vector<Uncertainty> uncertainty = uncertainties(unweighted, kCloseness);
    for (std::size_t p = 0; p < free_.size(); ++p)
      result.found.push_back({.free = free_[p],
                              .value = std::stod(written(free_[p].value(best[p]))),
                              .uncertainty = uncertainty[p],
                              .half_width = result.confidence.half_width[p]});

    result.fitted = evaluations_.first(best);
    const std::vector<double> differences = experiments_.residuals(result.fitted);
    double sum = 0;
    for (const ComparedColumn& compared : columns) {
      double of_column = 0;
      for (std::size_t row = 0; row < compared.num_rows; ++row) {
        const double difference = differences[compared.begin + row];
        of_column += difference * difference;
      }
      result.rms.push_back(compared.greatest * std::sqrt(of_column / static_cast<double>(compared.num_rows)));
      sum += of_column;
    }
    result.relative_rms = std::sqrt(sum / static_cast<double>(differences.size()));
  }

  const Experiments& experiments_;
  const std::vector<FreeAttribute>& free_;
  const FitOptions& options_;
  Evaluations& evaluations_;
  Weights weights_;
  Progress progress_{options_.evaluations, true};
  int num_evaluations_ = 0;
};

/// What a fit writes, opened before the first evaluation, so that a long one does not end in a file that cannot be
/// written.
struct FitFiles {
  FitFiles(const std::filesystem::path& directory, std::span<const Experiment> experiments)
      : lock(directory),
        json(place(directory, "fit.json", experiments)),
        svg(place(directory, "fit.svg", experiments)) {}
  DirectoryLock lock;
  output::WholeFile json, svg;

 private:
  /// Refused where it is an input of any experiment.
  static std::filesystem::path place(const std::filesystem::path& directory, const char* name,
                                     std::span<const Experiment> experiments) {
    std::filesystem::path found;
    for (const Experiment& one : experiments) found = output_place(directory / name, one.inputs(), {directory});
    return found;
  }
};

/// The directory is there, and holds no earlier fit that must stay.
void prepare_place(const std::filesystem::path& directory, bool force) {
  output::make_directory(directory);
  for (const char* name : {"fit.json", "fit.svg"})
    if (std::filesystem::exists(directory / name) && !force)
      throw output::OutputError(
          fmt::format("{}: holds an earlier fit ({}); --force replaces it", directory.string(), name));
}

/// How many runs at a time, and threads of each.
struct Split {
  int jobs, threads;
};

Split split_of(const FitOptions& options) {
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Split split{.jobs = options.jobs, .threads = options.threads.value_or(1)};
  if (split.jobs == 0) split.jobs = std::max(1, processors / split.threads);
  split.jobs = std::min(split.jobs, largest_batch(options.free.size()));
  if (!options.threads) split.threads = std::max(1, processors / split.jobs);
  return split;
}

}  // namespace

CLI::App* add_fit(CLI::App& app, FitOptions& options) {
  CLI::App* command =
      app.add_subcommand("fit", "Find the attribute values with which a scene repeats a measured curve");
  command
      ->add_option("--target", options.target,
                   "CSV with columns time or force, and what is compared (docs/calibration.md)")
      ->type_name("CURVE.csv")
      ->required();
  command->add_option("--compare", options.compare, "Columns of it that are compared. Default: all")
      ->type_name("COLUMN,...")
      ->delimiter(',');
  command
      ->add_option("--experiment", options.experiments,
                   "A further scene and its curve, which the same values must repeat; then columns of the curve that "
                   "are compared (default: all), and attributes that are other ones here; may be repeated")
      ->type_name("SCENE CURVE.csv [COLUMN,...] [PATH.attribute=VALUE ...]");
  command
      ->add_option(
          "--free", options.free,
          "A number of every scene that is looked for between lo and hi, on a logarithmic scale where these span a "
          "decade or "
          "as told; may be repeated")
      ->type_name("PATH.attribute=lo:hi[:log|:linear]")
      ->allow_extra_args(false)
      ->required();
  command->add_option("--evaluations", options.evaluations, "Runs of the scene at most. Default 200")
      ->type_name("N")
      ->check(CLI::Range(2, 1'000'000));
  CLI::Option* out =
      command->add_option("--out", options.out, "Write fit.json and fit.svg into this directory")->type_name("DIR");
  command
      ->add_option(
          "--steps", options.steps,
          "Steps of the run that a curve over force is compared with; default: those of the scene's RunSettings")
      ->type_name("N")
      ->check(CLI::Range(1L, 1'000'000L));
  command->add_option("--jobs", options.jobs, "Runs at a time; otherwise as many as there are processors")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add_threads(*command, options.threads, "Threads of each run; results do not depend on it");
  command->add_flag("--force", options.force, "Write over an earlier fit")->needs(out);
  command->add_option("--asks", options.asks)->delimiter(',')->group("");  // for the Python module
  command->add_flag("--worker", options.is_worker)->group("");             // for processes that a fit starts itself
  return command;
}

int fit(const FitOptions& options) {
  watch_signals();
  const Split split = split_of(options);
  set_num_threads(split.threads);
  const std::vector<Planned> plan = planned(options);
  std::vector<std::string> scene_hashes;
  const std::vector<FreeAttribute> free = read_free(options.free, plan, scene_hashes);
  std::vector<TargetCurve> targets;
  for (const Planned& one : plan) targets.push_back(read_target(one.target, one.compare));
  if (options.out && !options.is_worker) prepare_place(*options.out, options.force);

  try {
    Point start;
    for (const FreeAttribute& one : free) start.push_back(one.start());
    const auto read_experiments = [&] {
      std::vector<Experiment> all;
      for (std::size_t k = 0; k < plan.size(); ++k)
        all.emplace_back(plan[k].scene, std::move(targets[k]), options.steps, assignments(free, start));
      return Experiments(std::move(all));
    };
    if (options.is_worker) {
      const QuietRuns quiet;
      const Experiments experiments = read_experiments();
      serve([&](const Point& point) { return evaluate(experiments, free, point); });
      return kOk;
    }
    const Experiments experiments = read_experiments();
    std::optional<FitFiles> files;
    if (options.out) files.emplace(*options.out, experiments.all());
    Evaluations evaluations = options.asks.empty() ? Evaluations(experiments, free, split.jobs, split.threads)
                                                   : Evaluations(experiments, free, options.asks);
    const FitResult result = FitSearch(experiments, free, options, evaluations).carry_out();
    const std::vector<std::string> warnings = warnings_of(result, experiments, options.evaluations);
    print(result, experiments);
    if (files) {
      write_json(files->json, result, experiments, scene_hashes, warnings);
      draw(files->svg, result, experiments);
    }
    flush_standard_output();
    for (const std::string& warning : warnings) spdlog::warn("warning: {}", warning);
    return kOk;
  } catch (const Interrupted&) {
    if (!options.is_worker) spdlog::warn("warning: ended by signal {}; nothing is written", requested_signal());
    return kSignalled + requested_signal();
  }
}

}  // namespace hexaplast::runner
