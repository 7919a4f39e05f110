// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cstring>
#include <limits>

#include "formats/mesh_source.hpp"
#include "hexaplast/base/error.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using namespace support;

const std::string kFolder = HEXAPLAST_TEST_DATA "/meshes/";

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return " facet normal 0 0 1\n  outer loop\n   vertex " + a + "\n   vertex " + b + "\n   vertex " + c +
         "\n  endloop\n endfacet\n";
}

const std::string kTwo =
    "solid two parts\n" + facet("0 0 0", "1 0 0", "0 1 0") + facet("1 0 0", "1 1 0", "0 1 0") + "endsolid two parts\n";

auto parsing(const std::string& text) {
  return [=] { parse_stl(text, "a.stl"); };
}

TEST(StlFile, HoldsATriangleOnceThatStandsThereAgain) {
  const std::string first = facet("0 0 0", "1 0 0", "0 1 0"), turned = facet("1 0 0", "0 0 0", "0 1 0");
  const ImportedMesh mesh = parse_stl("solid a\n" + first + turned + first + "endsolid a\n", "a.stl");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 0, 2}}));
  EXPECT_EQ(mesh.num_copies, 1);
}

TEST(StlFile, HoldsWhatMeshioWrote) {
  for (const char* file : {"organ_ascii.stl", "organ_binary.stl"}) {
    SCOPED_TRACE(file);
    const ImportedMesh mesh = read_mesh(kFolder + file);
    EXPECT_EQ(mesh.positions.rows(), 8) << "each corner once";
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_TRUE(mesh.quads.empty() && mesh.hexahedra.empty());
    EXPECT_NEAR(enclosed_volume(mesh.positions, mesh.triangles), 0.1 * 0.1 * 0.4, 1e-9) << "single precision";
  }
}

TEST(StlFile, JoinsCornersInOnePlaceInTheOrderOfTheFile) {
  const ImportedMesh mesh = parse_stl(kTwo, "a.stl");
  PointArray expected(4, 3);
  expected << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0;
  EXPECT_EQ(mesh.positions, expected);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
}

TEST(StlFile, TakesWhatProgramsWrite) {
  std::string upper = replaced(kTwo, "solid two parts", "SOLID");
  upper = replaced(upper, "vertex", "VERTEX");
  EXPECT_EQ(parse_stl(upper, "a.stl").triangles.size(), 2u);
  EXPECT_EQ(parse_stl(replaced(kTwo, "normal 0 0 1", "normal nan nan nan"), "a.stl").triangles.size(), 2u);
  EXPECT_EQ(
      parse_stl(kTwo + "solid other\n" + facet("5 0 0", "6 0 0", "5 1 0") + "endsolid\n", "a.stl").triangles.size(),
      3u);
  std::string windows;
  for (const char c : kTwo) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(parse_stl(windows, "a.stl").triangles.size(), 2u);

  // binary files that begin as text does
  std::string binary = content(kFolder + "organ_binary.stl");
  std::memcpy(binary.data(), "solid organ", 11);
  EXPECT_EQ(parse_stl(binary, "a.stl").triangles.size(), 12u);
}

TEST(StlFile, CountsTrianglesWithoutExtent) {
  const std::string text = replaced(kTwo, "endsolid", facet("0 0 0", "1 0 0", "-0.0 0 0") + "endsolid");
  const ImportedMesh mesh = parse_stl(text, "a.stl");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.num_degenerate, 1);
}

TEST(StlFile, NamesPlaceAndReason) {
  EXPECT_TRUE(refuses<InputError>(parsing(""), {"a.stl:1: neither begins with 'solid'"}));
  EXPECT_TRUE(refuses<InputError>(parsing("solid empty\nendsolid empty\n"), {"a.stl:1: the file holds no triangle"}));
  EXPECT_TRUE(refuses<InputError>(parsing(replaced(kTwo, "1 0 0", "1,0 0 0")), {"a.stl:5: '1,0' is not a coordinate"}));
  EXPECT_TRUE(refuses<InputError>(parsing(replaced(kTwo, "1 0 0", "inf 0 0")), {"a.stl:5: 'inf' is not a coordinate"}));
  EXPECT_TRUE(
      refuses<InputError>(parsing(replaced(kTwo, "   vertex 0 1 0\n", "")), {"a.stl:6: 'endloop', must be 'vertex'"}));
  EXPECT_TRUE(refuses<InputError>(parsing(replaced(kTwo, " facet", " face")),
                                  {"a.stl:2: 'face', must be 'facet' or 'endsolid'"}));
  EXPECT_TRUE(refuses<InputError>(parsing(kTwo + "more\n"), {"a.stl:17: 'more', must be 'solid', or the end"}));

  std::string binary = content(kFolder + "organ_binary.stl");
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(binary.data() + 84 + 50 + 12, &infinite, sizeof(infinite));
  EXPECT_TRUE(refuses<InputError>(parsing(binary), {"a.stl: byte 150: a coordinate of triangle 1 is inf"}));
  binary = content(kFolder + "organ_binary.stl");
  const std::uint32_t many = 4'000'000'000u;  // 200 GB: nothing may be allocated by it
  std::memcpy(binary.data() + 80, &many, sizeof(many));
  EXPECT_TRUE(refuses<InputError>(parsing(binary), {"a.stl:1: neither"}));
}

TEST(StlFile, CutAnywhereIsRefusedOrWhole) {
  for (const std::string& whole : {content(kFolder + "organ_ascii.stl"), content(kFolder + "organ_binary.stl"), kTwo}) {
    std::size_t refused = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) try {
        EXPECT_EQ(parse_stl(whole.substr(0, length), "a.stl").triangles, parse_stl(whole, "a.stl").triangles) << length;
      } catch (const InputError&) {
        ++refused;
      }
    EXPECT_GT(refused + 30, whole.size());
  }
}

}  // namespace
}  // namespace hexaplast
