// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/component.hpp"

/// What the user does to a scene while it runs, in the form that a scene file has.
namespace hexaplast::view {

/// The motion of an instrument from grab to release: a component of one node.
struct InstrumentMotion {
  const scene::Node* node = nullptr;
  std::string class_name;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< but for the path
  std::vector<double> key_times;                                ///< [s]
  std::vector<double> positions;                                ///< [m] three per key time
  std::vector<double> orientations;                             ///< quaternions x y z w, one per key time, or none
};

/// An attribute that was changed.
struct Change {
  double time = 0;  ///< [s]
  scene::Component* component = nullptr;
  std::string attribute;
  std::optional<std::string> value;  ///< none: as if it were not given
};

/// All actions since the beginning of the run, in order of time.
struct UserActions {
  long num_steps = 0;
  std::vector<InstrumentMotion> motions;
  std::vector<Change> changes;
};

}  // namespace hexaplast::view
