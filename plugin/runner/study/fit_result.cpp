// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/fit_result.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/text.hpp"
#include "page/history_panels.hpp"
#include "page/panel_grids.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAtTheLimit = 1e-3;  // of the way between the limits

/// How the values of a direction change together, for the one that changes most by a tenth of its way.
std::string combination(const std::vector<Found>& found, const std::vector<double>& step) {
  constexpr double kShown = 0.1;  // of the way; and of the largest step, below which one takes no part
  double max = 0;
  for (const double part : step) max = std::abs(part) > std::abs(max) ? part : max;
  std::vector<std::string> words;
  for (std::size_t p = 0; p < step.size(); ++p) {
    if (std::abs(step[p]) < kShown * std::abs(max)) continue;
    const FreeAttribute& free = found[p].free;
    const double fraction = kShown * step[p] / max;
    words.push_back(free.is_logarithmic
                        ? fmt::format("{} times {:.3g}", free.name, std::pow(free.max / free.min, fraction))
                        : fmt::format("{} {:+.3g}{}{}", free.name, fraction * (free.max - free.min),
                                      free.unit.empty() ? "" : " ", free.unit));
  }
  return fmt::format("{}", fmt::join(words, " together with "));
}

/// Whether a curve's residuals are more alike from row to row than independent ones are in 99 of 100 cases.
bool is_correlated(const CurveNoise& noise, std::size_t num_rows) {
  return noise.correlation > 2.33 / std::sqrt(static_cast<double>(num_rows));
}

std::vector<std::string> set_words(const FitResult& result) {
  std::vector<std::string> words;
  for (const Found& found : result.found)
    words.push_back(fmt::format("--set {}={}", found.free.name, written(found.value)));
  return words;
}

std::string interval_text(const Found& found) {
  if (found.is_at_limit()) return "at its limit";
  if (!found.has_interval()) return "95 %: not determined";
  return fmt::format("95 %: {} to {}", written(found.moved(-found.half_width)), written(found.moved(found.half_width)));
}

}  // namespace

bool is_limit(double fraction) { return fraction < kAtTheLimit || fraction > 1 - kAtTheLimit; }

bool Found::is_at_limit() const { return is_limit(free.fraction(value)); }
bool Found::has_interval() const { return std::isfinite(half_width) && !is_at_limit(); }
double Found::moved(double distance) const { return free.value(std::clamp(free.fraction(value) + distance, 0.0, 1.0)); }

std::vector<std::string> warnings_of(const FitResult& result, const Experiments& experiments, int max_evaluations) {
  std::vector<std::string> warnings;
  const auto add = [&](std::string text) { warnings.push_back(std::move(text)); };
  for (const Found& found : result.found) {
    const auto range = [&](double distance) {
      return fmt::format("anywhere from {} to {} {}", written(found.moved(-distance)), written(found.moved(distance)),
                         found.free.unit);
    };
    const std::string interval = range(found.uncertainty.together);
    if (found.uncertainty.alone > kHardlyKnown)
      add(fmt::format("{} hardly matters here: the curve stays within {:g} % of itself {}", found.free.name,
                      100 * kCloseness, interval));
    else if (found.uncertainty.together > kHardlyKnown)
      add(
          fmt::format("{} cannot be told apart from the others: with them adjusted, the curve stays within {:g} % of "
                      "itself {}",
                      found.free.name, 100 * kCloseness, interval));
    else if (found.has_interval() && found.half_width > kHardlyKnown)
      add(fmt::format("{} is lost in the noise: its 95 % interval is {}", found.free.name, range(found.half_width)));
    if (found.is_at_limit())
      add(
          fmt::format("{} is at its limit: the best value may lie beyond; it has no 95 % interval, and those of the "
                      "others are for this value of it",
                      found.free.name));
  }
  for (const Direction& direction : result.confidence.undetermined)
    if (std::ranges::count_if(direction.step, [](double part) { return std::abs(part) > 0.1; }) > 1)
      add(fmt::format("the curve does not determine {}: they may change so at the same time",
                      combination(result.found, direction.step)));
  if (!result.confidence.has_noise)
    add("the curve has not more rows than parameters: nothing is known of its noise, and there are no 95 % intervals");
  const std::vector<ComparedColumn>& columns = experiments.columns();
  for (std::size_t c = 0; c < columns.size() && result.confidence.has_noise; ++c)
    if (const CurveNoise& noise = result.confidence.noise[c]; is_correlated(noise, columns[c].num_rows))
      add(
          fmt::format("the differences in {} are alike from row to row (correlation {:.2f}): the scene cannot repeat "
                      "the curve as it is, or its noise is slow. The intervals are wider for it",
                      columns[c].name, noise.correlation));
  if (!result.calibration.is_converged)
    add(fmt::format("stopped after {} evaluations before it had settled; --evaluations allows more, now {}",
                    result.calibration.num_evaluations, max_evaluations));
  if (result.calibration.num_failed > 0)
    add(fmt::format("{} of {} evaluations failed: the limits hold values with which the scene does not run",
                    result.calibration.num_failed, result.calibration.num_evaluations));
  return warnings;
}

void print(const FitResult& result, const Experiments& experiments) {
  for (const Experiment& one : experiments.all())
    fmt::print("{}: fitted to {}, {} rows\n", printable_line(one.scene().file.stem().string()),
               printable_line(one.target().file.string()), one.target().num_rows());
  std::size_t width = 0;
  for (const Found& found : result.found) width = std::max(width, found.free.name.size());
  for (const Found& found : result.found)
    fmt::print("  {:<{}}  {} {}  ({}; within {:g} % of the curve: {} to {})\n", printable_line(found.free.name), width,
               written(found.value), found.free.unit, interval_text(found), 100 * kCloseness,
               written(found.moved(-found.uncertainty.together)), written(found.moved(found.uncertainty.together)));
  for (std::size_t c = 0; c < experiments.columns().size(); ++c) {
    const ComparedColumn& compared = experiments.columns()[c];
    const CurveNoise& noise = result.confidence.noise[c];
    fmt::print("  {:<{}}  {} {} root mean square{}\n", printable_line(compared.name), width, written(result.rms[c]),
               compared.column->unit,
               result.confidence.has_noise ? fmt::format("; noise {}, correlation {:.2f} from row to row",
                                                         written(noise.deviation), noise.correlation)
                                           : "");
  }
  fmt::print("  {:<{}}  {:.4f} % of the largest value\n", "residual", width, 100 * result.relative_rms);
  fmt::print("  {:<{}}  {}\n", "evaluations", width, result.calibration.num_evaluations);
  fmt::print("{}\n", printable_line(fmt::format("{}", fmt::join(set_words(result), " "))));
}

void write_json(output::WholeFile& out, const FitResult& result, const Experiments& experiments,
                const std::vector<std::string>& scene_hashes, const std::vector<std::string>& warnings) {
  const auto entry_of = [&](std::size_t k) {
    const Experiment& one = experiments.all()[k];
    return Json{{"scene", one.scene().file.string()},
                {"scene_hash", scene_hashes[k]},
                {"overrides", one.scene().overrides},
                {"target", one.target().file.string()},
                {"rows", one.target().num_rows()}};
  };
  Json json = entry_of(0);
  json["further_experiments"] = Json::array();
  for (std::size_t k = 1; k < experiments.all().size(); ++k) json["further_experiments"].push_back(entry_of(k));
  json["relative_rms"] = result.relative_rms;
  json["columns"] = Json::array();
  json["evaluations"] = result.calibration.num_evaluations;
  json["failed_evaluations"] = result.calibration.num_failed;
  json["converged"] = result.calibration.is_converged;
  for (const char* name : {"parameters", "correlation", "undetermined"}) json[name] = Json::array();
  const auto number_if = [](bool is_known, double value) { return is_known ? Json(value) : Json(nullptr); };
  const auto number_or_null = [&](double value) { return number_if(std::isfinite(value), value); };
  const bool has_noise = result.confidence.has_noise;
  for (std::size_t c = 0; c < experiments.columns().size(); ++c) {
    const ComparedColumn& compared = experiments.columns()[c];
    json["columns"].push_back({{"name", compared.column->name},
                               {"target", compared.curve->file.string()},
                               {"unit", compared.column->unit},
                               {"rms", result.rms[c]},
                               {"noise", number_if(has_noise, result.confidence.noise[c].deviation)},
                               {"noise_correlation", number_if(has_noise, result.confidence.noise[c].correlation)}});
  }
  for (std::size_t p = 0; p < result.found.size(); ++p) {
    const Found& found = result.found[p];
    const bool has_interval = found.has_interval();
    json["parameters"].push_back(
        {{"attribute", found.free.name},
         {"unit", found.free.unit},
         {"value", found.value},
         {"least", found.free.min},
         {"most", found.free.max},
         {"scale", found.free.is_logarithmic ? "log" : "linear"},
         {"start", found.free.value(found.free.start())},
         {"at_limit", found.is_at_limit()},
         {"confidence_from", number_if(has_interval, has_interval ? found.moved(-found.half_width) : 0)},
         {"confidence_to", number_if(has_interval, has_interval ? found.moved(found.half_width) : 0)},
         {"known_from", found.moved(-found.uncertainty.together)},
         {"known_to", found.moved(found.uncertainty.together)},
         {"leeway_alone", number_or_null(found.uncertainty.alone)},
         {"leeway_together", number_or_null(found.uncertainty.together)}});
    Json row = Json::array();
    for (std::size_t q = 0; q < result.found.size(); ++q)
      row.push_back(
          number_if(has_interval && result.found[q].has_interval(),
                    result.confidence.correlation(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(q))));
    json["correlation"].push_back(std::move(row));
  }
  for (const Direction& direction : result.confidence.undetermined) json["undetermined"].push_back(direction.step);
  json["set"] = fmt::format("{}", fmt::join(set_words(result), " "));
  json["warnings"] = warnings;
  out.write(json.dump(1) + "\n");
  out.commit();
}

void draw(output::WholeFile& file, const FitResult& result, const Experiments& experiments) {
  const output::CurveColours colours;
  std::vector<output::PanelGrid> grids;
  for (const ComparedColumn& compared : experiments.columns()) {
    const TargetCurve::Column& column = *compared.column;
    const bool is_over_time = !compared.curve->times.empty();
    const auto begin = static_cast<std::ptrdiff_t>(compared.begin);
    const auto part = [&](const std::vector<double>& values) {
      return std::vector<double>(values.begin() + begin,
                                 values.begin() + begin + static_cast<std::ptrdiff_t>(compared.num_rows));
    };
    const auto curve = [&](const char* name, std::string_view colour, std::vector<double> values, bool is_measured) {
      for (double& value : values) value *= column.shown_scale;
      return output::Curve{.name = name,
                           .colour = std::string(colour),
                           .values = std::move(values),
                           .has_line = !is_measured,
                           .has_dots = is_measured};
    };
    output::Series series{.x = is_over_time ? compared.curve->times : compared.curve->forces,
                          .curves = {curve("before", "#a5adb8", part(result.start), false),
                                     curve("target", colours.first, column.values, true),
                                     curve("fitted", colours.second, part(result.fitted), false)}};
    output::Panel panel{
        .min_span = 1e-9, .across = {.label = is_over_time ? "time [s]" : "force [N]"}, .series = {std::move(series)}};
    grids.push_back({experiments.all().size() == 1
                         ? column.label
                         : fmt::format("{}, {}", column.label, compared.curve->file.stem().string()),
                     {std::move(panel)}});
  }
  output::write_panel_grids(file, experiments.all().front().scene().file.stem().string(), grids);
}

}  // namespace hexaplast::runner
