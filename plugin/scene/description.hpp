// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace hexaplast::scene {

/// What a scene file says of itself.
struct Description {
  std::string heading;  ///< "Forceps lift a strip of fat"
  std::string words;    ///< a paragraph
};

/// From the last comment before the scene's root node, where that begins with a line and a paragraph after it. None: it
/// does not, or the file cannot be read.
std::optional<Description> description_of(const std::filesystem::path& file);

}  // namespace hexaplast::scene
