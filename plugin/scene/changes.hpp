// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/archive.hpp"
#include "scene/scene.hpp"

namespace hexaplast::scene {

/// Names of the attributes that may change during a run; empty: the component reads them once, when the scene begins.
std::vector<std::string_view> attributes_that_may_change(Component& component);

/// Changes of attributes from outside, between two steps. Components follow them at the beginning of the next step, as
/// they follow an AttributeChange.
class Changes {
 public:
  /// The scene must outlive this.
  explicit Changes(Scene& scene) : scene_(scene) {}

  /// name: PATH.attribute; text: as a scene writes it, none: as if it were not given. Throws OverrideError where there
  /// is no such attribute, where it cannot change, and where the text is no value of it; nothing has changed then.
  void set(const std::string& name, const std::optional<std::string>& text);

  /// All are again as they were before. To be followed by Scene::reset.
  void put_back();

  /// The attributes that have changed, with their present values. Reading puts them into a scene that has been put
  /// back.
  void serialize(Archive& archive);

 private:
  struct Change {
    std::string name;
    Data& data;
    Data::Given before;
  };

  Scene& scene_;
  std::vector<Change> all_;  // each attribute once
};

}  // namespace hexaplast::scene
