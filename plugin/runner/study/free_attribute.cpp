// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/free_attribute.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hexaplast/base/error.hpp"
#include "runner/exit_code.hpp"
#include "runner/study/factor.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

constexpr double kSpansDecades = 10;  // factor between the limits from which on the scale is logarithmic

/// The attribute's value where it is one number.
std::optional<double> one_number(const scene::Value& value) {
  if (const double* number = std::get_if<double>(&value)) return *number;
  if (const auto* numbers = std::get_if<std::vector<double>>(&value); numbers && numbers->size() == 1)
    return numbers->front();
  return {};
}

}  // namespace

double FreeAttribute::value(double fraction) const {
  return is_logarithmic ? min * std::pow(max / min, fraction) : min + (max - min) * fraction;
}

double FreeAttribute::fraction(double value) const {
  return is_logarithmic ? std::log(value / min) / std::log(max / min) : (value - min) / (max - min);
}

FreeAttribute parse_free(std::string_view text, scene::Scene& scene) {
  const std::string words = fmt::format("--free {}", text);
  const auto refuse = [&](const std::string& what) { throw UsageError(fmt::format("{}: {}", words, what)); };
  const std::size_t equals = text.find('=');
  if (equals == text.npos)
    refuse("must be PATH.attribute=lo:hi, PATH.attribute=lo:hi:log or PATH.attribute=lo:hi:linear");
  const std::vector<std::string_view> parts = split(text.substr(equals + 1), ':');
  const bool has_scale = parts.size() == 3 && (parts[2] == "log" || parts[2] == "linear");
  if (parts.size() != 2 && !has_scale)
    refuse("must be PATH.attribute=lo:hi, PATH.attribute=lo:hi:log or PATH.attribute=lo:hi:linear");

  FreeAttribute free{.name = std::string(text.substr(0, equals)),
                     .min = parse_number(parts[0], words),
                     .max = parse_number(parts[1], words)};
  if (!(free.min < free.max))
    refuse(fmt::format("lo must be less than hi, {} is not less than {}", free.min, free.max));
  free.is_logarithmic = has_scale ? parts[2] == "log" : free.min > 0 && free.max >= kSpansDecades * free.min;
  if (free.is_logarithmic && free.min <= 0) refuse("a logarithmic scale needs limits greater than 0");

  scene::Data& data = scene::named_attribute(scene, free.name, words);
  const attributes::Attribute& attribute = data.attribute();
  const bool is_real = attribute.type == attributes::Type::kReal || attribute.type == attributes::Type::kReals;
  const bool is_chosen =
      attribute.access == attributes::Access::kInput || attribute.access == attributes::Access::kState;
  if (!is_real || !is_chosen)
    throw scene::OverrideError(scene::format_error(
        {words, 0},
        fmt::format("{}.{} holds {}, must be a number that the scene gives", data.owner().class_name(), attribute.name,
                    is_chosen ? attributes::describe(attribute.type) : "what is computed")));
  for (const double limit : {free.min, free.max}) {
    try {
      scene::read_value(attribute, fmt::format("{}", limit));
    } catch (const InputError& error) {
      throw scene::OverrideError(scene::format_error(
          {words, 0}, fmt::format("{}.{}: {}", data.owner().class_name(), attribute.name, error.what())));
    }
  }
  free.unit = attribute.unit;
  const std::optional<double> given = data.link().empty() ? one_number(data.value()) : std::nullopt;
  if (given && *given >= free.min && *given <= free.max) free.given = given;
  return free;
}

std::string written(double value) { return fmt::format("{:.6g}", value); }

}  // namespace hexaplast::runner
