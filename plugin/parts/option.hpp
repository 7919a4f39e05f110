// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "attributes/attribute.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/types.hpp"

/// What every host runs: plain objects that are made from a struct of options. They name no type of a host.
namespace hexaplast::parts {

/// "groupSize" of "group_size": what scenes call an option.
std::string attribute_name(std::string_view option);

/// An option that cannot be accepted. what() names the member; a host names its attribute instead.
class OptionError : public InputError {
 public:
  OptionError(std::string_view option, const std::string& reason);

  const std::string& attribute() const { return attribute_; }  ///< what scenes call the option
  const std::string& reason() const { return reason_; }

 private:
  std::string attribute_, reason_;
};

/// What a part says about an option without refusing it.
struct Warning {
  std::string attribute;  ///< what scenes call the option
  std::string text;
};

/// Checks options against the ranges that the attribute table has for them. Throws OptionError.
class OptionRanges {
 public:
  explicit OptionRanges(const attributes::Description& table) : table_(table) {}

  void check(std::string_view option, double number) const;
  void check(std::string_view option, int number) const;
  void check(std::string_view option, std::span<const double> numbers) const;
  void check(std::string_view option, std::span<const int> numbers) const;
  template <class Derived>
  void check(std::string_view option, const Eigen::PlainObjectBase<Derived>& numbers) const {
    check(option, std::span<const double>(numbers.data(), static_cast<std::size_t>(numbers.size())));
  }

 private:
  template <class Number>
  void check_each(std::string_view option, std::span<const Number> numbers) const;

  const attributes::Description& table_;
};

/// Throws OptionError for a node that a state of `num_nodes` nodes has not.
void check_nodes(std::string_view option, std::span<const int> nodes, int num_nodes);

}  // namespace hexaplast::parts
