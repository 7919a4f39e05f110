// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hexaplast/mesh/file_import.hpp"
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

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string content(const std::string& name) const {
    std::ifstream stream(folder_ / name);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::size_t num_files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

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
  scene::Scene scene =
      read_and_init(box("<VTKExporter filename='" + path("state.vtu") +
                        "' exportEveryNumberOfSteps='2' exportAtBegin='true' hexas='true' quads='1' edges='0' "
                        "pointsDataFields='speed=nodes.velocity nodes.rest_position'/>"));
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
  scene::Scene scene = read_and_init(box("<VTKExporter filename='" + path("state") +
                                         "' exportEveryNumberOfSteps='1' overwrite='1'/>"
                                         "<VTKExporter filename='" +
                                         path("never") + "' exportEveryNumberOfSteps='1' enable='0'/>"));
  for (int k = 0; k < 3; ++k) scene.step();
  EXPECT_EQ(num_files(), 1u);
  EXPECT_EQ(read_vtk(path("state.vtu")).positions, at<scene::MechanicalState>(scene, "nodes").positions());
  EXPECT_EQ(read_vtk(path("state.vtu")).edges.size(), 20u);
}

TEST_F(Export, OfANodeBelowShowsWhatFollows) {
  scene::Scene scene = read_and_init(box(
      "<Node name='skin'><MeshTopology triangles='0 1 2'/><MechanicalObject name='points' position='.2 .2 .2  .9 .2 "
      ".4  .5 .8 .6'/><BarycentricMapping/><VTKExporter filename='" +
      path("skin") + "' exportEveryNumberOfSteps='1' edges='0' triangles='1'/><WriteState filename='" +
      path("skin.txt") + "' time='0.125'/></Node>"));
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
    scene::Scene scene = read_and_init(in_root("gravity='0 0 -8' dt='0.5'",
                                               "<MechanicalObject position='1 0 0' velocity='0 2 0'/><UniformMass "
                                               "vertexMass='1'/><WriteState filename='" +
                                                   path("state.txt") + "' " + attributes + "/>"));
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
  EXPECT_EQ(errors_of(box("<VTKExporter filename='" + path("none/state") + "'/>")),
            exporter + "filename: '" + path("none") + "' is no directory");
  EXPECT_EQ(errors_of(box("<VTKExporter pointsDataFields='nodes.speed'/>")),
            exporter + "pointsDataFields: 'nodes.speed': MechanicalObject has no attribute 'speed'");
  EXPECT_EQ(errors_of(box("<VTKExporter pointsDataFields='a=grid.n'/>")),
            exporter + "pointsDataFields: 'a=grid.n' holds no list of real numbers");
  EXPECT_NE(errors_of(box("<VTKExporter exportAtEnd='true'/>")), "");
  EXPECT_EQ(errors_of(box("<WriteState/>")), "test.scn:1: error: WriteState.filename: is not given, must name a file");
  scene::Scene scene = read_and_init(
      box("<VTKExporter filename='" + path("x") + "' exportEveryNumberOfSteps='1' cellsDataFields='nodes.position'/>"));
  EXPECT_THROW(scene.step(), scene::SceneError);
}

}  // namespace
