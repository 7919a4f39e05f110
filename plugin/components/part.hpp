// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "parts/key_times.hpp"
#include "parts/option.hpp"
#include "scene/object.hpp"

/// Between a component and the part that it makes from its attributes.
namespace hexaplast::components {

/// What `call` returns. The first option that a part refuses is the attribute of that name, at its place
/// in the scene.
template <class Call>
decltype(auto) accepted(scene::Object& owner, const Call& call) {
  try {
    return call();
  } catch (const parts::OptionError& error) {
    owner.reject(error.reasons().front().attribute, error.reasons().front().text);
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
