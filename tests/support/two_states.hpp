// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "support/scene.hpp"

/// Scenes of two mechanical states `first/state` and `second/state`.
namespace hexaplast::support {

inline std::string node(const std::string& name, const std::string& content) {
  return "<Node name='" + name + "'>" + content + "</Node>";
}

inline const PointArray& positions(scene::Scene& scene, const std::string& state) {
  return at<scene::MechanicalState>(scene, state + "/state").positions();
}

inline PointArray both(scene::Scene& scene) {
  PointArray all(positions(scene, "first").rows() + positions(scene, "second").rows(), 3);
  all << positions(scene, "first"), positions(scene, "second");
  return all;
}

}  // namespace hexaplast::support
