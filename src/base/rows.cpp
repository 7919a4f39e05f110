// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/rows.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "hexaplast/base/archive.hpp"

namespace hexaplast {

std::string interval(const Range& range, bool with_infinity) {
  const auto is_open = [&](double bound, bool is_without) {
    return is_without || (std::isinf(bound) && !(with_infinity && bound > 0));
  };
  return fmt::format("{}{:.10g}, {:.10g}{}", is_open(range.min, range.exclusive_min) ? '(' : '[', range.min, range.max,
                     is_open(range.max, range.exclusive_max) ? ')' : ']');
}

std::string alternatives(std::span<const std::string_view> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

void serialize(Archive& archive, MemberType type, double& number) {
  if (type == MemberType::kReal) return archive(number);
  auto whole = static_cast<std::int32_t>(number);
  archive(whole);
  number = whole;
}

void serialize(Archive& archive, std::vector<double>& list) { archive(list); }

}  // namespace hexaplast
