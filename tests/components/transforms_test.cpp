// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::read_and_init;

std::string engine(const std::string& attributes) {
  return "<Node><TransformEngine name='t' input_position='1 2 3  0 0 1' " + attributes + "/></Node>";
}

void expect_points(const std::string& text, std::vector<double> points, const char* component = "t",
                   const char* output = "output_position") {
  scene::Scene scene = read_and_init(text);
  const std::vector<double>& found = at<scene::Component>(scene, component).reals(output);
  ASSERT_EQ(found.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(found[i], points[i], 1e-14) << text << " " << i;
}

// (1, 2, 3) scaled is (2, 2, 9), a quarter turn about z makes it (-2, 2, 9).
TEST(TransformEngine, ScalesThenTurnsThenMoves) {
  expect_points(engine("scale='2 1 3' rotation='0 0 90' translation='10 0 0'"), {8, 2, 9, 10, 0, 3});
  expect_points(engine("scale='2 1 3' quaternion='0 0 1 1' translation='10 0 0'"), {8, 2, 9, 10, 0, 3});
}

TEST(TransformEngine, TheInverseLeadsBack) {
  expect_points(
      "<Node><TransformEngine name='there' input_position='1 2 3' scale='2 1 3' rotation='10 20 30' translation='1 2 "
      "3'/><TransformEngine name='t' input_position='@there.output_position' scale='2 1 3' rotation='10 20 30' "
      "translation='1 2 3' inverse='true'/></Node>",
      {1, 2, 3});
  EXPECT_NE(errors_of("<Node><TransformEngine name='t' input_position='1 2 3' scale='0 1 1' inverse='1'/>"
                      "<MechanicalObject position='@t.output_position'/></Node>")
                .find("TransformEngine.scale: has a 0, which has no inverse"),
            std::string::npos);
}

std::string position(const std::string& attributes) {
  return "<Node><TransformPosition name='t' input_position='1 2 3  4 5 6' " + attributes + "/></Node>";
}

TEST(TransformPosition, HasAMethodForEachKind) {
  expect_points(position("method='translation' translation='1 0 -1' scale='7 7 7'"), {2, 2, 2, 5, 5, 5});
  expect_points(position("method='scale' scale='2 1 1'"), {2, 2, 3, 8, 5, 6});
  expect_points(position("method='rotation' rotation='0 0 90'"), {-2, 1, 3, -5, 4, 6});
  expect_points(position("method='scaleTranslation' scale='2 1 1' translation='0 0 1'"), {2, 2, 4, 8, 5, 7});
  expect_points(position("method='scaleRotationTranslation' scale='2 1 1' rotation='0 0 90' translation='0 0 1'"),
                {-2, 2, 4, -5, 8, 7});
  expect_points(position("method='affine' matrix='0 1 0 5  1 0 0 0  0 0 1 0  0 0 0 1'"), {7, 1, 3, 10, 4, 6});
  // onto the plane z = 1, with a normal of length 2
  expect_points(position("normal='0 0 2' origin='9 9 1'"), {1, 2, 1, 4, 5, 1});
  expect_points(position("method='scale' scale='2 1 1' fixedIndices='1'"), {2, 2, 3, 4, 5, 6});
}

TEST(TransformEngine, PointsThatLeadToNoNumbersAreRefused) {
  const auto errors = [](const std::string& scale) {
    return errors_of(support::in_root(
        "",
        "<RegularGridTopology n='2 2 2'/><MechanicalObject/><UniformMass totalMass='1'/><Node><TransformEngine "
        "name='t' "
        "input_position='2 2 2  0 0 0' scale='" +
            scale + "'/><MechanicalObject position='@t.output_position'/><BarycentricMapping/></Node>"));
  };
  EXPECT_NE(errors("1e308 1 1").find("TransformEngine.input_position: leads to points that are not finite"),
            std::string::npos);
  EXPECT_NE(errors("1e300 1 1").find("embedded point 0 lies too far from the hexahedra"), std::string::npos);
}

class FilesOfPoints : public testing::Test {
 protected:
  void SetUp() override {
    write("test.tfm", "#Insight\nParameters: 1 0 0 0 0 -1 0 1 0 30 20 10\nFixedParameters: 0 0 0\n");
  }
  void TearDown() override {
    for (const char* name : {"test.tfm", "test.sph"}) std::filesystem::remove(name);
  }
  static void write(const char* name, const std::string& text) { std::ofstream(name) << text; }
};

// The translation stands backwards, as SOFA reads it.
TEST_F(FilesOfPoints, ATransformIsReadFromItsFile) {
  expect_points(position("method='fromFile' filename='test.tfm'"), {11, 17, 32, 14, 14, 35});
  write("test.tfm", "Parameters: 1 0 0 0 0 -1 0 1 0 30 20\n");
  EXPECT_NE(errors_of("<Node><TransformPosition name='t' method='fromFile' filename='test.tfm' input_position='1 2 3'/>"
                      "<MechanicalObject position='@t.output_position'/></Node>")
                .find("TransformPosition.filename: 11 numbers behind 'Parameters:', must be twelve"),
            std::string::npos);
}

TEST_F(FilesOfPoints, SpheresAreReadAndMoved) {
  write("test.sph", "sph 1.0\n#nums 3\n#sphe 9 9 9 9 9\nsphe 1 -8 -5.2 1 2.5\nnums 2\nsphe 2 0 1 0 .5\n");
  const std::string text =
      "<Node><SphereLoader name='t' filename='test.sph' scale='2 1 1' translation='0 0 1'/></Node>";
  expect_points(text, {-16, -5.2, 2, 0, 1, 1}, "t", "position");
  expect_points(text, {2.5, .5}, "t", "listRadius");
  write("test.sph", "sph 1.0\nsphe 1 2 3\n");
  EXPECT_EQ(errors_of(text),
            "test.scn:1: error: SphereLoader.filename: test.sph: line 2: 3 numbers behind 'sphe', must be five");
  write("test.sph", "sph 1.0\nsphe 1 2 x 3 4\n");
  EXPECT_EQ(errors_of(text), "test.scn:1: error: SphereLoader.filename: 'x' behind 'sphe' is not a number");
  write("test.sph", "v 1 2 3\n");
  EXPECT_NE(errors_of(text).find("line 1: must begin with 'sph'"), std::string::npos);
}

}  // namespace
