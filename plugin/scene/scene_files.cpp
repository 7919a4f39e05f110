// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/scene_files.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hexaplast::scene {

namespace fs = std::filesystem;

namespace {

bool leads_somewhere(const fs::path& file) {
  std::error_code unknown;
  return fs::exists(file, unknown);
}

}  // namespace

bool SearchPath::looks_for(const fs::path& name) const {
  return !directories_.empty() && name.is_relative() && std::find(name.begin(), name.end(), "..") == name.end();
}

fs::path SearchPath::find(const fs::path& name, const fs::path& folder) const {
  const fs::path beside = folder / name;
  if (!looks_for(name) || leads_somewhere(beside)) return beside;
  const auto found =
      std::ranges::find_if(directories_, [&](const fs::path& directory) { return leads_somewhere(directory / name); });
  return found == directories_.end() ? beside : *found / name;
}

std::string SearchPath::places_of(const fs::path& name) const {
  if (!looks_for(name)) return {};
  std::string places;
  for (const fs::path& directory : directories_)
    places += fmt::format("{}{}", places.empty() ? "" : ", ", directory.string());
  return fmt::format("looked for in {} too", places);
}

}  // namespace hexaplast::scene
