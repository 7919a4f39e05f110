// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace hexaplast {

class Archive;

/// Admissible values of a number, or of each number of a list. NaN lies in no range.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool exclusive_min = false;  ///< `min` itself is not admissible
  bool exclusive_max = false;

  constexpr bool contains(double value) const {
    return (exclusive_min ? value > min : value >= min) && (exclusive_max ? value < max : value <= max);
  }

  bool operator==(const Range&) const = default;
};

/// By which of its two names a message calls a member.
enum class Names {
  kMembers,  ///< that of C++ and Python: young_modulus
  kScenes    ///< that of scenes, for hosts that read them: youngModulus
};

enum class MemberType {
  kReal,
  kInteger,
  kWord,  ///< an enumeration, counted from 0
  kReals  ///< a list of numbers
};

/// A member of a struct, reached as a number whatever its type; a kReals as its list.
template <class Options>
struct Member {
  MemberType type = MemberType::kReal;
  double (*get)(const Options&) = nullptr;
  void (*set)(Options&, double) = nullptr;  ///< cuts a number down to what the type holds; not for NaN
  std::vector<double> Options::*list = nullptr;
};

template <auto member, class Options>
constexpr Member<Options> member_at(std::vector<double> Options::*list) {
  return {.type = MemberType::kReals, .list = list};
}

template <auto member, class Options, class T>
constexpr Member<Options> member_at(T Options::*) {
  static_assert(std::is_same_v<T, double> || std::is_same_v<T, int> || std::is_enum_v<T>, "a new type: teach it here");
  return {std::is_enum_v<T>        ? MemberType::kWord
          : std::is_same_v<T, int> ? MemberType::kInteger
                                   : MemberType::kReal,
          [](const Options& options) { return static_cast<double>(options.*member); },
          [](Options& options, double value) {
            constexpr double kMin = std::numeric_limits<int>::min(), kMax = std::numeric_limits<int>::max();
            if constexpr (std::is_same_v<T, double>)
              options.*member = value;
            else
              options.*member = static_cast<T>(static_cast<int>(std::clamp(value, kMin, kMax)));
          },
          nullptr};
}

/// kMember<&Settings::averaging_steps>
template <auto member>
inline constexpr auto kMember = member_at<member>(member);

/// "[0, 0.5)", "(0, inf)"
std::string interval(const Range& range, bool with_infinity);
/// "blended, vertex or centre"
std::string alternatives(std::span<const std::string_view> words);

/// One member of a struct of options: what it is called, which values it takes, and how to reach it. What treats every
/// member of such a struct (validation, saved states, identity, attributes of components, keywords, documentation) goes
/// through its rows and names none of them.
template <class Options>
struct Row {
  std::string_view member = {};  ///< its name in C++ and Python
  std::string_view name = {};    ///< its name in scenes
  std::string_view group = {};   ///< hosts show members of one group together
  std::string_view unit = {};
  Range range = {};
  std::span<const std::string_view> words = {};  ///< of a kWord, in the order of its enumerators
  bool may_vary = false;                         ///< scenes may give a value for each hexahedron
  Range per_step = {};                           ///< of a rate: admissible products with the time step
  double recommended_per_step = std::numeric_limits<double>::infinity();  ///< above, results lose accuracy
  std::string_view help = {};                                             ///< members by their names in scenes
  Member<Options> at = {};

  std::string_view called(Names names) const { return names == Names::kScenes ? name : member; }

  /// The number, or those of a list.
  std::vector<double> values(const Options& options) const {
    return at.list ? options.*at.list : std::vector<double>{at.get(options)};
  }
  void set_values(Options& options, std::span<const double> numbers) const {
    if (at.list)
      (options.*at.list).assign(numbers.begin(), numbers.end());
    else
      at.set(options, numbers.front());
  }

  /// Whether an infinite value means that there is no such limit: the default then is infinite.
  bool may_be_infinite() const { return !at.list && std::isinf(at.get(Options{})); }

  bool admits(double value) const {
    if (at.type == MemberType::kWord) return value >= 0 && value < static_cast<double>(words.size());
    return range.contains(value) && (std::isfinite(value) || may_be_infinite());
  }

  /// "lie in [0, 0.5)", "be double or mixed": what a value must.
  std::string condition() const {
    if (at.type == MemberType::kWord) return "be " + alternatives(words);
    const std::string bounds = "lie in " + interval(range, may_be_infinite());
    return unit.empty() ? bounds : bounds + ' ' + std::string(unit);
  }
};

/// The row of that name; null: there is none.
template <class Options>
const Row<Options>* find_row(std::span<const Row<Options>> rows, std::string_view name, Names names) {
  const auto found = std::ranges::find_if(rows, [&](const Row<Options>& row) { return row.called(names) == name; });
  return found == rows.end() ? nullptr : &*found;
}

/// The place of a word among those of a row; -1: it is none of them.
template <class Options>
int place_of_word(const Row<Options>& row, std::string_view word) {
  const auto found = std::ranges::find(row.words, word);
  return found == row.words.end() ? -1 : static_cast<int>(found - row.words.begin());
}

/// A number as it lies in memory: 8 bytes of a kReal, 4 of the others.
void serialize(Archive& archive, MemberType type, double& number);
void serialize(Archive& archive, std::vector<double>& list);

/// All members, in the order of the rows.
template <class Options>
void serialize(Archive& archive, std::span<const Row<Options>> rows, Options& options) {
  for (const Row<Options>& row : rows) {
    if (row.at.list) {
      serialize(archive, options.*row.at.list);
      continue;
    }
    double number = row.at.get(options);
    serialize(archive, row.at.type, number);
    row.at.set(options, number);
  }
}

/// Stands for a value of any type where a compiler is asked how many an aggregate takes.
struct AnyValue {
  template <class T>
  operator T() const;
};

template <class Options, std::size_t... i>
constexpr bool takes_values(std::index_sequence<i...>) {
  return requires { Options{(static_cast<void>(i), AnyValue())...}; };
}

/// Members of an aggregate, to hold its rows against.
template <class Options, std::size_t count = 0>
constexpr std::size_t num_members() {
  if constexpr (takes_values<Options>(std::make_index_sequence<count + 1>()))
    return num_members<Options, count + 1>();
  else
    return count;
}

}  // namespace hexaplast
