// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scene/scene.hpp"

namespace hexaplast::runner {

/// A number of a scene that a fit is free to choose within limits. Its fraction of the way between them is in [0, 1]:
/// of the difference or, on a logarithmic scale, of the factor.
struct FreeAttribute {
  std::string name;  ///< PATH.attribute
  double min = 0, max = 1;
  bool is_logarithmic = false;
  std::string unit = {};
  std::optional<double> given = {};  ///< the scene's own value, where it lies within the limits

  double value(double fraction) const;
  double fraction(double value) const;
  double start() const { return given ? fraction(*given) : 0.5; }
};

/// Reads PATH.attribute=lo:hi, with :log or :linear behind it; without them the scale is logarithmic where lo > 0 and
/// hi is ten times lo or more. Then looks the attribute up in a scene that is read. Throws UsageError and
/// OverrideError.
FreeAttribute parse_free(std::string_view text, scene::Scene& scene);

/// As the command line takes it; six digits.
std::string written(double value);

}  // namespace hexaplast::runner
