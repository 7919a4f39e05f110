// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/target_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>

#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

constexpr std::array<QuantityEntry, 5> kQuantities{{
    {Quantity::kElongation, "elongation", "", "elongation [%]", 100},
    {Quantity::kPlasticElongation, "plastic_elongation", "", "plastic elongation [%]", 100},
    {Quantity::kTwist, "twist_deg", "deg", "twist [°]", 1},
    {Quantity::kPlasticTwist, "plastic_twist_deg", "deg", "plastic twist [°]", 1},
    {Quantity::kForce, "force", "N", "force [N]", 1},
}};
constexpr std::string_view kProbe = "probe_";  // what history.csv puts before the name of a probe
constexpr std::string_view kWorld = "world_";  // what history.csv calls the first two
constexpr std::size_t kMinRows = 2;

/// A column without values. What is none of the quantities is a probe, called so with or without kProbe.
TargetCurve::Column column_named(std::string_view column) {
  std::string_view name = column;
  const bool is_world = column.starts_with(kWorld);
  if (is_world) column.remove_prefix(kWorld.size());
  for (const QuantityEntry& entry : kQuantities)
    if (column == entry.column &&
        (!is_world || entry.quantity == Quantity::kElongation || entry.quantity == Quantity::kTwist))
      return {.quantity = entry.quantity,
              .name = std::string(entry.column),
              .unit = std::string(entry.unit),
              .label = std::string(entry.label),
              .shown_scale = entry.shown_scale,
              .values = {}};
  if (name.starts_with(kProbe)) name.remove_prefix(kProbe.size());
  return {
      .quantity = Quantity::kProbe, .name = std::string(name), .unit = {}, .label = std::string(name), .values = {}};
}

/// The fields of a line without the blanks around them.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(',', begin);
    std::string_view field = line.substr(begin, end - begin);
    const std::size_t first = field.find_first_not_of(" \t");
    field = first == field.npos ? "" : field.substr(first, field.find_last_not_of(" \t") - first + 1);
    fields.push_back(field);
    if (end == line.npos) return fields;
    begin = end + 1;
  }
}

/// Reads the lines of a file that hold something.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file) {
    scene::require_readable(file);
    in_.open(file);
  }

  std::optional<std::vector<std::string_view>> next() {
    while (++number_, std::getline(in_, line_)) {
      if (number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.erase(0, 3);  // spreadsheets mark UTF-8
      while (!line_.empty() && (line_.back() == '\r' || line_.back() == ' ')) line_.pop_back();
      if (!line_.empty() && line_[0] != '#') return fields_of(line_);
    }
    return {};
  }

  int number() const { return number_; }

  [[noreturn]] void refuse(int line, const std::string& what) const {
    throw scene::SceneError(scene::format_error({file_.string(), line}, what));
  }

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::string line_;
  int number_ = 0;
};

double number_of(std::string_view field, const Lines& lines, std::string_view column) {
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
    lines.refuse(lines.number(), fmt::format("{}: '{}': must be a finite number", column, field));
  return value;
}

}  // namespace

std::span<const QuantityEntry> quantities() { return kQuantities; }

TargetCurve read_target(const std::filesystem::path& file, const std::vector<std::string>& compare) {
  Lines lines(file);
  const auto head = lines.next();
  if (!head) lines.refuse(0, "is empty: a line of column names and rows of numbers are needed");
  const std::vector<std::string> names(head->begin(), head->end());
  const int head_line = lines.number();
  const auto column_of = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return {};
    return static_cast<std::size_t>(found - names.begin());
  };

  TargetCurve target{.file = file, .head_line = head_line, .lines = {}, .times = {}, .forces = {}, .columns = {}};
  const std::optional<std::size_t> time = column_of("time"), force = column_of("force");
  if (!time && !force)
    lines.refuse(head_line,
                 "no column is called time or force: the curve is over neither (the first line names columns)");
  const std::size_t along = time ? *time : *force;

  std::vector<std::size_t> compared;
  for (std::size_t c = 0; compare.empty() && c < names.size(); ++c)
    if (c != along) compared.push_back(c);
  for (const std::string& name : compare) {
    const std::optional<std::size_t> column = column_of(name);
    if (!column || *column == along)
      lines.refuse(head_line, fmt::format("no column that could be compared is called '{}' (--compare)", name));
    compared.push_back(*column);
  }
  for (const std::size_t c : compared) {
    TargetCurve::Column column = column_named(names[c]);
    if (std::ranges::find(target.columns, column.name, &TargetCurve::Column::name) != target.columns.end())
      lines.refuse(head_line, fmt::format("{} is there twice", column.name));
    target.columns.push_back(std::move(column));
  }
  if (target.columns.empty()) lines.refuse(head_line, "no column to compare");

  while (const auto fields = lines.next()) {
    if (fields->size() != names.size())
      lines.refuse(lines.number(),
                   fmt::format("{} fields, must be {} as in the first line", fields->size(), names.size()));
    const double at = number_of((*fields)[along], lines, names[along]);
    std::vector<double>& axis = time ? target.times : target.forces;
    if (time && at < 0) lines.refuse(lines.number(), fmt::format("time {}: must not be negative", at));
    if (time && !axis.empty() && at <= axis.back())
      lines.refuse(lines.number(), fmt::format("time {} does not come after {}", at, axis.back()));
    axis.push_back(at);
    target.lines.push_back(lines.number());
    for (std::size_t c = 0; c < compared.size(); ++c)
      target.columns[c].values.push_back(number_of((*fields)[compared[c]], lines, names[compared[c]]));
  }
  if (target.num_rows() < kMinRows) lines.refuse(0, fmt::format("at least {} rows are needed", kMinRows));
  for (const TargetCurve::Column& column : target.columns)
    if (std::ranges::all_of(column.values, [](double value) { return value == 0; }))
      lines.refuse(0, fmt::format("{} is zero in every row: nothing to fit to", column.name));
  return target;
}

}  // namespace hexaplast::runner
