// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "support/files.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
namespace fs = std::filesystem;
using support::at;

/// A folder of its own for each test, with a scene in scenes/.
class SceneSearchPath : public testing::Test {
 protected:
  SceneSearchPath() {
    write("scenes/a.scn", "<Node><include href='parts/part.xml'/></Node>");
    write("one/parts/part.xml", part("mesh/m.obj"));
  }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories((directory_ / name).parent_path());
    support::put(directory_ / name, text);
  }

  static std::string part(const std::string& mesh) {
    return "<Node name='Group'><MeshOBJLoader name='mesh' filename='" + mesh + "'/></Node>";
  }

  /// A triangle whose first corner lies at x.
  void write_mesh(const std::string& name, double x) {
    write(name, "v " + std::to_string(x) + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }

  scene::Scene read() {
    scene::Scene scene =
        scene::read_scene(directory_ / "scenes/a.scn", support::factory(), support::plugins(),
                          scene::SearchPath({directory_ / "none", directory_ / "one", directory_ / "two"}));
    scene.init();
    return scene;
  }

  std::string errors() {
    try {
      read();
      return "";
    } catch (const scene::SceneError& error) {
      return error.what();
    }
  }

  const support::Scratch directory_;
};

double first_x(scene::Scene& scene) { return at<scene::Component>(scene, "mesh").reals("position")[0]; }

TEST_F(SceneSearchPath, TheFileItselfComesFirstThenTheDirectoriesInTheirOrder) {
  write_mesh("two/mesh/m.obj", 2);
  {
    scene::Scene scene = read();
    EXPECT_EQ(first_x(scene), 2);
    // what is read is never written over
    EXPECT_FALSE(scene.root().files().inputs.replaced_by(directory_ / "two/mesh/m.obj").empty());
    EXPECT_FALSE(scene.root().files().inputs.replaced_by(directory_ / "one/parts/part.xml").empty());
  }
  write_mesh("one/mesh/m.obj", 1);
  {
    scene::Scene scene = read();
    EXPECT_EQ(first_x(scene), 1);
  }
  write_mesh("one/parts/mesh/m.obj", 3);  // beside the file that names it
  scene::Scene scene = read();
  EXPECT_EQ(first_x(scene), 3);
}

TEST_F(SceneSearchPath, WhatIsNowhereIsRefusedWithThePlaces) {
  EXPECT_NE(errors().find("  hint: looked for in " + (directory_ / "none").string() + ", "), std::string::npos)
      << errors();
  fs::remove(directory_ / "one/parts/part.xml");
  EXPECT_NE(errors().find("include.href: 'parts/part.xml': no such file\n  hint: looked for in " +
                          (directory_ / "none").string() + ", "),
            std::string::npos)
      << errors();
}

TEST_F(SceneSearchPath, NamesThatLeadUpwardsCountFromTheirFileAlone) {
  write("one/parts/part.xml", part("../m.obj"));
  write_mesh("m.obj", 7);  // one/../m.obj
  EXPECT_NE(errors().find("no such file"), std::string::npos);
  EXPECT_EQ(errors().find("hint"), std::string::npos) << errors();
}

}  // namespace
