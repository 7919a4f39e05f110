// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>

#include "scene/object.hpp"

namespace hexaplast::scene {

/// What a component is besides, that has outputs which its description cannot know: arrays of a file, by their names.
class ArraySource {
 public:
  virtual ~ArraySource() = default;

  /// The output of that name; null: there is none. Asked for while links are connected, and only for names that are no
  /// attribute of the component.
  virtual Data* array(std::string_view name) = 0;
};

}  // namespace hexaplast::scene
