// SPDX-License-Identifier: LGPL-2.1-or-later
// The text of an attribute: the first byte chooses its type. What is read is finite, within its range, and in whole
// groups.
#include <cmath>

#include "hexaplast/base/error.hpp"
#include "scene/value.hpp"
#include "target.hpp"

using namespace hexaplast;
using attributes::Attribute;
using attributes::Type;
using fuzz::require;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr Type kTypes[] = {Type::kBool,  Type::kInteger,   Type::kReal,    Type::kText,
                             Type::kWord,  Type::kIntegers,  Type::kVector3, Type::kVectors3,
                             Type::kBoxes, Type::kHexahedra, Type::kReals,   Type::kLink};
  if (size == 0) return 0;
  const Attribute attribute{
      .name = "any", .type = kTypes[data[0] % std::size(kTypes)], .range = {.min = -8, .max = 1e6}, .words = "one two"};
  scene::Value value;
  try {
    value = scene::read_value(attribute, fuzz::text_of(data + 1, size - 1));
  } catch (const InputError&) {
    return 0;
  }
  scene::check_value(attribute, value);
  if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
    for (const double number : *numbers) require(std::isfinite(number) && attribute.range.contains(number), "in range");
    const std::size_t group = attribute.type == Type::kBoxes ? 6 : attribute.type == Type::kReals ? 1 : 3;
    require(numbers->size() % group == 0, "whole groups");
  }
  if (const auto* number = std::get_if<double>(&value)) require(attribute.range.contains(*number), "in range");
  return 0;
}
