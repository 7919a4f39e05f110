// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/formats/text.hpp"
#include "page/history_panels.hpp"
#include "page/panel_grids.hpp"
#include "record/files.hpp"
#include "runner/exit_code.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/directory_lock.hpp"
#include "runner/run/interrupt.hpp"
#include "runner/run/progress.hpp"
#include "runner/run/scene_record.hpp"
#include "runner/standard_output.hpp"
#include "runner/study/calibration.hpp"
#include "runner/study/experiment.hpp"
#include "runner/study/free_attribute.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;
using Curves = std::vector<std::vector<double>>;  // per column of the target, per row

constexpr double kCloseness = 0.01;   // relative root mean square by which curves are told apart
constexpr double kHardlyKnown = 0.5;  // of the way between the limits: a value that may move so far is not determined
constexpr double kAtTheLimit = 1e-3;  // of that way

/// What has been found of a free attribute.
struct Found {
  FreeAttribute free;
  double value;
  Uncertainty uncertainty;  // in shares of the way between the limits

  bool is_at_limit() const {
    const double share = free.fraction(value);
    return share < kAtTheLimit || share > 1 - kAtTheLimit;
  }
  double from() const { return free.value(std::max(free.fraction(value) - uncertainty.together, 0.0)); }
  double to() const { return free.value(std::min(free.fraction(value) + uncertainty.together, 1.0)); }
};

struct Result {
  std::vector<Found> found;
  Calibration calibration;
  Curves start, fitted;
  std::vector<double> residuals;  // of fitted, relative

  double relative_rms() const {
    double sum = 0;
    for (const double r : residuals) sum += r * r;
    return std::sqrt(sum / static_cast<double>(residuals.size()));
  }
};

std::vector<std::string> assignments(const std::vector<FreeAttribute>& free, const std::vector<double>& shares) {
  std::vector<std::string> words;
  for (std::size_t p = 0; p < free.size(); ++p)
    words.push_back(fmt::format("{}={}", free[p].name, written(free[p].value(shares[p]))));
  return words;
}

std::vector<FreeAttribute> read_free(const FitOptions& options, std::string& scene_hash) {
  scene::Scene scene = read_scene(options.scene);
  scene.diagnostics().throw_errors();
  scene_hash = hash_scene(scene);
  std::vector<FreeAttribute> free;
  for (const std::string& text : options.free) {
    FreeAttribute one = parse_free(text, scene);
    if (std::ranges::find(free, one.name, &FreeAttribute::name) != free.end())
      throw UsageError(fmt::format("--free {}: this attribute is free already", text));
    free.push_back(std::move(one));
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

Result carry_out(const Experiment& experiment, const std::vector<FreeAttribute>& free, const FitOptions& options) {
  std::vector<double> start;
  for (const FreeAttribute& one : free) start.push_back(one.start());
  Result result;
  result.start = experiment.run(assignments(free, start));  // what is wrong with it is wrong with the scene

  const QuietRuns quiet;
  const Residuals residuals = [&](const std::vector<double>& shares) -> std::optional<std::vector<double>> {
    try {
      return experiment.residuals(experiment.run(assignments(free, shares)));
    } catch (const NumericalError&) {
      return {};
    } catch (const scene::SceneError&) {  // values that do not go together
      return {};
    } catch (const InputError&) {
      return {};
    }
  };
  Progress progress(options.evaluations, true);
  result.calibration = calibrate(residuals, start, options.evaluations, [&](int done, double rms) {
    progress.show(done, fmt::format("residual {:.4f} %", 100 * rms));
  });
  const std::vector<double>& best = result.calibration.best;
  const std::vector<Uncertainty> uncertainty = uncertainties(residuals, best, kCloseness);
  progress.clear();

  for (std::size_t p = 0; p < free.size(); ++p)
    result.found.push_back({free[p], std::stod(written(free[p].value(best[p]))), uncertainty[p]});
  result.fitted = experiment.run(assignments(free, best));
  result.residuals = experiment.residuals(result.fitted);
  return result;
}

std::vector<std::string> warnings_of(const Result& result, const FitOptions& options) {
  std::vector<std::string> warnings;
  const auto add = [&](std::string text) { warnings.push_back(std::move(text)); };
  for (const Found& found : result.found) {
    const std::string interval =
        fmt::format("anywhere from {} to {} {}", written(found.from()), written(found.to()), found.free.unit);
    if (found.uncertainty.alone > kHardlyKnown)
      add(fmt::format("{} hardly matters here: the curve stays within {:g} % of itself {}", found.free.name,
                      100 * kCloseness, interval));
    else if (found.uncertainty.together > kHardlyKnown)
      add(
          fmt::format("{} cannot be told apart from the others: with them adjusted, the curve stays within {:g} % of "
                      "itself {}",
                      found.free.name, 100 * kCloseness, interval));
    if (found.is_at_limit()) add(fmt::format("{} is at its limit: the best value may lie beyond", found.free.name));
  }
  if (!result.calibration.is_converged)
    add(fmt::format("stopped after {} evaluations before it had settled; --evaluations allows more",
                    options.evaluations));
  if (result.calibration.num_failed > 0)
    add(fmt::format("{} of {} evaluations failed: the limits hold values with which the scene does not run",
                    result.calibration.num_failed, result.calibration.num_evaluations));
  return warnings;
}

/// [unit] of a column, root mean square of its differences.
double rms_of(const std::vector<double>& values, const std::vector<double>& wanted) {
  double sum = 0;
  for (std::size_t row = 0; row < values.size(); ++row)
    sum += (values[row] - wanted[row]) * (values[row] - wanted[row]);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<std::string> set_words(const Result& result) {
  std::vector<std::string> words;
  for (const Found& found : result.found)
    words.push_back(fmt::format("--set {}={}", found.free.name, written(found.value)));
  return words;
}

void print(const Result& result, const TargetCurve& target, const FitOptions& options) {
  fmt::print("{}: fitted to {}, {} rows\n", printable_line(options.scene.file.stem().string()),
             printable_line(target.file.string()), target.num_rows());
  std::size_t width = 0;
  for (const Found& found : result.found) width = std::max(width, found.free.name.size());
  for (const Found& found : result.found)
    fmt::print("  {:<{}}  {} {}  (within {:g} % of the curve: {} to {})\n", printable_line(found.free.name), width,
               written(found.value), found.free.unit, 100 * kCloseness, written(found.from()), written(found.to()));
  for (std::size_t c = 0; c < target.columns.size(); ++c) {
    const TargetCurve::Column& column = target.columns[c];
    fmt::print("  {:<{}}  {} {} root mean square\n", column.name, width,
               written(rms_of(result.fitted[c], target.columns[c].values)), column.unit);
  }
  fmt::print("  {:<{}}  {:.4f} % of the largest value\n", "residual", width, 100 * result.relative_rms());
  fmt::print("  {:<{}}  {}\n", "evaluations", width, result.calibration.num_evaluations);
  fmt::print("{}\n", printable_line(fmt::format("{}", fmt::join(set_words(result), " "))));
}

/// What a fit writes, opened before the first evaluation, so that a long one does not end in a file that cannot be
/// written.
struct FitFiles {
  FitFiles(const std::filesystem::path& directory, const InputFiles& inputs)
      : lock(directory),
        json(output_place(directory / "fit.json", inputs, {directory})),
        svg(output_place(directory / "fit.svg", inputs, {directory})) {}
  DirectoryLock lock;
  output::WholeFile json, svg;
};

/// The directory is there, and holds no earlier fit that must stay.
void prepare_place(const std::filesystem::path& directory, bool force) {
  output::make_directory(directory);
  for (const char* name : {"fit.json", "fit.svg"})
    if (std::filesystem::exists(directory / name) && !force)
      throw output::OutputError(
          fmt::format("{}: holds an earlier fit ({}); --force replaces it", directory.string(), name));
}

void write_json(output::WholeFile& out, const Result& result, const TargetCurve& target, const std::string& scene_hash,
                const std::vector<std::string>& warnings, const FitOptions& options) {
  Json json = {{"scene", options.scene.file.string()},
               {"scene_hash", scene_hash},
               {"overrides", options.scene.overrides},
               {"target", target.file.string()},
               {"rows", target.num_rows()},
               {"relative_rms", result.relative_rms()},
               {"columns", Json::array()},
               {"evaluations", result.calibration.num_evaluations},
               {"failed_evaluations", result.calibration.num_failed},
               {"converged", result.calibration.is_converged},
               {"parameters", Json::array()}};
  for (std::size_t c = 0; c < target.columns.size(); ++c) {
    const TargetCurve::Column& column = target.columns[c];
    json["columns"].push_back(
        {{"name", column.name}, {"unit", column.unit}, {"rms", rms_of(result.fitted[c], target.columns[c].values)}});
  }
  const auto number_or_null = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  for (const Found& found : result.found)
    json["parameters"].push_back({{"attribute", found.free.name},
                                  {"unit", found.free.unit},
                                  {"value", found.value},
                                  {"least", found.free.min},
                                  {"most", found.free.max},
                                  {"scale", found.free.is_logarithmic ? "log" : "linear"},
                                  {"start", found.free.value(found.free.start())},
                                  {"known_from", found.from()},
                                  {"known_to", found.to()},
                                  {"leeway_alone", number_or_null(found.uncertainty.alone)},
                                  {"leeway_together", number_or_null(found.uncertainty.together)}});
  json["set"] = fmt::format("{}", fmt::join(set_words(result), " "));
  json["warnings"] = warnings;
  out.write(json.dump(1) + "\n");
  out.commit();
}

void draw(output::WholeFile& file, const Result& result, const TargetCurve& target, const FitOptions& options) {
  const output::CurveColours colours;
  const bool is_over_time = !target.times.empty();
  std::vector<output::PanelGrid> grids;
  for (std::size_t c = 0; c < target.columns.size(); ++c) {
    const TargetCurve::Column& column = target.columns[c];
    const auto curve = [&](const char* name, std::string_view colour, std::vector<double> values, bool is_measured) {
      for (double& value : values) value *= column.shown_scale;
      return output::Curve{.name = name,
                           .colour = std::string(colour),
                           .values = std::move(values),
                           .has_line = !is_measured,
                           .has_dots = is_measured};
    };
    output::Series series{.x = is_over_time ? target.times : target.forces,
                          .curves = {curve("before", "#a5adb8", result.start[c], false),
                                     curve("target", colours.first, target.columns[c].values, true),
                                     curve("fitted", colours.second, result.fitted[c], false)}};
    output::Panel panel{.least_span = 1e-9,
                        .across = {.label = is_over_time ? "time [s]" : "force [N]"},
                        .series = {std::move(series)}};
    grids.push_back({std::string(column.label), {std::move(panel)}});
  }
  output::write_panel_grids(file, options.scene.file.stem().string(), grids);
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
      ->add_option("--free", options.free,
                   "A number that is looked for between lo and hi, on a logarithmic scale where these span a decade or "
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
  add_threads(*command, options.threads);
  command->add_flag("--force", options.force, "Write over an earlier fit")->needs(out);
  return command;
}

int fit(const FitOptions& options) {
  watch_signals();
  if (options.threads) set_num_threads(*options.threads);
  std::string scene_hash;
  const std::vector<FreeAttribute> free = read_free(options, scene_hash);
  TargetCurve target = read_target(options.target, options.compare);
  if (options.out) prepare_place(*options.out, options.force);

  try {
    std::vector<double> start;
    for (const FreeAttribute& one : free) start.push_back(one.start());
    const Experiment experiment(options.scene, std::move(target), options.steps, assignments(free, start));
    std::optional<FitFiles> files;
    if (options.out) files.emplace(*options.out, experiment.inputs());
    const Result result = carry_out(experiment, free, options);
    const std::vector<std::string> warnings = warnings_of(result, options);
    print(result, experiment.target(), options);
    if (files) {
      write_json(files->json, result, experiment.target(), scene_hash, warnings, options);
      draw(files->svg, result, experiment.target(), options);
    }
    flush_standard_output();
    for (const std::string& warning : warnings) spdlog::warn("warning: {}", warning);
    return kOk;
  } catch (const Interrupted&) {
    spdlog::warn("warning: ended by signal {}; nothing is written", requested_signal());
    return kSignalled + requested_signal();
  }
}

}  // namespace hexaplast::runner
