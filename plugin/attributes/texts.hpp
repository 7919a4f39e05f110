// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <string_view>
#include <vector>

/// Texts that stand in files of their own: lines of XML that show each component in use (examples.xml), and names that
/// scenes could have in earlier versions, with what to write instead (gone.names).
namespace hexaplast::attributes {

/// A scene that runs, for the examples to stand in: they go into its node `body`.
std::string_view example_scene();

struct Example {
  std::string_view class_name = {};
  std::string_view lines = {};
};

/// Where none is listed, the component without attributes is the example.
const std::vector<Example>& examples();

/// What to write instead of a component, CLASS.attribute, or .attribute of any class (gone.names).
const std::multimap<std::string_view, std::string_view>& gone();

/// The same of one name; empty: there never was one.
std::string_view instead_of(std::string_view name);

}  // namespace hexaplast::attributes
