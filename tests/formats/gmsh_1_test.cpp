// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"

namespace {

using namespace hexaplast;

// Gmsh's manual: $ELM has number, type, physical and elementary group, number of nodes, nodes.
constexpr const char* kCube =
    "$NOD\n9\n10 0 0 0\n1 1 0 0\n2 1 1 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 1 1 1\n7 0 1 1\n8 .5 .5 .5\n$ENDNOD\n"
    "$ELM\n3\n1 5 7 1 8 10 1 2 3 4 5 6 7\n2 3 0 1 4 4 5 6 7\n3 15 0 1 1 8\n$ENDELM\n";

TEST(GmshFile, OfVersion1HasNoHead) {
  const ImportedMesh mesh = parse_gmsh(kCube, "a.msh");
  EXPECT_EQ(mesh.positions.rows(), 9);
  EXPECT_EQ(mesh.positions.row(8), Eigen::RowVector3d(.5, .5, .5));
  EXPECT_EQ(mesh.hexahedra, (std::vector<Hexahedron>{{0, 1, 2, 3, 4, 5, 6, 7}}));
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{4, 5, 6, 7}}));
  EXPECT_EQ(mesh.skipped.size(), 1u);
  const std::vector<ImportedGroup> groups = parse_gmsh_groups(kCube, "a.msh");
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].name, "7");
}

TEST(GmshFile, OfVersion1IsRefusedWhereItIsDamaged) {
  const std::string whole = kCube;
  const auto error_of = [](const std::string& text) -> std::string {
    try {
      parse_gmsh(text, "a.msh");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  std::string wrong = whole;
  wrong.replace(wrong.find("1 8 10"), 6, "1 6 10");
  EXPECT_NE(
      error_of(wrong).find("a.msh:15: '6' is not the number of nodes of an element: must be a whole number in [8, 8]"),
      std::string::npos)
      << error_of(wrong);
  wrong = whole;
  wrong.replace(wrong.find("6 7\n2"), 3, "6 9");
  EXPECT_NE(error_of(wrong).find("node 9, which is not among the nodes"), std::string::npos) << error_of(wrong);
  for (std::size_t size = 0; size < whole.size() - 9; ++size) EXPECT_NE(error_of(whole.substr(0, size)), "") << size;
}

}  // namespace
