// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/factor.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>

#include "hexaplast/base/error.hpp"
#include "runner/exit_code.hpp"
#include "scene/value.hpp"

namespace hexaplast::runner {
namespace {

constexpr std::string_view kForm = "must be PATH.attribute=a:b:n, PATH.attribute=a:b:n:log or PATH.attribute=v1,v2,...";
constexpr int kMaxValues = 10'000;

[[noreturn]] void refuse(std::string_view whole, const std::string& what) {
  throw UsageError(fmt::format("--vary {}: {}", whole, what));
}

std::optional<double> number(std::string_view text) {
  static constexpr attributes::Attribute kNumber{.name = "value", .type = attributes::Type::kReal};
  try {
    return std::get<double>(scene::read_value(kNumber, text));
  } catch (const InputError&) {
    return {};
  }
}

int count(std::string_view text, std::string_view whole) {
  static constexpr attributes::Attribute kCount{
      .name = "n", .type = attributes::Type::kInteger, .range = {.min = 2, .max = kMaxValues}};
  try {
    return static_cast<int>(std::get<std::int64_t>(scene::read_value(kCount, text)));
  } catch (const InputError&) {
    refuse(whole, fmt::format("'{}' values: must be a whole number from 2 to {}", text, kMaxValues));
  }
}

std::vector<std::string> spread(double a, double b, int n, bool is_logarithmic) {
  std::vector<std::string> values;
  for (int i = 0; i < n; ++i) {
    const double at = static_cast<double>(i) / (n - 1);
    const double value = is_logarithmic ? a * std::pow(b / a, at) : a * (1 - at) + b * at;
    values.push_back(fmt::format("{:.12g}", i == n - 1 ? b : value));
  }
  return values;
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == text.npos) return parts;
    begin = end + 1;
  }
}

double parse_number(std::string_view text, std::string_view whole) {
  const std::optional<double> found = number(text);
  if (!found) throw UsageError(fmt::format("{}: '{}' is no number", whole, text));
  return *found;
}

Factor factor_of(std::string attribute, std::vector<std::string> values, bool is_logarithmic, std::string_view whole) {
  Factor factor{std::move(attribute), std::move(values), {}, is_logarithmic};
  std::set<std::string_view> taken;
  for (const std::string& value : factor.values) {
    if (value.empty()) refuse(whole, "a value is empty");
    if (!taken.insert(value).second) refuse(whole, fmt::format("the value {} comes twice", value));
    if (const std::optional<double> found = number(value)) factor.numbers.push_back(*found);
  }
  if (factor.numbers.size() != factor.values.size()) factor.numbers.clear();
  return factor;
}

Factor parse_factor(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == text.npos || equals == 0) refuse(text, std::string(kForm));
  const std::string_view given = text.substr(equals + 1);

  std::vector<std::string> values;
  bool is_logarithmic = false;
  const std::vector<std::string_view> parts = split(given, ':');
  if (parts.size() > 1) {
    is_logarithmic = parts.size() == 4 && parts[3] == "log";
    if (parts.size() != 3 && !is_logarithmic) refuse(text, std::string(kForm));
    const std::string whole = fmt::format("--vary {}", text);
    const double a = parse_number(parts[0], whole), b = parse_number(parts[1], whole);
    if (is_logarithmic && !(a > 0 && b > 0)) refuse(text, "equal factors need limits greater than 0");
    values = spread(a, b, count(parts[2], text), is_logarithmic);
  } else {
    for (const std::string_view value : split(given, ',')) values.emplace_back(value);
  }
  return factor_of(std::string(text.substr(0, equals)), std::move(values), is_logarithmic, text);
}

}  // namespace hexaplast::runner
