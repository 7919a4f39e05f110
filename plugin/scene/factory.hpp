// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/node.hpp"

namespace hexaplast::scene {

/// The component classes that scenes may name.
class Factory {
 public:
  using Make = std::function<std::unique_ptr<Component>()>;

  /// T is default-constructible. Throws PluginError when the class name is taken.
  template <class T>
  void add(const attributes::Description& description) {
    add(description, [] { return std::make_unique<T>(); });
  }
  void add(const attributes::Description& description, Make make);

  /// Null: no such class.
  std::unique_ptr<Component> make(std::string_view class_name) const;

  /// Every class, by name.
  std::vector<const attributes::Description*> descriptions() const;

 private:
  struct Entry {
    const attributes::Description* description;
    Make make;
  };
  std::map<std::string, Entry, std::less<>> entries_;  // by class
};

}  // namespace hexaplast::scene
