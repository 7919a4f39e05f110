// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hexaplast/formats/mesh_import.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::in_root;
using support::read_and_init;
namespace fs = std::filesystem;

class Export : public testing::Test {
 protected:
  Export() : folder_(fs::temp_directory_path() / ("scene_export_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Export() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }
  scene::OutputRules below() const { return {.directory = folder_}; }
  std::string content(const std::string& name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::size_t num_files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  /// One node that falls.
  static std::string falling(const std::string& more) {
    return in_root(
        "gravity='0 0 -8' dt='0.5'",
        "<MechanicalObject name='nodes' position='1 0 0' velocity='0 2 0'/><UniformMass vertexMass='1'/>" + more);
  }

  static std::string box(const std::string& more) {
    return in_root("gravity='0 0 -9.81' dt='0.125'",
                   "<RegularGridTopology name='grid' n='3 2 2'/><MechanicalObject name='nodes'/>"
                   "<UniformMass totalMass='1'/>" +
                       more);
  }

 private:
  fs::path folder_;
};

// Read back by the reader of .vtu files, whose own tests rest on meshio.
TEST_F(Export, VtkFilesHoldTheStateWithAllItsBits) {
  scene::Scene scene = read_and_init(
      box("<VTKExporter filename='state.vtu' exportEveryNumberOfSteps='2' exportAtBegin='true' hexas='true' "
          "quads='1' edges='0' pointsDataFields='speed=nodes.velocity nodes.rest_position'/>"),
      below());
  const PointArray first = at<scene::MechanicalState>(scene, "nodes").positions();
  EXPECT_EQ(num_files(), 0u) << "nothing is written before a step";
  PointArray second;
  for (int k = 0; k < 5; ++k) {
    scene.step();
    if (k == 1) second = at<scene::MechanicalState>(scene, "nodes").positions();
  }
  EXPECT_EQ(num_files(), 3u);
  EXPECT_EQ(read_vtk(path("state0.vtu")).positions, first);
  const ImportedMesh mesh = read_vtk(path("state1.vtu"));
  EXPECT_EQ(mesh.positions, second);
  EXPECT_EQ(mesh.hexahedra, at<scene::Topology>(scene, "grid").hexahedra());
  EXPECT_EQ(mesh.quads.size(), 11u);
  EXPECT_TRUE(mesh.edges.empty());
  EXPECT_NE(content("state2.vtu").find("Name=\"speed\" NumberOfComponents=\"3\""), std::string::npos);
  EXPECT_NE(content("state2.vtu").find("Name=\"rest_position\""), std::string::npos);
}

TEST_F(Export, OneFileMayBeWrittenAgainAndAgain) {
  scene::Scene scene = read_and_init(box("<VTKExporter filename='state' exportEveryNumberOfSteps='1' overwrite='1'/>"
                                         "<VTKExporter filename='never' exportEveryNumberOfSteps='1' enable='0'/>"),
                                     below());
  for (int k = 0; k < 3; ++k) scene.step();
  EXPECT_EQ(num_files(), 1u);
  EXPECT_EQ(read_vtk(path("state.vtu")).positions, at<scene::MechanicalState>(scene, "nodes").positions());
  EXPECT_EQ(read_vtk(path("state.vtu")).edges.size(), 20u);
}

TEST_F(Export, OneThatIsNeverToWriteSaysSoAndOwnsNoFiles) {
  const auto remarks = [&](const std::string& attributes) {
    scene::Scene scene = read_and_init(box("<VTKExporter filename='state' " + attributes + "/>"), below());
    EXPECT_TRUE(scene.root().files().claimed().empty()) << attributes;
    scene.step();
    EXPECT_EQ(num_files(), 0u);
    std::string all;
    for (const scene::Message& message : scene.diagnostics().take_warnings()) all += message.text;
    return all;
  };
  EXPECT_EQ(remarks("enable='0' exportEveryNumberOfSteps='1'"), "");
  EXPECT_EQ(remarks(""), "VTKExporter: writes nothing: neither exportEveryNumberOfSteps nor exportAtBegin is given");
}

TEST_F(Export, OfANodeBelowShowsWhatFollows) {
  scene::Scene scene = read_and_init(
      box("<Node name='skin'><MeshTopology triangles='0 1 2'/><MechanicalObject name='points' position='.2 .2 .2  .9 "
          ".2 "
          ".4  .5 .8 .6'/><BarycentricMapping/><VTKExporter filename='skin' exportEveryNumberOfSteps='1' edges='0' "
          "triangles='1'/><WriteState filename='skin.txt' time='0.125'/></Node>"),
      below());
  scene.step();
  const ImportedMesh mesh = read_vtk(path("skin0.vtu"));
  EXPECT_EQ(mesh.positions, at<scene::MechanicalState>(scene, "skin/points").positions());
  EXPECT_NEAR(mesh.positions(1, 2), 0.4 - 9.81 * 0.125 * 0.125, 1e-14);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  scene.step();
  EXPECT_EQ(content("skin.txt").substr(0, 16), "T= 0.125\n  X= 0.");
}

// One node falls: at the beginning of step k it is where k steps have brought it.
TEST_F(Export, StatesAreWrittenAtTheBeginningOfSteps) {
  const auto written = [&](const std::string& attributes, int steps) {
    scene::Scene scene = read_and_init(falling("<WriteState filename='state.txt' " + attributes + "/>"),
                                       {.directory = path(""), .replaces = true});
    for (int k = 0; k < steps; ++k) scene.step();
    return content("state.txt");
  };
  EXPECT_EQ(written("writeV='1'", 3),
            "T= 0\n  X= 1 0 0\n  V= 0 2 0\nT= 0.5\n  X= 1 1 -2\n  V= 0 2 -4\nT= 1\n  X= 1 2 -6\n  V= 0 2 -8\n");
  EXPECT_EQ(written("time='0.5 1.5'", 9), "T= 0.5\n  X= 1 1 -2\nT= 1.5\n  X= 1 3 -12\n");
  EXPECT_EQ(written("time='0.5' period='1' writeX='0' writeX0='1'", 5), "T= 0.5\n  X0= 1 0 0\nT= 1.5\n  X0= 1 0 0\n");
}

TEST_F(Export, RefusesPlacesAndFieldsThatAreNot) {
  const std::string exporter = "test.scn:1: error: VTKExporter.";
  EXPECT_EQ(errors_of(box("<VTKExporter exportEveryNumberOfSteps='9' filename='" + path("none/state").string() + "'/>"),
                      {.allows_outside = true}),
            exporter + "filename: '" + path("none").string() + "' is no directory");
  EXPECT_EQ(errors_of(box("<VTKExporter pointsDataFields='nodes.speed'/>")),
            exporter + "pointsDataFields: 'nodes.speed': MechanicalObject has no attribute 'speed'");
  EXPECT_EQ(errors_of(box("<VTKExporter pointsDataFields='a=grid.n'/>")),
            exporter + "pointsDataFields: 'a=grid.n' holds no list of real numbers");
  EXPECT_NE(errors_of(box("<VTKExporter exportAtEnd='true'/>")), "");
  EXPECT_EQ(errors_of(box("<WriteState/>")), "test.scn:1: error: WriteState.filename: is not given, must name a file");
  scene::Scene scene = read_and_init(
      box("<VTKExporter filename='x' exportEveryNumberOfSteps='1' cellsDataFields='nodes.position'/>"), below());
  EXPECT_THROW(scene.step(), scene::SceneError);
}

// Whatever a scene says, what it writes lies below the directory that the host gave.
TEST_F(Export, GoesBelowItsDirectoryAlone) {
  fs::create_directories(path("run"));
  fs::create_directories(path("other"));
  fs::create_directory_symlink(path("other"), path("run/away"));
  fs::create_symlink(path("other/victim"), path("run/link.txt"));
  std::ofstream(path("other/victim")) << "mine";
  const scene::OutputRules inside{.directory = path("run"), .replaces = true, .how_outside = "ask for it"};
  for (const std::string& name :
       {path("other/x.txt").string(), path("run/x.txt").string(), std::string("../other/x.txt"),
        std::string("a/../../other/x.txt"), std::string("a/../x.txt"), std::string("away/x.txt"),
        std::string("link.txt"), std::string(".."), std::string("a/")}) {
    for (const char* exporter : {"WriteState", "VTKExporter exportEveryNumberOfSteps='1' overwrite='1'"}) {
      const std::string class_name = std::string(exporter).substr(0, std::string(exporter).find(' '));
      if (class_name == "VTKExporter" && (name == "link.txt" || name == ".." || name == "a/")) continue;  // adds .vtu
      const std::string error = errors_of(falling(std::string("<") + exporter + " filename='" + name + "'/>"), inside);
      EXPECT_EQ(error.find("test.scn:1: error: " + class_name + ".filename: '"), 0u) << name << ": " << error;
      const bool names_a_file = name != "a/" && name != "..";
      EXPECT_TRUE(!names_a_file || error.find("\n  hint: ask for it") != error.npos) << error;
    }
  }
  EXPECT_EQ(content("other/victim"), "mine");
  EXPECT_FALSE(fs::exists(path("other/x.txt")));

  // folders below it are made; elsewhere they must be there, and the host must allow it
  scene::Scene scene = read_and_init(falling("<WriteState filename='deep/er/x.txt'/>"), inside);
  EXPECT_FALSE(fs::exists(path("run/deep"))) << "nothing is written before a step";
  scene.step();
  EXPECT_EQ(content("run/deep/er/x.txt"), "T= 0\n  X= 1 0 0\n");
  scene::OutputRules anywhere = inside;
  anywhere.allows_outside = true;
  for (const std::string& name :
       {path("other/x.txt").string(), std::string("../other/y.txt"), std::string("away/z.txt")})
    read_and_init(falling("<WriteState filename='" + name + "'/>"), anywhere).step();
  for (const char* name : {"other/x.txt", "other/y.txt", "other/z.txt"})
    EXPECT_EQ(content(name), "T= 0\n  X= 1 0 0\n") << name;
}

// The scene has been initialised for a while when the first file is written.
TEST_F(Export, FollowsNoFolderThatHasBecomeALink) {
  fs::create_directories(path("other"));
  for (const char* exporter : {"WriteState filename='run/deep/x.txt'",
                               "VTKExporter filename='run/deep/x' exportEveryNumberOfSteps='1' edges='0'",
                               "VTKExporter filename='run/deep/x' exportEveryNumberOfSteps='1' overwrite='1'"}) {
    fs::create_directories(path("run/deep"));
    scene::Scene scene = read_and_init(box(std::string("<") + exporter + "/>"), below());
    fs::rename(path("run/deep"), path("run/moved"));
    fs::create_directory_symlink(path("other"), path("run/deep"));
    EXPECT_THROW(scene.step(), scene::FileError) << exporter;
    EXPECT_TRUE(fs::is_empty(path("other"))) << exporter;
    fs::remove_all(path("run"));
  }
}

TEST_F(Export, NamesOfUnfinishedFilesAreNotItsOwn) {
  const std::string series = "<VTKExporter filename='beam' exportEveryNumberOfSteps='1' edges='0'/>";
  for (const char* name : {"beam1.vtu.part", "x.part", "x.part/y.txt"})
    EXPECT_NE(errors_of(falling(std::string("<WriteState filename='") + name + "'/>"), below()).find(".part"),
              std::string::npos)
        << name;
  for (const std::string& exporter :
       {series, std::string("<VTKExporter exportEveryNumberOfSteps='9' filename='beam' overwrite='1'/>")}) {
    const std::string name = exporter == series ? "beam1.vtu.part" : "beam.vtu.part";
    std::ofstream(path(name)) << "mine";
    EXPECT_NE(errors_of(falling(exporter), below()).find(name + "' is there already"), std::string::npos);
    scene::OutputRules rules = below();
    rules.replaces = true;
    EXPECT_EQ(errors_of(falling(exporter), rules), "");
    EXPECT_EQ(content(name), "mine") << "nothing is written before a step";
    fs::remove(path(name));
  }
}

TEST_F(Export, AFileIsNoFolderOfAnother) {
  scene::OutputRules rules = below();
  rules.is_taken = [&](const fs::path& file) { return file == path("history.csv") || file == path("frames"); };
  for (const char* name : {"history.csv/x", "frames/frame_000000.png", "frames/deep/x"})
    EXPECT_NE(errors_of(falling(std::string("<WriteState filename='") + name + "'/>"), rules)
                  .find("is written by the run itself"),
              std::string::npos)
        << name;
  for (const char* two : {"<WriteState filename='x'/><WriteState filename='x/y'/>",
                          "<WriteState filename='x/y/z'/><WriteState filename='x'/>",
                          "<VTKExporter exportEveryNumberOfSteps='9' filename='b'/><WriteState filename='b12.vtu/x'/>",
                          "<WriteState filename='b12.vtu/x'/><VTKExporter exportEveryNumberOfSteps='9' filename='b'/>",
                          "<VTKExporter exportEveryNumberOfSteps='9' filename='b'/><VTKExporter "
                          "exportEveryNumberOfSteps='9' filename='b0.vtu/c'/>",
                          "<VTKExporter exportEveryNumberOfSteps='9' filename='b' overwrite='1'/><VTKExporter "
                          "exportEveryNumberOfSteps='9' filename='b.vtu/c'/>"})
    EXPECT_NE(errors_of(falling(two), below()).find("is written by another component too"), std::string::npos) << two;
  EXPECT_EQ(errors_of(falling("<WriteState filename='x/y'/><WriteState filename='x/z'/><VTKExporter "
                              "exportEveryNumberOfSteps='9' filename='x/b'/>"
                              "<VTKExporter exportEveryNumberOfSteps='9' filename='x'/>"),
                      below()),
            "");
}

// Files with higher numbers than this run's would otherwise pass for its last ones.
TEST_F(Export, ASeriesIsOfOneRun) {
  const std::string text = box("<VTKExporter filename='beam' exportEveryNumberOfSteps='1'/>");
  scene::OutputRules rules = below();
  {
    scene::Scene scene = read_and_init(text, rules);
    for (int k = 0; k < 6; ++k) scene.step();
  }
  std::ofstream(path("beam7.vtu.part")) << "unfinished";
  std::ofstream(path("beam.txt")) << "mine";
  rules.replaces = true;
  scene::Scene scene = read_and_init(text, rules);
  EXPECT_EQ(num_files(), 8u) << "nothing is removed before a step";
  for (int k = 0; k < 2; ++k) scene.step();
  for (const char* name : {"beam0.vtu", "beam1.vtu", "beam.txt"}) EXPECT_TRUE(fs::exists(path(name))) << name;
  EXPECT_EQ(num_files(), 3u);
}

TEST_F(Export, ReplacesFilesOnlyWhereTheHostSaysSoAndInputsNever) {
  std::ofstream(path("state.txt")) << "mine";
  std::ofstream(path("beam7.vtu")) << "mine";
  std::ofstream(path("mesh.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  fs::create_hard_link(path("mesh.obj"), path("other.obj"));
  fs::create_hard_link(path("state.txt"), path("kept.txt"));
  scene::OutputRules rules = below();
  rules.how_to_replace = "say so";
  EXPECT_EQ(
      errors_of(falling("<WriteState filename='state.txt'/>"), rules),
      "test.scn:1: error: WriteState.filename: '" + path("state.txt").string() + "' is there already\n  hint: say so");
  EXPECT_NE(errors_of(falling("<VTKExporter exportEveryNumberOfSteps='9' filename='beam'/>"), rules)
                .find("beam7.vtu' is there already"),
            std::string::npos);
  rules.replaces = true;
  read_and_init(
      falling("<WriteState filename='state.txt'/><VTKExporter exportEveryNumberOfSteps='9' filename='beam'/>"), rules)
      .step();
  EXPECT_EQ(content("state.txt"), "T= 0\n  X= 1 0 0\n");
  EXPECT_EQ(content("kept.txt"), "mine") << "another name of the file that was there";

  for (const char* name : {"mesh.obj", "other.obj"})
    EXPECT_EQ(errors_of(falling("<MeshOBJLoader filename='" + path("mesh.obj").string() + "'/><WriteState filename='" +
                                name + "'/>"),
                        rules),
              "test.scn:1: error: WriteState.filename: '" + path(name).string() +
                  "' is read by this scene, and what is read is never written over");
  rules.is_taken = [&](const fs::path& file) { return file == path("history.csv"); };
  EXPECT_NE(errors_of(falling("<WriteState filename='history.csv'/>"), rules).find("is written by the run itself"),
            std::string::npos);
  for (const char* two : {"<WriteState filename='a.txt'/><WriteState filename='./a.txt'/>",
                          "<VTKExporter exportEveryNumberOfSteps='9' filename='b'/><VTKExporter "
                          "exportEveryNumberOfSteps='9' filename='b1'/>",
                          "<VTKExporter exportEveryNumberOfSteps='9' filename='b'/><WriteState filename='b12.vtu'/>",
                          "<VTKExporter exportEveryNumberOfSteps='9'/><Node><VTKExporter exportEveryNumberOfSteps='9' "
                          "name='VTKExporter1'/></Node>"})
    EXPECT_NE(errors_of(falling(two), rules).find("is written by another component too"), std::string::npos) << two;
  EXPECT_EQ(errors_of(falling("<VTKExporter exportEveryNumberOfSteps='9' filename='b'/><VTKExporter "
                              "exportEveryNumberOfSteps='9' filename='ba'/><WriteState filename='b.vtu'/>"),
                      rules),
            "");
}

TEST_F(Export, BeginsAnewAfterReset) {
  scene::Scene scene = read_and_init(
      box("<WriteState filename='state.txt'/><VTKExporter filename='s' exportEveryNumberOfSteps='1'/>"), below());
  scene.step();
  const std::string first = content("state.txt"), picture = content("s0.vtu");
  ASSERT_EQ(first.substr(0, 5), "T= 0\n");
  scene.step();
  EXPECT_GT(content("state.txt").size(), first.size());
  EXPECT_EQ(num_files(), 3u);
  fs::remove(path("s0.vtu"));

  scene.reset();
  scene.step();
  EXPECT_EQ(content("state.txt"), first);
  EXPECT_EQ(content("s0.vtu"), picture) << "numbers begin anew too";
  EXPECT_EQ(num_files(), 2u) << "a series is of one run";
}

TEST_F(Export, OfAHostThatOnlyTriesThingsWritesNothing) {
  scene::Scene scene =
      read_and_init(falling("<WriteState filename='/no/where'/><VTKExporter exportEveryNumberOfSteps='1'/>"),
                    {.directory = path(""), .writes = false});
  scene.step();
  EXPECT_EQ(num_files(), 0u);
}

}  // namespace
