// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// What SOFA scenes hold that has no effect here: whole components, and attributes of others.
namespace hexaplast::attributes {

/// An attribute that is accepted unread.
constexpr Attribute ignored_attribute(std::string_view name, std::string_view help) {
  return free_text(name, {.access = Access::kIgnored}, help);
}
constexpr Attribute visual_attribute(std::string_view name) { return ignored_attribute(name, "Visual: ignored here."); }

template <class... Names>
constexpr std::array<Attribute, sizeof...(Names)> visual_attributes(Names... names) {
  return {visual_attribute(names)...};
}
inline constexpr auto kDrawnCells =
    visual_attributes("drawEdges", "drawTriangles", "drawQuads", "drawTetrahedra", "drawHexahedra");

/// A component that is accepted with whatever attributes it has.
constexpr Description ignored_component(std::string_view class_name, std::string_view category, std::string_view help) {
  return {.class_name = class_name, .category = category, .help = help, .takes_anything = true};
}
constexpr Description visual_component(std::string_view class_name) {
  return ignored_component(class_name, "Visual", "visual: ignored here");
}
constexpr Description bookkeeping_component(std::string_view class_name) {
  return ignored_component(class_name, "Bookkeeping", "bookkeeping of SOFA: not needed here");
}

/// Drawing: a note. Bookkeeping: nothing is lost, nothing is said.
inline constexpr Description kIgnoredComponents[] = {
    visual_component("BackgroundSetting"),
    visual_component("DefaultVisualManagerLoop"),
    visual_component("DirectionalLight"),
    visual_component("LightManager"),

    bookkeeping_component("HexahedronSetTopologyModifier"),
    bookkeeping_component("HexahedronSetGeometryAlgorithms"),
    bookkeeping_component("QuadSetTopologyModifier"),
    bookkeeping_component("QuadSetGeometryAlgorithms"),
    bookkeeping_component("TriangleSetGeometryAlgorithms"),
};

}  // namespace hexaplast::attributes
