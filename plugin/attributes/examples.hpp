// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>
#include <vector>

/// Lines of XML that show each component in use (examples.xml).
namespace hexaplast::attributes {

/// A scene that runs, for the examples to stand in: they go into its node `body`.
std::string_view example_scene();

struct Example {
  std::string_view class_name = {};
  std::string_view lines = {};
};

/// Where none is listed, the component without attributes is the example.
const std::vector<Example>& examples();

}  // namespace hexaplast::attributes
