// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/sweep_directory.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "formats/text.hpp"
#include "record/field_file.hpp"
#include "record/json_file.hpp"
#include "runner/exit_code.hpp"
#include "runner/standard_output.hpp"
#include "runner/study/sweep_picture.hpp"

namespace hexaplast::runner {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
namespace {

output::OutputError no_plan(const SweepDirectory& directory) {
  return output::OutputError(fmt::format("{}: is no plan of a sweep; --force begins anew", directory.plan().string()));
}

void refuse_another_sweep(const SweepDirectory& directory, const Json& plan) {
  const Json found = read_plan(directory);
  std::string difference = difference_of(found, plan);
  if (difference.empty() && found.value("shard", "") != plan.value("shard", "")) difference = "the shard differs";
  if (!difference.empty())
    throw output::OutputError(
        fmt::format("{}: holds another sweep: {}; --force replaces it", directory.path.string(), difference));
}

std::vector<output::StudyColumn> columns_of(const SweepTable& table, const std::vector<std::string>& units) {
  std::vector<output::StudyColumn> columns;
  output::StudyColumn& numbers = columns.emplace_back(output::StudyColumn{"run", "", {}, {}});
  for (long run = 0; run < table.num_runs(); ++run) numbers.numbers.push_back(static_cast<double>(run + 1));
  for (std::size_t f = 0; f < table.factors().size(); ++f) {
    const Factor& factor = table.factors()[f];
    output::StudyColumn& column =
        columns.emplace_back(output::StudyColumn{"vary/" + factor.attribute, units[f], {}, {}});
    for (long run = 0; run < table.num_runs(); ++run) {
      const std::size_t value = table.choice(run)[f];
      if (factor.numbers.empty())
        column.texts.push_back(factor.values[value]);
      else
        column.numbers.push_back(factor.numbers[value]);
    }
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  output::StudyColumn& codes = columns.emplace_back(output::StudyColumn{"exit_code", "", {}, {}});
  for (long run = 0; run < table.num_runs(); ++run)
    codes.numbers.push_back(table.row(run) ? table.row(run)->exit_code : none);
  for (const std::string_view result : kResults) {
    output::StudyColumn& column =
        columns.emplace_back(output::StudyColumn{fmt::format("results/{}", result), "", {}, {}});
    for (long run = 0; run < table.num_runs(); ++run) {
      const std::optional<SweepRow>& row = table.row(run);
      if (result == "state_hash")
        column.texts.push_back(row ? row->results.back() : "");
      else
        column.numbers.push_back(row ? row->number(result) : none);
    }
  }
  return columns;
}

/// One file over the data sets of all runs.
void write_data(const SweepDirectory& directory, const Json& plan, const SweepTable& table) {
  std::vector<fs::path> runs;
  for (long run = 0; run < table.num_runs(); ++run) {
    const std::optional<SweepRow>& row = table.row(run);
    runs.push_back(row && row->exit_code == kOk ? directory.fields(run) : fs::path());
  }
  const std::vector<std::string> differing = output::write_study_file(
      directory.data(), runs, columns_of(table, plan.at("units").get<std::vector<std::string>>()),
      {{"format", "hexaplast sweep 1"},
       {"scene", fs::path(plan.at("scene").get<std::string>()).filename().string()},
       {"scene_hash", plan.at("scene_hash").get<std::string>()},
       {"version", plan.at("version").get<std::string>()},
       {"simd", plan.at("simd").get<std::string>()}});
  for (const std::string& name : differing)
    spdlog::warn("warning: {}: does not have /{}: its shape is not the same in all runs", directory.data().string(),
                 name);
}

}  // namespace

fs::path SweepDirectory::messages(long run) const { return path / fmt::format("messages_{}.txt", run + 1); }
fs::path SweepDirectory::files(long run) const { return path / fmt::format("run_{}", run + 1); }
fs::path SweepDirectory::fields(long run) const { return path / fmt::format("run_{}.h5", run + 1); }

std::vector<fs::path> SweepDirectory::contents(long num_runs) const {
  std::vector<fs::path> all = {plan(), table(), times(), picture(), data()};
  for (long run = 0; run < num_runs; ++run) all.insert(all.end(), {messages(run), files(run), fields(run)});
  return all;
}

Json read_plan(const SweepDirectory& directory) {
  Json plan;
  try {
    plan = output::read_json(directory.plan());
  } catch (const Json::exception&) {
    throw no_plan(directory);
  }
  if (!plan.is_object()) throw no_plan(directory);
  return plan;
}

std::vector<Factor> factors_of(const Json& plan) {
  std::vector<Factor> factors;
  std::size_t num_runs = 1;
  for (const Json& vary : plan.at("vary")) {
    factors.push_back(factor_of(vary.at("attribute"), vary.at("values").get<std::vector<std::string>>(),
                                vary.value("logarithmic", false), vary.at("attribute").get<std::string>()));
    num_runs *= factors.back().values.size();
    if (num_runs == 0 || num_runs > kMaxRuns) throw UsageError("no number of runs that a sweep has");
  }
  if (factors.empty()) throw UsageError("nothing is varied");
  return factors;
}

std::string difference_of(const Json& plan, const Json& other) {
  for (const auto& [key, difference] : {std::pair{"vary", "the varied attributes or their values differ"},
                                        {"steps", "the number of steps differs"},
                                        {"strict", "--strict is given to one of them only"},
                                        {"scene_hash", "the scene, or what --set makes of it, differs"},
                                        {"version", "the version of Hexaplast differs"},
                                        {"simd", "the instruction set differs"}})
    if (!plan.contains(key) || !other.contains(key) || plan[key] != other[key]) return difference;
  for (const char* key : {"fields", "every"})
    if (plan.value(key, Json()) != other.value(key, Json())) return "--fields or --every differ";
  return "";
}

void open(const SweepDirectory& directory, const Json& plan, bool force, const InputFiles& inputs, SweepTable& table) {
  const auto require_no_input = [&](const fs::path& file) {
    if (const fs::path input = inputs.replaced_by(file); !input.empty())
      throw output::OutputError(input.string() + ": is an input of this sweep");
  };
  const std::vector<fs::path> contents = directory.contents(table.num_runs());
  for (const fs::path& file : contents) {
    if (fs::is_symlink(file)) throw output::OutputError(file.string() + kIsLink);
    require_no_input(file);
  }
  for (long run = 0; run < table.num_runs(); ++run) require_no_input(directory.summary(run));
  if (fs::exists(directory.plan()) && !force) {
    refuse_another_sweep(directory, plan);
    if (fs::exists(directory.table())) table.read(directory.table());
    if (fs::exists(directory.times())) table.read_times(directory.times());
    if (plan.contains("fields"))  // a run whose data set is gone is not done
      for (long run = 0; run < table.num_runs(); ++run)
        if (table.row(run) && table.row(run)->exit_code == kOk && !fs::exists(directory.fields(run))) table.clear(run);
    return;
  }
  for (const fs::path& file : contents)
    if (fs::exists(file) && !force)
      throw output::OutputError(fmt::format("{}: is there without a plan; --force replaces it", file.string()));
  // in this order, so that a table never stands beside the plan of another one; runs replace their own files
  for (const fs::path& file : contents)
    if (!fs::is_directory(file)) fs::remove(file);
  output::WholeFile file(directory.plan());
  file.write(plan.dump(1) + "\n");
  file.commit();
}

void write_overviews(const SweepDirectory& directory, const Json& plan, const SweepTable& table) {
  const auto labels = plan.at("labels").get<std::vector<std::string>>();
  for (const std::string& warning : draw_sweep(directory.picture(), plan.at("title").get<std::string>(), table, labels))
    spdlog::warn("warning: {}", warning);
  if (plan.contains("fields")) write_data(directory, plan, table);
}

int conclude(const SweepDirectory& directory, const Json& plan, const SweepTable& table) {
  const std::string title = plan.at("title").get<std::string>();
  const long num_failed = table.num_failed();
  fmt::print("{}: {} of {} runs done, {} failed: {}\n", printable_line(title), table.num_finished(), table.num_own(),
             num_failed, printable_line(directory.table().string()));
  flush_standard_output();
  if (num_failed > 0) spdlog::error("{}: error: {} of {} runs failed", title, num_failed, table.num_own());
  return table.exit_code();
}

}  // namespace hexaplast::runner
