// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
namespace fs = std::filesystem;
using support::at;

/// A SOFA tree of its own for each test, with a scene in examples/Demos.
class SceneSearchPath : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    directory_ = fs::path(testing::TempDir()) / (std::string("hexaplast_search_") + info->name());
    fs::remove_all(directory_);
    write("examples/Demos/a.scn", "<Node><include href='Objects/part.xml'/></Node>");
  }
  void TearDown() override { fs::remove_all(directory_); }

  void write(const fs::path& name, const std::string& text) {
    fs::create_directories((directory_ / name).parent_path());
    std::ofstream(directory_ / name) << text;
  }

  /// A triangle whose first corner lies at x.
  void write_mesh(const fs::path& name, double x) {
    write(name, "v " + std::to_string(x) + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }

  scene::Scene read(const scene::SearchPath& search = {}) {
    return scene::read_scene(directory_ / "examples/Demos/a.scn", support::factory(), support::plugins(),
                             scene::Grammar::kStrict, search);
  }

  std::string errors() {
    try {
      read().init();
      return "";
    } catch (const scene::SceneError& error) {
      return error.what();
    }
  }

  fs::path directory_;
};

constexpr const char* kLoader = "<Node name='Group'><MeshOBJLoader name='mesh' filename='mesh/m.obj'/></Node>";

double first_x(scene::Scene& scene) { return at<scene::Component>(scene, "mesh").reals("position")[0]; }

TEST_F(SceneSearchPath, AScenePathIsCompletedByTheSofaTreeThatItLiesIn) {
  write("examples/Objects/part.xml", kLoader);
  write_mesh("share/mesh/m.obj", 7);
  scene::Scene scene = read();
  scene.init();
  EXPECT_EQ(first_x(scene), 7);
  // what is read is never written over
  EXPECT_FALSE(scene.root().files().inputs.replaced_by(directory_ / "share/mesh/m.obj").empty());
  EXPECT_FALSE(scene.root().files().inputs.replaced_by(directory_ / "examples/Objects/part.xml").empty());
}

TEST_F(SceneSearchPath, AnInstallationHasItsMeshesBesideTheExamples) {
  write("examples/Objects/part.xml", kLoader);
  write_mesh("mesh/m.obj", 8);
  scene::Scene scene = read();
  scene.init();
  EXPECT_EQ(first_x(scene), 8);
}

TEST_F(SceneSearchPath, TheFileItselfComesFirstThenTheGivenDirectoriesInTheirOrder) {
  write("examples/Objects/part.xml", kLoader);
  write_mesh("share/mesh/m.obj", 7);
  write_mesh("one/mesh/m.obj", 1);
  write_mesh("two/mesh/m.obj", 2);
  const scene::SearchPath given({directory_ / "none", directory_ / "two", directory_ / "one"});
  {
    scene::Scene scene = read(given);
    scene.init();
    EXPECT_EQ(first_x(scene), 2);
  }
  write_mesh("examples/Objects/mesh/m.obj", 3);  // beside the file that names it
  scene::Scene scene = read(given);
  scene.init();
  EXPECT_EQ(first_x(scene), 3);
}

TEST_F(SceneSearchPath, WhatIsNowhereIsRefusedWithThePlaces) {
  fs::create_directories(directory_ / "share/mesh");
  EXPECT_NE(errors().find("include.href: 'Objects/part.xml': no such file\n  hint: looked for in " +
                          fs::weakly_canonical(directory_ / "share").string() + ", "),
            std::string::npos)
      << errors();
  write("examples/Objects/part.xml", kLoader);
  EXPECT_NE(errors().find("  hint: looked for in "), std::string::npos) << errors();
}

TEST_F(SceneSearchPath, NamesThatLeadUpwardsCountFromTheSceneAlone) {
  write("examples/Objects/part.xml", "<Node name='Group'><MeshOBJLoader name='mesh' filename='../m.obj'/></Node>");
  write_mesh("m.obj", 7);  // share/../m.obj
  fs::create_directories(directory_ / "share/mesh");
  EXPECT_NE(errors().find("no such file"), std::string::npos);
  EXPECT_EQ(errors().find("hint"), std::string::npos) << errors();
}

}  // namespace
