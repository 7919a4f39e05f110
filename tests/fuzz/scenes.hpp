// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/reader.hpp"

namespace hexaplast::fuzz {

inline constexpr std::string_view kSmallScene = R"(<Node name="root" dt="0.01">
  <RegularGridTopology name="grid" n="2 2 3" min="0 0 0" max="1 1 2"/>
  <Node name="body">
    <MechanicalObject name="nodes" src="@../grid"/>
    <HexahedronElastoplasticFEMForceField name="material" youngModulus="5000" yieldStress="300" plasticFlowRate="2"/>
    <FixedProjectiveConstraint indices="0 1"/>
  </Node>
</Node>)";

/// With the components of the build tree's plugin. Throws as read_scene_text does.
inline scene::Scene read(std::string_view text) {
  static scene::Factory factory;
  static scene::PluginLoader plugins = [] {
    scene::PluginLoader loader(factory, {HEXAPLAST_TEST_PLUGINS});
    loader.load("Hexaplast");
    return loader;
  }();
  return scene::read_scene_text(text, "/no/such/folder/any.scn", factory, plugins);
}

}  // namespace hexaplast::fuzz
