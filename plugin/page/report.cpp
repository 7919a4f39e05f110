// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "formats/readable_file.hpp"
#include "formats/text.hpp"
#include "formats/xml.hpp"
#include "page/history_panels.hpp"
#include "page/html.hpp"
#include "record/files.hpp"
#include "record/viewer_states.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxPictures = 8;

std::string duration_words(double seconds) {
  if (seconds < 60) return fmt::format("{:.2f} s", seconds);
  const long whole = std::lround(seconds);
  return whole < 3600 ? fmt::format("{} min {} s", whole / 60, whole % 60)
                      : fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

/// The pictures of a run by their steps; of many, some that are spread evenly, the last one among them.
std::map<long, fs::path> key_frames(const fs::path& directory) {
  std::map<long, fs::path> all;
  std::error_code error;
  for (fs::directory_iterator entry(directory / "frames", error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (is_numbered(name, "frame_", ".png")) all.emplace(number_at_end(name).value_or(0), entry->path());
  }
  if (all.size() <= kMaxPictures) return all;

  std::map<long, fs::path> some;
  std::size_t number = 0;  // from 1
  for (const auto& frame : all)
    if (++number * kMaxPictures / all.size() > some.size()) some.insert(frame);
  return some;
}

// One slow step must not press all others to the ground.
std::string mark_step_times(Panel& panel, const StepTimes& times) {
  constexpr double kHighest = 3;  // of p99
  panel.levels = {{"p50", std::string(colours::kSecond), times.p50},
                  {"p90", std::string(colours::kThird), times.p90},
                  {"p99", std::string(colours::kFourth), times.p99}};
  panel.highest = times.p99 > 0 ? kHighest * times.p99 : panel.highest;
  if (times.longest <= panel.highest) return fmt::format("The slowest step took {:.4g} ms.", times.longest);
  return fmt::format("The slowest step took {:.4g} ms; what exceeds three times p99 is drawn at the upper edge.",
                     times.longest);
}

void add_charts(HtmlPage& page, const fs::path& directory, const std::vector<ProbeRecord>& probes) {
  std::vector<HistoryPanel> wanted;
  for (const ProbeRecord& probe : probes) wanted.push_back(panel_of(probe));
  std::ranges::copy(history_panels(), std::back_inserter(wanted));
  HistoryView view = view_history(directory / "history.csv", wanted);
  if (view.panels.empty()) return;
  page.heading("Over time");
  page.add("<div class=\"charts\">");
  for (Panel& panel : view.panels) {
    if (has_nothing_to_see(panel)) continue;
    const std::string note = panel.quantity == "time per step" ? mark_step_times(panel, view.step_times) : "";
    page.chart(panel, note);
  }
  page.add("</div>");
}

void add_pictures(HtmlPage& page, const fs::path& directory, double dt) {
  const std::map<long, fs::path> frames = key_frames(directory);
  if (frames.empty()) return;
  page.heading("Pictures");
  page.add("<div class=\"pictures\">");
  for (const auto& [step, file] : frames) {
    require_readable(file);
    const std::string caption = fmt::format("step {}, {:.6g} s", step, static_cast<double>(step) * dt);
    page.add(fmt::format("<figure><img alt=\"the body after {}\" src=\"{}\"><figcaption>{}</figcaption></figure>",
                         caption, data_uri("image/png", whole_file(file)), caption));
  }
  page.add("</div>");
}

void add_viewer(HtmlPage& page, const fs::path& directory) {
  const std::optional<ViewerData> data = read_viewer_data(directory);
  if (data && data->has_states) page.viewer({data->markup});
  if (data && !data->has_states)
    page.paragraph(fmt::format("Reports of bodies with more than {} nodes have pictures only: nothing to turn.",
                               ViewerStates::kMaxNodes),
                   "lead");
}

void add_scene(HtmlPage& page, const Manifest& run) {
  page.heading("Scene");
  page.paragraph("Attributes that differ from their defaults; units are SI.", "lead");
  for (const ComponentRecord& component : run.components) {
    page.add(
        fmt::format("<p class=\"component\"><strong>{}</strong> <code>{}</code><br><span class=\"lead\">{}</span></p>",
                    escaped(component.class_name), escaped(component.path), escaped(component.help)));
    std::vector<std::vector<std::string>> rows;
    for (const AttributeRecord& attribute : component.attributes)
      rows.push_back({attribute.name,
                      attribute.unit.empty() ? attribute.value : fmt::format("{} {}", attribute.value, attribute.unit),
                      attribute.help});
    if (!rows.empty()) page.table({"attribute", "value", "meaning"}, rows, "attributes");
  }
}

void add_run(HtmlPage& page, const Manifest& run) {
  page.heading("Run");
  page.add(fmt::format("<pre>{}</pre>", escaped(shell_line(run.command))));
  constexpr double kGibibyte = 1024.0 * 1024.0 * 1024.0;
  std::vector<std::vector<std::string>> rows = {
      {"working directory", run.working_directory},
      {"program", fmt::format("hexaplast {}", run.version)},
      {"scene file", run.scene_file},
      {"scene XXH64", run.scene_hash},
      {"state hash", run.state_hash.empty() ? "none" : run.state_hash},
      {"solvers",
       run.linear_solver.empty() ? run.motion_solver : fmt::format("{}, {}", run.motion_solver, run.linear_solver)},
      {"precision", run.precision.empty() ? "none" : run.precision},
      {"instruction set", run.simd},
      {"threads", fmt::format("{}", run.threads)},
      {"processor", fmt::format("{}, {} hardware threads", run.processor, run.cores)},
      {"memory", fmt::format("{:.1f} GiB", static_cast<double>(run.memory_bytes) / kGibibyte)},
      {"started", run.started},
      {"took", duration_words(run.duration)},
  };
  page.table({}, rows);
}

}  // namespace

void write_report(const fs::path& directory, const Manifest& run) {
  HtmlPage page(run.caption());
  if (!run.description.empty()) page.paragraph(run.description);
  page.paragraph(fmt::format("{}{} of {} steps of {:.6g} s. {}.", run.heading.empty() ? "" : run.title + ": ",
                             run.steps_done, run.steps_asked, run.dt, run.exit_reason),
                 run.state == RunState::kFinished ? "lead" : "alarm");
  add_viewer(page, directory);
  if (!run.warnings.empty()) {
    page.heading("Warnings");
    page.add("<ul>");
    for (const std::string& warning : run.warnings) page.add(fmt::format("<li>{}</li>", escaped(warning)));
    page.add("</ul>");
  }
  if (!run.summary.empty()) {
    page.heading("Result");
    std::vector<std::vector<std::string>> rows;
    for (const Figure& figure : run.summary) rows.push_back({figure.label, figure.value});
    page.table({}, rows);
  }
  add_pictures(page, directory, run.dt);
  add_charts(page, directory, run.probes);
  add_scene(page, run);
  add_run(page, run);

  WholeFile out(directory / kReportName);
  out.write(std::move(page).finish());
  out.commit();
}

}  // namespace hexaplast::output
