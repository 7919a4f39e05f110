// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "attributes/attribute.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/types.hpp"

/// What every host runs: plain objects that are made from a struct of options. They name no type of a host.
///
/// Options::each(options, visit) calls visit(name, member) for each option that scenes give. Hosts read their
/// attributes along this list, ranges are checked along it, and a test compares it with the attribute table.
#define HEXAPLAST_OPTION(member) visit(#member, options.member)

namespace hexaplast::parts {

/// "groupSize" of "group_size": what scenes call an option.
std::string attribute_name(std::string_view option);

/// What a part says about an option.
struct Remark {
  std::string attribute;  ///< what scenes call the option
  std::string text;
};

/// Options that cannot be accepted. what() names the members, one line each; a host names its attributes instead.
class OptionError : public InputError {
 public:
  OptionError(std::string_view option, const std::string& reason);

  const std::vector<Remark>& reasons() const { return reasons_; }

 private:
  friend class OptionErrors;
  OptionError(const std::string& what, std::vector<Remark> reasons) : InputError(what), reasons_(std::move(reasons)) {}

  std::vector<Remark> reasons_;
};

/// Errors of several checks, so that all are said at once.
class OptionErrors {
 public:
  /// An option that has an error already keeps that one.
  void add(const OptionError& error);

  /// Adds the OptionError that `check` throws.
  template <class Check>
  void collect(const Check& check) {
    try {
      check();
    } catch (const OptionError& error) {
      add(error);
    }
  }

  /// Whether that option has no error so far.
  bool accepts(std::string_view option) const;

  bool empty() const { return reasons_.empty(); }

  /// Throws all as one OptionError, if there are any.
  void throw_all() const;

 private:
  std::string what_;
  std::vector<Remark> reasons_;
};

/// Options that lie outside of the ranges that the attribute table has for them, for further checks to be added.
class OptionRanges : public OptionErrors {
 public:
  template <class Options>
  OptionRanges(const attributes::Description& table, const Options& options) : table_(table) {
    Options::each(options, [this](std::string_view option, const auto& member) { this->check(option, member); });
  }

 private:
  template <class T>
  void check(std::string_view option, const std::optional<T>& member) {
    if (member) check(option, *member);
  }
  template <class T>
  void check(std::string_view option, const T& member) {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>)
      check_numbers(option, std::span(&member, 1));
    else if constexpr (requires { std::span(member.data(), static_cast<std::size_t>(member.size())); })
      check_numbers(option, std::span(member.data(), static_cast<std::size_t>(member.size())));
    else
      static_assert(std::is_same_v<T, bool> || std::is_enum_v<T>, "a new type: teach it here");
  }
  void check_numbers(std::string_view option, std::span<const double> numbers);
  void check_numbers(std::string_view option, std::span<const int> numbers);
  void check_numbers(std::string_view, std::span<const Triangle>) {}  // by whoever knows the nodes

  const attributes::Description& table_;
};

/// Throws OptionError for a number that a range does not contain, or that is not finite.
void check_range(std::string_view option, const attributes::Range& range, double number);

/// Throws OptionError for a value that a row does not admit.
template <class Options>
void check_admissible(const Row<Options>& row, double value) {
  if (row.admits(value)) return;
  check_range(row.name, row.range, value);
  throw OptionError(row.name, "must " + row.condition());
}

/// Throws OptionError for a node that a state of `num_nodes` nodes has not.
void check_nodes(std::string_view option, std::span<const int> nodes, int num_nodes);

/// Throws OptionError for a word that is none of `words`.
void check_word(std::string_view option, std::span<const std::string_view> words, std::string_view word);

/// The place of a word among those of an attribute, which are in the order of an enumeration. Throws OptionError.
std::size_t place_of_word(const attributes::Attribute& attribute, std::string_view word);

}  // namespace hexaplast::parts
