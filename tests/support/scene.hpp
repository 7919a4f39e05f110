// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/reader.hpp"
#include "support/archive.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"

namespace hexaplast::support {

/// The components that scenes may name, loaded once from the build tree's plugin.
inline scene::Factory& factory() {
  static scene::Factory instance;
  return instance;
}
inline scene::PluginLoader& plugins() {
  static scene::PluginLoader instance = [] {
    scene::PluginLoader loader(factory(), {HEXAPLAST_TEST_PLUGINS});
    loader.load("Hexaplast");
    return loader;
  }();
  return instance;
}

/// A scene as read, not yet initialised.
inline scene::Scene read(std::string_view text) {
  scene::PluginLoader& loader = plugins();
  return scene::read_scene_text(text, "test.scn", factory(), loader);
}

inline scene::Scene read_and_init(std::string_view text) {
  scene::Scene scene = read(text);
  scene.init();
  return scene;
}

/// One that ships with the program, with attributes replaced as by --set.
inline scene::Scene shipped(const std::string& name, const std::vector<std::string>& assignments = {}) {
  scene::Scene scene =
      scene::read_scene(std::string(HEXAPLAST_SOURCE_DIR "/scenes/") + name + ".scn", factory(), plugins());
  for (const std::string& assignment : assignments) scene::override_attribute(scene, assignment);
  scene.init();
  return scene;
}

/// All errors of a scene, one after the other; empty when it can run.
inline std::string errors_of(std::string_view text) {
  try {
    read_and_init(text);
    return {};
  } catch (const scene::SceneError& error) {
    return error.what();
  } catch (const scene::FileError& error) {
    return error.what();
  }
}

/// Expects each piece of a scene, within what `frame` puts around it, to be refused with its message, that of line 1.
/// `who`: what all messages begin with.
template <class Frame>
void expect_errors(const Frame& frame, std::initializer_list<std::pair<std::string, std::string>> rows,
                   const std::string& who = "") {
  for (const auto& [piece, message] : rows)
    EXPECT_EQ(errors_of(frame(piece)), "test.scn:1: error: " + who + message) << piece;
}

/// What a scene has to say that is no error, one message behind the other.
inline std::string warnings_of(scene::Scene& scene) {
  std::string said;
  for (const scene::Message& warning : scene.diagnostics().take_warnings()) said += scene::format(warning) + "\n";
  return said;
}

/// What changes an attribute of a component at each of some times.
inline std::string attribute_change(const std::string& component, const std::string& attribute,
                                    const std::string& times, const std::string& values) {
  return "<AttributeChange component='@" + component + "' attribute='" + attribute + "' keyTimes='" + times +
         "' values='" + values + "'/>";
}

/// A component or node by its path from the root.
template <class T>
T& at(scene::Scene& scene, std::string_view path) {
  const std::size_t slash = path.rfind('/');
  scene::Node* node = &scene.root();
  for (std::string_view folder = slash == path.npos ? "" : path.substr(0, slash); !folder.empty();) {
    const std::string_view name = folder.substr(0, folder.find('/'));
    for (const auto& child : node->children())
      if (child->name() == name) node = child.get();
    folder.remove_prefix(std::min(folder.size(), name.size() + 1));
  }
  for (const auto& component : node->components())
    if (component->name() == path.substr(slash + 1)) return dynamic_cast<T&>(*component);
  throw std::out_of_range(std::string(path));
}

/// Where the points of the state `nodes` of the root are.
inline const PointArray& nodes(scene::Scene& scene) { return at<scene::MechanicalState>(scene, "nodes").positions(); }

inline PointArray& velocities(scene::Scene& scene) { return at<scene::MechanicalState>(scene, "nodes").velocities(); }

/// Of the force field of that path.
inline const Body& body(scene::Scene& scene, std::string_view path = "body") {
  return *at<scene::ForceField>(scene, path).body();
}

inline void run(scene::Scene& scene, int steps) {
  for (int k = 0; k < steps; ++k) scene.step();
}

/// All that a scene would write into a checkpoint.
inline std::vector<std::byte> saved(scene::Scene& scene) { return written(scene); }

/// Puts a scene where another one is, by way of a checkpoint.
inline void go_on_in(scene::Scene& from, scene::Scene& into) { read_from(saved(from), into); }

inline std::string in_node(const std::string& components) { return "<Node>" + components + "</Node>"; }

/// A scene with solvers and the given components.
inline std::string in_root(const std::string& attributes, const std::string& lines) {
  return "<Node " + attributes + "><DefaultAnimationLoop/><EulerImplicitSolver name='euler'/><SparseLDLSolver/>" +
         lines + "</Node>";
}

/// The same with four nodes without symmetry, one kilogram each, no gravity.
inline std::string four_nodes(const std::string& lines) {
  return in_root("gravity='0 0 0' dt='0.5'",
                 "<MechanicalObject name='nodes' position='1 0 0  0 2 0  0 0 3  -1 -1 4'/><UniformMass name='mass' "
                 "vertexMass='1'/>" +
                     lines);
}

/// What a force field of the scene makes at the present state of `nodes`.
inline PointArray force_of(scene::Scene& scene, std::string_view path, double time) {
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  PointArray f = PointArray::Zero(state.num_nodes(), 3);
  at<scene::ForceField>(scene, path).add_force(time, state.positions(), state.velocities(), f);
  return f;
}

inline PointArray rows(std::initializer_list<Vec3> values) {
  PointArray all(values.size(), 3);
  Eigen::Index n = 0;
  for (const Vec3& value : values) all.row(n++) = value.transpose();
  return all;
}

}  // namespace hexaplast::support
