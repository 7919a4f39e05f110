// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/sweep_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "record/files.hpp"

namespace hexaplast::runner {
namespace {

/// As a field of a CSV file.
std::string field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted;
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return fmt::format("\"{}\"", quoted);
}

}  // namespace

SweepRow SweepRow::of(int exit_code, const nlohmann::ordered_json& summary) {
  SweepRow row{exit_code, {}};
  for (const std::string_view result : kResults) {
    if (summary.is_null()) {
      row.results.emplace_back();
      continue;
    }
    const nlohmann::ordered_json& value = summary.at(std::string(result));
    row.results.push_back(value.is_string() ? value.get<std::string>() : value.dump());
  }
  if (!summary.is_null()) row.step_ms = summary.at("step_ms").dump();
  return row;
}

double SweepRow::number(std::string_view result) const {
  const auto column = std::ranges::find(kResults, result) - kResults.begin();
  const std::string& text = result == "step_ms" ? step_ms : results[static_cast<std::size_t>(column)];
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && !text.empty() ? value : std::numeric_limits<double>::quiet_NaN();
}

SweepTable::SweepTable(std::vector<Factor> factors, Shard shard) : factors_(std::move(factors)) {
  std::size_t num_runs = 1;
  for (const Factor& factor : factors_) num_runs *= factor.values.size();
  rows_.resize(num_runs);
  for (long run = 0; run < this->num_runs(); ++run) is_own_.push_back(shard.is_whole() || shard.has(assignments(run)));
}

long SweepTable::num_own() const { return std::ranges::count(is_own_, true); }

std::vector<std::size_t> SweepTable::choice(long run) const {
  std::vector<std::size_t> choice(factors_.size());
  std::size_t rest = static_cast<std::size_t>(run);
  for (std::size_t f = factors_.size(); f-- > 0; rest /= factors_[f].values.size())
    choice[f] = rest % factors_[f].values.size();
  return choice;
}

long SweepTable::run_of(const std::vector<std::size_t>& choice) const {
  std::size_t run = 0;
  for (std::size_t f = 0; f < factors_.size(); ++f) run = run * factors_[f].values.size() + choice[f];
  return static_cast<long>(run);
}

std::vector<std::string> SweepTable::assignments(long run) const {
  std::vector<std::string> assignments;
  const std::vector<std::size_t> chosen = choice(run);
  for (std::size_t f = 0; f < factors_.size(); ++f)
    assignments.push_back(fmt::format("{}={}", factors_[f].attribute, factors_[f].values[chosen[f]]));
  return assignments;
}

bool SweepTable::is_finished(long run) const {
  const std::optional<SweepRow>& found = row(run);
  return found && (found->exit_code == kOk || found->exit_code == kScene || found->exit_code == kNumerical);
}

long SweepTable::num_finished() const {
  long count = 0;
  for (long run = 0; run < num_runs(); ++run) count += is_finished(run);
  return count;
}

long SweepTable::num_failed() const {
  return std::ranges::count_if(rows_, [](const auto& row) { return row && row->exit_code != kOk; });
}

int SweepTable::exit_code() const {
  if (num_failed() == 0) return kOk;
  std::set<int> codes;
  for (long run = 0; run < num_runs(); ++run)
    if (has(run)) codes.insert(row(run) ? row(run)->exit_code : kOk);
  return codes.size() == 1 ? *codes.begin() : kNumerical;
}

std::string SweepTable::head() const {
  std::string line = "run";
  for (const Factor& factor : factors_) line += fmt::format(",{}", field(factor.attribute));
  line += ",exit_code";
  for (const std::string_view result : kResults) line += fmt::format(",{}", result);
  return line;
}

std::string SweepTable::beginning(long run) const {
  std::string line = fmt::format("{},", run + 1);
  const std::vector<std::size_t> chosen = choice(run);
  for (std::size_t f = 0; f < factors_.size(); ++f) line += fmt::format("{},", field(factors_[f].values[chosen[f]]));
  return line;
}

void SweepTable::write(const std::filesystem::path& file) const {
  output::WholeFile out(file);
  out.write(head() + "\n");
  for (long run = 0; run < num_runs(); ++run) {
    const std::optional<SweepRow>& found = row(run);
    if (found) out.write(fmt::format("{}{},{}\n", beginning(run), found->exit_code, fmt::join(found->results, ",")));
  }
  out.commit();
}

void SweepTable::read(const std::filesystem::path& file) {
  output::require_readable(file);
  std::ifstream in(file);
  int line_number = 1;
  const auto refuse = [&](std::string_view what) {
    throw output::OutputError(fmt::format("{}:{}: {}; --force begins anew", file.string(), line_number, what));
  };
  std::string line;
  if (!std::getline(in, line) || line != head()) refuse("is not the table of this sweep");
  while (++line_number, std::getline(in, line)) {
    long number = 0;
    std::from_chars(line.data(), line.data() + line.size(), number);
    const long run = number - 1;
    if (run < 0 || run >= num_runs() || !has(run) || !line.starts_with(beginning(run)))
      refuse("is no run of this sweep");

    // results hold no commas
    SweepRow row;
    const std::string rest = line.substr(beginning(run).size());
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), row.exit_code);
    std::size_t at = static_cast<std::size_t>(end - rest.data());
    while (error == std::errc() && at < rest.size() && rest[at] == ',') {
      const std::size_t next = std::min(rest.find(',', at + 1), rest.size());
      row.results.push_back(rest.substr(at + 1, next - at - 1));
      at = next;
    }
    if (at != rest.size() || row.results.size() != kResults.size()) refuse("is no row of results");
    set(run, std::move(row));
  }
}

void SweepTable::write_times(const std::filesystem::path& file) const {
  output::WholeFile out(file);
  out.write("run,step_ms\n");
  for (long run = 0; run < num_runs(); ++run)
    if (row(run) && !row(run)->step_ms.empty()) out.write(fmt::format("{},{}\n", run + 1, row(run)->step_ms));
  out.commit();
}

void SweepTable::read_times(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    long number = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    const std::string time = line.substr(static_cast<std::size_t>(end - line.data()));
    double value = 0;
    const bool is_time =
        error == std::errc() && time.starts_with(',') && time.size() > 1 &&
        std::from_chars(time.data() + 1, time.data() + time.size(), value).ptr == time.data() + time.size();
    if (is_time && number >= 1 && number <= num_runs())
      if (std::optional<SweepRow>& known = rows_[static_cast<std::size_t>(number - 1)]) known->step_ms = time.substr(1);
  }
}

}  // namespace hexaplast::runner
