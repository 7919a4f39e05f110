// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/node.hpp"

namespace hexaplast::scene {

/// Category of what stands for an unknown component, which is an error by itself: links to it are none.
inline constexpr std::string_view kUnknown = "Unknown";

/// Where a path leads. Paths are SOFA's: `/from/the/root`, `./here`, `../above`, `name/inner`. A bare first name is
/// looked for in the node, nodes before components, then in the nodes above. What nothing is named after may be a
/// class, if a node holds a single component of it.
struct PathResult {
  Object* target = nullptr;  ///< a Node or a Component; null: not found
  std::string problem = {};  ///< where it stopped and why, if not found
  std::string hint = {};
};

/// `from`: the node that the path starts in.
PathResult resolve_path(Node& from, std::string_view path);

/// What to write instead of an attribute that the object had in earlier versions, or the nearest of `names`; empty:
/// none.
std::string hint_of(const Object& object, std::string_view name, const std::vector<std::string_view>& names);

/// Connects one link with its target. Adds to `diagnostics` where it leads nowhere or to another type.
void resolve_link(Data& data, Diagnostics& diagnostics);

/// Connects every link of the scene with its target, wherever in the scene it stands; `src` connects all attributes
/// that two components have in common. Adds dangling links, links between different types and circles of links to
/// `diagnostics`.
void resolve_links(Node& root, Diagnostics& diagnostics);

}  // namespace hexaplast::scene
