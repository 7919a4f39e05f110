// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/formats/whole_file.hpp"
#include "scene/diagnostics.hpp"
#include "scene/scene_files.hpp"

namespace hexaplast::scene {

/// `name="value"` of an element.
struct ElementAttribute {
  std::string name, value;
  Place place;
};

/// An element of a scene file.
struct Element {
  std::string tag;
  Place place;
  std::vector<ElementAttribute> attributes;
  std::vector<Element> children;
  std::optional<Place> text = {};  ///< where it holds text, which no element of a scene may

  const ElementAttribute* find(std::string_view name) const;  ///< null: not given
};

inline constexpr std::uintmax_t kLargestSceneFile = 64 * 1024 * 1024;  // [byte]; larger meshes belong into mesh files
inline constexpr int kMaxIncludeLevels = 16;
inline constexpr int kMaxIncludes = 1000;  // in all: files that include one another twice would double at each level

/// The text of a scene file. Throws InputError saying why it cannot be read.
std::string read_scene_file(const std::filesystem::path& file);

/// The root element of a scene, from the text of `file`, all includes carried out. UTF-8 without NUL, one root, no
/// document type, no entities but XML's five; numbers of elements, attributes and levels as above.
///
/// `<include href="FILE" name="N"/>` stands for the root element of FILE, a path relative to the including file, or in
/// a directory of `search`. `name` renames that root. A root named Group is replaced by its children.
///
/// Includes that cannot be carried out are left out and added to `diagnostics`; a file that is not well-formed is a
/// SceneError. The files that are included are added to `inputs`.
Element read_document(std::string_view text, const std::filesystem::path& file, Diagnostics& diagnostics,
                      InputFiles* inputs = nullptr, const SearchPath& search = {});

/// The text of an element and of what is in it, in UTF-8, as a file of its own. `comment`: before the root; must not
/// have `--` in it.
std::string write_document(const Element& root, const std::string& comment);

/// What a scene file says of itself.
struct Description {
  std::string heading;  ///< "Forceps lift a strip of fat"
  std::string words;    ///< a paragraph
};

/// From the last comment before the scene's root node, where that begins with a line and a paragraph after it. None: it
/// does not, or the file cannot be read.
std::optional<Description> description_of(const std::filesystem::path& file);

}  // namespace hexaplast::scene
