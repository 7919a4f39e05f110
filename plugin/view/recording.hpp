// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scene/document.hpp"
#include "view/user_actions.hpp"

namespace hexaplast::scene {
class Scene;
}

namespace hexaplast::view {

/// The text of a scene that repeats what was done to another one in a session: the elements of that scene, an
/// instrument for each motion of one, an AttributeChange for each attribute that was changed, and the number of steps.
/// Headless it moves with the same bits.
///
/// document: read_document of the scene's file. overrides: PATH.attribute=VALUE, which become attributes. folder: where
/// the text will lie; the meshes that the scene names are named from there.
std::string recorded_scene(scene::Scene& scene, scene::Element document, std::span<const std::string> overrides,
                           const UserActions& actions, const std::filesystem::path& folder);

}  // namespace hexaplast::view
