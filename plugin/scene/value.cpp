// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/value.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <type_traits>

#include "attributes/words.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::scene {
namespace {

using attributes::Attribute;
using attributes::for_each_word;
using attributes::quoted;
using attributes::Range;
using attributes::Type;

constexpr std::size_t kLongestRange = 16'777'216;  // numbers that `a-b` may stand for

// The sign + is accepted as SOFA does; std::from_chars alone refuses it.
std::string_view without_plus(std::string_view word) {
  const bool signed_number = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return signed_number ? word.substr(1) : word;
}

template <class Number>
void check_range(const Range& range, Number number) {
  if (range.contains(static_cast<double>(number))) return;
  throw InputError(attributes::inadmissible(range, number));
}

/// what: "a number", which the word is not.
template <class Number>
Number read_number(std::string_view word, const char* what) {
  const std::string_view digits = without_plus(word);
  Number number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error == std::errc::result_out_of_range) throw InputError(fmt::format("{} is out of range", quoted(word)));
  if (error != std::errc() || end != digits.data() + digits.size())
    throw InputError(fmt::format("{} is not {}", quoted(word), what));
  if (!std::isfinite(static_cast<double>(number))) throw InputError(fmt::format("{} is not finite", quoted(word)));
  return number;
}

double read_real(std::string_view word) { return read_number<double>(word, "a number"); }

std::int64_t read_integer(std::string_view word) { return read_number<std::int64_t>(word, "a whole number"); }

// `7`, `3-9`, `9-3`, `3-9-2` or `9-3--2`. A minus sign at the beginning of a number belongs to it.
void read_integers(std::string_view word, std::vector<std::int64_t>& numbers) {
  const std::size_t dash = word.find('-', 1);
  if (dash == std::string_view::npos) {
    numbers.push_back(read_integer(word));
    return;
  }

  const std::size_t second = word.find('-', dash + 2);
  const bool stepped = second != std::string_view::npos;
  const std::int64_t first = read_integer(word.substr(0, dash));
  const std::int64_t last = read_integer(word.substr(dash + 1, stepped ? second - dash - 1 : word.npos));
  const std::int64_t direction = first <= last ? 1 : -1;
  const std::int64_t step = stepped ? read_integer(word.substr(second + 1)) : direction;
  if (step == 0 || (step > 0) != (direction > 0))
    throw InputError(fmt::format("{}: a step of {} does not lead from {} to {}", quoted(word), step, first, last));

  // unsigned, because the ends may lie further apart than the largest signed number
  const auto distance = [](std::int64_t from, std::int64_t to) {
    return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  };
  const std::uint64_t span = first <= last ? distance(first, last) : distance(last, first);
  const std::uint64_t stride = step > 0 ? static_cast<std::uint64_t>(step) : distance(step, 0);
  const std::uint64_t count = span / stride + 1;
  if (count > kLongestRange || numbers.size() + count > kLongestRange)
    throw InputError(fmt::format("{} stands for more than {} numbers", quoted(word), kLongestRange));
  for (std::uint64_t i = 0; i < count; ++i) numbers.push_back(first + static_cast<std::int64_t>(i) * step);
}

bool read_bool(std::string_view word) {
  for (const std::string_view yes : {"1", "true", "True", "TRUE", "t", "T"})
    if (word == yes) return true;
  for (const std::string_view no : {"0", "false", "False", "FALSE", "f", "F"})
    if (word == no) return false;
  throw InputError(fmt::format("{} must be true, false, 1 or 0", quoted(word)));
}

std::string_view only_word(std::string_view text) {
  const std::vector<std::string_view> words = split_words(text);
  if (words.size() != 1) throw InputError(fmt::format("{} values given, must be one", words.size()));
  return words.front();
}

/// Numbers of a list that belong together.
std::size_t group_size(Type type) {
  switch (type) {
    case Type::kVectors3:
      return 3;
    case Type::kBoxes:
      return 6;
    case Type::kHexahedra:
      return 8;
    default:
      return 1;
  }
}

void check_count(Type type, std::size_t count) {
  if (type == Type::kVector3 && count != 3) throw InputError(fmt::format("{} numbers given, must be three", count));
  if (const std::size_t group = group_size(type); count % group != 0)
    throw InputError(fmt::format("{} numbers given, must be groups of {}", count, group));
}

template <class Number, class Read>
std::vector<Number> read_list(std::string_view text, const Read& read) {
  std::vector<Number> numbers;
  for_each_word(text, [&](std::string_view word) { read(word, numbers); });
  return numbers;
}

Value parsed(Type type, std::string_view text) {
  switch (type) {
    case Type::kBool:
      return read_bool(only_word(text));
    case Type::kInteger:
      return read_integer(only_word(text));
    case Type::kReal:
      return read_real(only_word(text));
    case Type::kWord:
      return std::string(only_word(text));
    case Type::kVector3:
    case Type::kReals:
    case Type::kVectors3:
    case Type::kBoxes:
      return read_list<double>(text, [](std::string_view word, auto& all) { all.push_back(read_real(word)); });
    case Type::kIntegers:
    case Type::kHexahedra:
      return read_list<std::int64_t>(text, read_integers);
    case Type::kLink:
      throw InputError(fmt::format("{} must be a link: @path", quoted(text)));
    case Type::kText:
      break;
  }
  return std::string(text);
}

}  // namespace

bool is_plain_name(std::string_view name) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  return !name.empty() && name.find_first_not_of(kPlain) == name.npos;
}

Value read_value(const Attribute& attribute, std::string_view text) {
  Value value = parsed(attribute.type, text);
  check_value(attribute, value);
  return value;
}

std::string write_value(const Value& value) {
  const auto write = [](const auto& content) {
    using Content = std::decay_t<decltype(content)>;
    if constexpr (std::is_same_v<Content, std::monostate>)
      return std::string();
    else if constexpr (std::is_arithmetic_v<Content> || std::is_same_v<Content, std::string>)
      return fmt::format("{}", content);
    else
      return fmt::format("{}", fmt::join(content, " "));
  };
  return std::visit(write, value);
}

void check_value(const Attribute& attribute, const Value& value) {
  const auto check = [&](const auto& content) {
    using Content = std::decay_t<decltype(content)>;
    if constexpr (std::is_same_v<Content, std::string>) {
      const bool is_word = attribute.type == Type::kWord;
      const std::string error = is_word ? attributes::unknown_word(content, split_words(attribute.words)) : "";
      if (!error.empty()) throw InputError(error);
    } else if constexpr (std::is_arithmetic_v<Content>) {
      if constexpr (!std::is_same_v<Content, bool>) check_range(attribute.range, content);
    } else if constexpr (!std::is_same_v<Content, std::monostate>) {
      check_count(attribute.type, content.size());
      for (const auto number : content) check_range(attribute.range, number);
    }
  };
  std::visit(check, value);
}

}  // namespace hexaplast::scene
