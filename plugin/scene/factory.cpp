// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/factory.hpp"

#include <fmt/format.h>

#include "scene/plugin.hpp"

namespace hexaplast::scene {

void Factory::add(const attributes::Description& description, Make make) {
  const auto [entry, is_new] =
      entries_.try_emplace(std::string(description.class_name), Entry{&description, std::move(make)});
  if (!is_new) throw PluginError(fmt::format("component {} is registered twice", description.class_name));
}

std::unique_ptr<Component> Factory::make(std::string_view class_name) const {
  const auto found = entries_.find(class_name);
  return found == entries_.end() ? nullptr : found->second.make();
}

std::vector<const attributes::Description*> Factory::descriptions() const {
  std::vector<const attributes::Description*> all;
  for (const auto& [key, entry] : entries_) all.push_back(entry.description);
  return all;
}

}  // namespace hexaplast::scene
