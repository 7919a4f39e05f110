// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "components/cells.hpp"
#include "parts/key_times.hpp"
#include "parts/option.hpp"
#include "scene/object.hpp"

/// Between a component and the part that it makes from its attributes.
namespace hexaplast::components {

/// An option from the attribute that has its name.
template <class T>
void read_option(scene::Object& owner, const std::string& name, T& option) {
  if constexpr (std::is_same_v<T, bool>) {
    option = owner.boolean(name);
  } else if constexpr (std::is_same_v<T, int>) {
    option = owner.integer(name);
  } else if constexpr (std::is_same_v<T, double>) {
    option = owner.real(name);
  } else if constexpr (std::is_enum_v<T>) {
    option = static_cast<T>(parts::place_of_word(owner.find_data(name)->attribute(), owner.text(name)));
  } else if constexpr (std::is_same_v<T, Vec3>) {
    option = owner.vector3(name);
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    option = owner.reals(name);
  } else if constexpr (std::is_same_v<T, std::vector<int>>) {
    option = owner.indices(name, std::numeric_limits<int>::max());
  } else if constexpr (std::is_same_v<T, PointArray>) {
    option = owner.vectors3(name);
  } else {
    option = cells_of<3>(owner, name, std::numeric_limits<int>::max());
  }
}
template <class T>
void read_option(scene::Object& owner, const std::string& name, std::optional<T>& option) {
  if (owner.has_value(name)) read_option(owner, name, option.emplace());
}

/// The options of a part from the attributes of its component.
template <class Options>
Options read_options(scene::Object& owner) {
  Options options;
  Options::each(options, [&](std::string_view option, auto& member) {
    read_option(owner, parts::attribute_name(option), member);
  });
  return options;
}

/// What `call` returns. What it refuses, the scene is rejected for: the first option that a part refuses is the
/// attribute of that name, at its place in the scene.
template <class Call>
decltype(auto) accepted(scene::Object& owner, const Call& call) {
  try {
    return call();
  } catch (const parts::OptionError& error) {
    owner.reject(error.reasons().front().attribute, error.reasons().front().text);
  } catch (const InputError& error) {
    owner.reject(error.what());
  }
}
/// The same of what an attribute gives.
template <class Call>
decltype(auto) accepted(scene::Object& owner, std::string_view attribute, const Call& call) {
  try {
    return call();
  } catch (const InputError& error) {
    owner.reject(attribute, error.what());
  }
}

inline void pass_on(scene::Object& owner, const std::vector<parts::Remark>& warnings) {
  for (const parts::Remark& warning : warnings)
    owner.remark(scene::Severity::kWarning, warning.attribute, warning.text);
}

/// The key times of a history, with one entry of the attribute `values` each (parts::check_key_times).
inline const std::vector<double>& key_times(scene::Object& owner, std::string_view times, std::string_view values,
                                            std::size_t num_values) {
  const std::vector<double>& keys = owner.reals(times);
  accepted(owner, [&] { parts::check_key_times(times, keys, values, num_values); });
  return keys;
}

}  // namespace hexaplast::components
