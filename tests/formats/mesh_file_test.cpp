// SPDX-License-Identifier: LGPL-2.1-or-later
#include <sys/stat.h>

#include <bit>
#include <cmath>

#include "formats/mesh_source.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"

namespace hexaplast {
namespace {

using namespace support;

const std::string kFolder = HEXAPLAST_TEST_DATA "/meshes/";
const std::vector<std::string> kVolumeFiles = {"two_22_ascii.msh",  "two_22_binary.msh", "two_41_ascii.msh",
                                               "two_41_binary.msh", "two_42_ascii.vtk",  "two_42_binary.vtk",
                                               "two_51_ascii.vtk",  "two_51_binary.vtk", "two_ascii.vtu",
                                               "two_base64.vtu",    "two_zlib.vtu"};

ImportedMesh parse(const std::string& name, std::string_view content) {
  return parse_mesh(content, name, format_of(name));
}

// What make.py hands to meshio.
void expect_the_two_hexahedra(const ImportedMesh& mesh) {
  ASSERT_EQ(mesh.positions.rows(), 13);
  EXPECT_EQ(mesh.positions.row(1), Eigen::RowVector3d(1.25, 0, 0.1));
  EXPECT_EQ(mesh.positions.row(9), Eigen::RowVector3d(0.1, 1, 1.1));
  EXPECT_EQ(mesh.hexahedra, (std::vector<Hexahedron>{{0, 1, 4, 3, 6, 7, 10, 9}, {1, 2, 5, 4, 7, 8, 11, 10}}));
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{6, 7, 10, 9}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{7, 8, 11}, {7, 11, 10}}));
  EXPECT_EQ(mesh.edges, (std::vector<Edge>{{0, 3}}));
  ASSERT_EQ(mesh.skipped.size(), 1u);
  EXPECT_EQ(mesh.skipped.begin()->second, 1);
}

TEST(MeshFile, TheEndingOfTheNameTellsTheFormat) {
  EXPECT_TRUE(refuses<InputError>([] { read_mesh("organ.ply"); }, {"organ.ply", ".msh, .vtk, .vtu, .obj or .stl"}));
}

TEST(MeshFile, HoldsWhatMeshioWrote) {
  for (const std::string& file : kVolumeFiles) {
    SCOPED_TRACE(file);
    expect_the_two_hexahedra(read_mesh(kFolder + file));
  }
  const ImportedMesh surface = read_mesh(kFolder + "surface.obj");
  EXPECT_EQ(surface.positions.row(9), Eigen::RowVector3d(0.1, 1, 1.1));
  EXPECT_EQ(surface.quads, (std::vector<Quad>{{6, 7, 10, 9}}));
  EXPECT_EQ(surface.triangles, (std::vector<Triangle>{{7, 8, 11}, {7, 11, 10}}));
}

TEST(MeshFile, LinesMayEndAsOnWindows) {
  for (const std::string file :
       {"two_22_ascii.msh", "two_41_ascii.msh", "two_42_ascii.vtk", "two_51_ascii.vtk", "two_ascii.vtu"}) {
    SCOPED_TRACE(file);
    std::string text;
    for (const char c : content(kFolder + file)) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    expect_the_two_hexahedra(parse(file, text));
  }
}

TEST(MeshFile, CutAnywhereIsRefusedOrWhole) {
  for (const std::string& file : kVolumeFiles) {
    const std::string whole = content(kFolder + file);
    std::size_t refused = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
      SCOPED_TRACE(file + " cut after " + std::to_string(length));
      try {
        expect_the_two_hexahedra(parse(file, whole.substr(0, length)));
      } catch (const InputError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(file + ":")) << error.what();
        ++refused;
      }
    }
    EXPECT_GT(refused, whole.size() / 2) << file;
  }
}

TEST(MeshFile, NamesPlaceAndReason) {
  const std::string msh = content(kFolder + "two_22_ascii.msh"), vtk = content(kFolder + "two_42_ascii.vtk");
  const auto gmsh = [](const std::string& text) { return [=] { parse_gmsh(text, "a.msh"); }; };
  const auto legacy = [](const std::string& text) { return [=] { parse_vtk(text, "a.vtk"); }; };
  EXPECT_TRUE(refuses<InputError>(gmsh(replaced(msh, "1.25", "1,25")), {"a.msh:7: '1,25", "finite number"}));
  EXPECT_TRUE(refuses<InputError>(gmsh(replaced(msh, "1.25", "nan")), {"a.msh:7: 'nan"}));
  EXPECT_TRUE(refuses<InputError>(gmsh(replaced(msh, "2.2", "1")), {"a.msh:2: version '1'", "2.0 to 2.2 or 4.1"}));
  EXPECT_TRUE(refuses<InputError>(gmsh(replaced(msh, "\n13\n", "\n12\n")), {"a.msh:18: '13' stands where $EndNodes"}));
  EXPECT_TRUE(refuses<InputError>(gmsh(replaced(msh, "\n13\n", "\n14\n")), {"a.msh:19: '$EndNodes' is not a node"}));
  EXPECT_TRUE(refuses<InputError>(gmsh(replaced(msh, "\n2 1.25", "\n1 1.25")), {"a.msh:7: a second node 1"}));
  EXPECT_TRUE(refuses<InputError>(gmsh(""), {"a.msh:1: the file ends where $MeshFormat is expected"}));
  EXPECT_TRUE(refuses<InputError>(legacy(replaced(vtk, "POINTS 13", "POINTS 12")), {"a.vtk:6: section '3.0'"}));
  EXPECT_TRUE(refuses<InputError>(legacy(replaced(vtk, "CELL_TYPES 7", "CELL_TYPES 6")), {"section '10'"}));
  EXPECT_TRUE(
      refuses<InputError>(legacy(replaced(vtk, "UNSTRUCTURED_GRID", "POLYDATA")), {"must be an UNSTRUCTURED_GRID"}));
  EXPECT_TRUE(refuses<InputError>(legacy("solid cube\n"), {"a.vtk:1: the file does not begin with"}));
  EXPECT_TRUE(refuses<InputError>([] { parse_obj("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "a.obj"); },
                                  {"a.obj:3: '3' is none of the 2 vertices"}));
}

/// Reads a file that claims something else.
auto claims(const std::string& file, const std::string& from, const std::string& to) {
  return [=] { parse(file, replaced(content(kFolder + file), from, to)); };
}

TEST(MeshFile, BinaryThatCallsItselfTextIsRefused) {
  EXPECT_TRUE(refuses<InputError>(claims("two_22_binary.msh", "2.2 1 8", "2.2 0 8"), {"two_22_binary.msh:3"}));
  EXPECT_TRUE(refuses<InputError>(claims("two_41_binary.msh", "4.1 1 8", "4.1 0 8"), {"two_41_binary.msh:3"}));
  EXPECT_TRUE(
      refuses<InputError>(claims("two_42_binary.vtk", "BINARY", "ASCII"), {"two_42_binary.vtk:6", "coordinate"}));
  EXPECT_TRUE(
      refuses<InputError>(claims("two_base64.vtu", "\"binary\"", "\"ascii\""), {"two_base64.vtu:7: DataArray"}));
}

// A count is compared with the size of the file before anything is allocated by it.
TEST(MeshFile, HugeCountsAreRefused) {
  for (const std::string count : {"2000000000", "9000000000000000000"}) {
    EXPECT_TRUE(refuses<InputError>(claims("two_22_ascii.msh", "\n13\n", "\n" + count + "\n"), {count, "room for"}));
    EXPECT_TRUE(
        refuses<InputError>(claims("two_41_ascii.msh", "1 13 1 13", "1 " + count + " 1 13"), {count, "room for"}));
    EXPECT_TRUE(refuses<InputError>(claims("two_42_binary.vtk", "POINTS 13", "POINTS " + count), {count, "room for"}));
    EXPECT_TRUE(refuses<InputError>(claims("two_42_ascii.vtk", "CELLS 7", "CELLS " + count), {count, "room for"}));
    EXPECT_TRUE(refuses<InputError>(claims("two_zlib.vtu", "NumberOfPoints=\"13\"", "NumberOfPoints=\"" + count + "\""),
                                    {"two_zlib.vtu:"}));
  }
  EXPECT_TRUE(refuses<InputError>(claims("two_22_ascii.msh", "\n13\n", "\n99999999999999999999\n"), {"whole number"}));
}

TEST(MeshFile, WhatIsNoFileIsRefused) {
  const fs::path folder = fs::temp_directory_path() / ("mesh_file_test_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const fs::path fifo = folder / "pipe.msh";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  for (const MeshFormat format : {MeshFormat::kGmsh, MeshFormat::kVtk, MeshFormat::kObj, MeshFormat::kStl}) {
    const auto read = [&](const fs::path& file) { read_mesh(file, format); };
    EXPECT_TRUE(refuses<InputError>([&] { read(folder / "none.msh"); }, {"none.msh: no such file"}));
    EXPECT_TRUE(refuses<InputError>([&] { read(folder); }, {"is not a file"}));
    EXPECT_TRUE(refuses<InputError>([&] { read(fifo); }, {"is not a file"}));
    EXPECT_TRUE(refuses<InputError>([&] { read("/dev/null"); }, {"is not a file"}));
  }
  fs::remove_all(folder);
}

ExportedMesh exported(const ImportedMesh& mesh) {
  return {.points = {mesh.positions.data(), static_cast<std::size_t>(mesh.positions.size())},
          .edges = mesh.edges,
          .triangles = mesh.triangles,
          .quads = mesh.quads,
          .hexahedra = mesh.hexahedra};
}

TEST(MeshFile, IsReadAsItWasWritten) {
  ImportedMesh mesh = read_mesh(kFolder + "two_22_ascii.msh");
  mesh.positions.row(0) << 0.1 + 0.2, -1e-17, 12345.678901234567;
  const ImportedMesh again = parse_vtk(vtu_text(exported(mesh)), "a.vtu");
  EXPECT_EQ(again.positions, mesh.positions);
  EXPECT_EQ(again.edges, mesh.edges);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.quads, mesh.quads);
  EXPECT_EQ(again.hexahedra, mesh.hexahedra);
  EXPECT_TRUE(again.skipped.empty());
}

// Several blocks, tags with gaps and in any order, nodes with parameters, sections that do not matter.
TEST(GmshFile, OfVersion4NamesNodesByTagsOfAnyOrder) {
  const ImportedMesh mesh = parse_gmsh(
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"all $Nodes\"\n$EndPhysicalNames\n"
      "$Nodes\n2 8 5 900\n2 4 1 3\n30\n10\n20\n9 9 9 .5 .25\n1 0 0 0 0\n1 1 0 1 1\n"
      "3 1 0 5\n900\n5\n6\n7\n8\n0 0 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n$EndNodes\n"
      "$Elements\n2 2 1 9\n3 1 5 1\n1 900 10 20 5 6 7 8 30\n2 4 15 1\n9 30\n$EndElements\n",
      "tags.msh");
  EXPECT_EQ(mesh.hexahedra, (std::vector<Hexahedron>{{3, 1, 2, 4, 5, 6, 7, 0}}));
  EXPECT_EQ(mesh.positions.row(1), Eigen::RowVector3d(1, 0, 0));
  EXPECT_EQ(mesh.skipped, (std::map<std::string, int>{{"points", 1}}));
}

/// A tower of two cubes; its upper hexahedron, a quad and an edge stand there again.
ImportedMesh tower_with_copies() {
  ImportedMesh mesh;
  mesh.positions.resize(12, 3);
  for (int n = 0; n < 12; ++n) mesh.positions.row(n) = Eigen::RowVector3d((n % 4) % 3 != 0, n % 4 > 1, n / 4);
  const Hexahedron lower{0, 1, 2, 3, 4, 5, 6, 7}, upper{4, 5, 6, 7, 8, 9, 10, 11};
  mesh.hexahedra = {lower, upper, upper};
  mesh.quads = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 2, 3}, {1, 2, 3, 0}};
  mesh.edges = {{0, 1}, {0, 1}};
  return mesh;
}

// In the same order alone: whoever turns a quad may mean its other side.
TEST(MeshFile, HoldsACellOnceThatStandsThereAgain) {
  const ImportedMesh tower = tower_with_copies();
  const ExportedMesh written = exported(tower);
  const ImportedMesh mesh = parse_vtk(vtu_text(written), "a.vtu");
  EXPECT_EQ(mesh.hexahedra, (std::vector<Hexahedron>{tower.hexahedra[0], tower.hexahedra[1]}));
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{0, 1, 2, 3}, {4, 5, 6, 7}, {1, 2, 3, 0}}));
  EXPECT_EQ(mesh.edges, (std::vector<Edge>{{0, 1}}));
  EXPECT_EQ(mesh.num_copies, 3);
  EXPECT_EQ(what_is_left_out(mesh), (std::vector<std::string>{"3 cells stand there again, and are taken once"}));
  const ImportedMesh surface = parse_obj(obj_text(written), "a.obj");
  EXPECT_EQ(surface.quads, (std::vector<Quad>{{0, 1, 2, 3}, {4, 5, 6, 7}, {1, 2, 3, 0}}));
  EXPECT_EQ(surface.num_copies, 2) << "an edge and a quad";
  // the cell of the first copy, behind an edge and two quads
  const ImportedState state = parse_vtu_state(vtu_text(written), "a.vtu");
  EXPECT_EQ(state.mesh.hexahedra.size(), 2u);
  EXPECT_EQ(state.hexahedron_cells, (std::vector<int>{6, 7}));
}

// Gmsh 2.2 writes an element once for each group that it belongs to.
TEST(GmshFile, GroupsShareTheHexahedraOfWhichThereAreCopies) {
  const std::string text = content(kFolder + "duplicate_hexahedron.msh");
  const ImportedMesh mesh = parse_gmsh(text, "a.msh");
  EXPECT_EQ(mesh.hexahedra.size(), 2u);
  const std::vector<ImportedGroup>& groups = mesh.groups;
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].hexahedra, (std::vector<int>{0, 1}));
  EXPECT_EQ(groups[1].hexahedra, (std::vector<int>{1}));
}

TEST(MeshFile, NamesTheKindsThatAreSkipped) {
  const std::string second_order = content(kFolder + "second_order.msh");
  EXPECT_EQ(what_is_left_out(parse_gmsh(second_order, "a.msh")),
            (std::vector<std::string>{"1 cells are skipped: neither edges, triangles, quads nor hexahedra of first "
                                      "order: 1 hexahedra of 20 nodes"}));
  const auto skipped_of_vtk = [](int num_nodes, int type) {
    std::string text =
        "# vtk DataFile Version 2.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 double\n0 0 0\nCELLS 1 " +
        std::to_string(num_nodes + 1) + "\n" + std::to_string(num_nodes);
    for (int n = 0; n < num_nodes; ++n) text += " 0";
    return parse_vtk(text + "\nCELL_TYPES 1\n" + std::to_string(type) + "\n", "a.vtk").skipped;
  };
  using Skipped = std::map<std::string, int>;
  EXPECT_EQ(skipped_of_vtk(20, 25), (Skipped{{"hexahedra of 20 nodes", 1}}));
  EXPECT_EQ(skipped_of_vtk(4, 10), (Skipped{{"tetrahedra", 1}}));
  EXPECT_EQ(skipped_of_vtk(2, 99), (Skipped{{"cells of VTK type 99", 1}}));
}

TEST(GmshFile, NamesParametricNodesAsTheReason) {
  EXPECT_TRUE(refuses<InputError>([] { read_mesh(kFolder + "parametric_nodes.msh"); },
                                  {"parametric_nodes.msh:4: $ParametricNodes are not read: must be $Nodes"}));
}

/// Numbers as bytes of the foreign order.
template <class T>
std::string foreign(T value) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  return {bytes.rbegin(), bytes.rend()};
}

TEST(GmshFile, MayHaveTheOtherByteOrder) {
  std::string file = "$MeshFormat\n2.2 1 8\n" + foreign(1) + "\n$EndMeshFormat\n$Nodes\n2\n";
  for (const int node : {4, 7}) file += foreign(node) + foreign(0.5 * node) + foreign(1.0) + foreign(-2.25);
  file += "\n$EndNodes\n$Elements\n1\n" + foreign(1) + foreign(1) + foreign(2);
  for (const int number : {1, 99, 99, 7, 4}) file += foreign(number);
  const ImportedMesh mesh = parse_gmsh(file + "\n$EndElements\n", "foreign.msh");
  EXPECT_EQ(mesh.positions.row(1), Eigen::RowVector3d(3.5, 1, -2.25));
  EXPECT_EQ(mesh.edges, (std::vector<Edge>{{1, 0}}));
}

// Two volumes, of which the second is in two groups, and a surface in a group of its own.
TEST(GmshFile, GivesItsGroupsOfVolumes) {
  const std::string names =
      "$PhysicalNames\n3\n3 7 \"liver and tumour\"\n3 8 \"tumour\"\n2 7 \"skin\"\n$EndPhysicalNames\n";
  std::string points;
  for (int n = 0; n < 12; ++n)
    points += std::to_string(n % 3) + " " + std::to_string(n / 3 % 2) + " " + std::to_string(n / 6) + "\n";
  const auto version_4 = [&](const std::string& entities) {
    return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + names + "$Entities\n" + entities +
           "$EndEntities\n$Nodes\n1 12 1 12\n3 1 0 12\n1 2 3 4 5 6 7 8 9 10 11 12\n" + points +
           "$EndNodes\n$Elements\n3 3 1 3\n2 1 3 1\n1 1 2 5 4\n3 1 5 1\n2 1 2 5 4 7 8 11 10\n"
           "3 2 5 1\n3 2 3 6 5 8 9 12 11\n$EndElements\n";
  };
  std::string version_2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + names + "$Nodes\n12\n";
  std::istringstream lines(points);
  int n = 0;
  for (std::string line; std::getline(lines, line);) version_2 += std::to_string(++n) + " " + line + "\n";
  version_2 +=
      "$EndNodes\n$Elements\n3\n1 3 2 7 1 1 2 5 4\n2 5 2 7 1 1 2 5 4 7 8 11 10\n"
      "3 5 2 9 2 2 3 6 5 8 9 12 11\n$EndElements\n";

  const auto found = [](const std::string& content) {
    std::map<std::string, std::vector<int>> groups;
    for (const ImportedGroup& group : parse_gmsh(content, "a.msh").groups) groups[group.name] = group.hexahedra;
    return groups;
  };
  using Groups = std::map<std::string, std::vector<int>>;
  const std::string entities =
      "1 0 1 2\n5 0 0 0 0\n1 0 0 0 1 1 0 1 7 1 -3\n1 0 0 0 1 1 1 1 7 2 1 -4\n"
      "2 1 0 0 2 1 1 2 7 8 0\n";
  EXPECT_EQ(found(version_4(entities)), (Groups{{"liver and tumour", {0, 1}}, {"tumour", {1}}}));
  EXPECT_EQ(found(version_2), (Groups{{"liver and tumour", {0}}, {"tumour", {}}, {"9", {1}}}));
  EXPECT_TRUE(refuses<InputError>([&] { found(version_4("0 0 0 1\n1 0 0 0 1 1 1 99999 7\n")); },
                                  {"a.msh:", "the number of groups"}));
  std::string nameless = version_2;
  nameless.erase(nameless.find("\"tumour\""), 8);
  EXPECT_TRUE(refuses<InputError>([&] { found(nameless); }, {"a.msh:7", "must have one in quotes"}));
  for (std::size_t size = 0; size < version_2.size(); size += 7)
    EXPECT_THROW(parse_gmsh(version_2.substr(0, size), "a.msh"), InputError) << size;
}

TEST(VtuFile, GivesItsDataInTheOrderOfPointsAndCells) {
  const auto file = [](const std::string& data) {
    return "<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'><UnstructuredGrid>\n"
           "<Piece NumberOfPoints='4' NumberOfCells='2'><Points><DataArray type='Float64' format='ascii'>"
           "0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points><Cells>"
           "<DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2 0 2 3</DataArray>"
           "<DataArray type='Int32' Name='offsets' format='ascii'>3 6</DataArray>"
           "<DataArray type='UInt8' Name='types' format='ascii'>5 5</DataArray></Cells>\n" +
           data + "</Piece></UnstructuredGrid></VTKFile>";
  };
  const ImportedState state = parse_vtu_state(
      file("<PointData><DataArray type='Float32' Name='flow' NumberOfComponents='2' format='ascii'>1 2 3 4 5 6 7 8.5"
           "</DataArray></PointData><CellData><DataArray type='String' Name='note' format='ascii'>a b</DataArray>"
           "<DataArray type='Int64' Name='id' format='ascii'>-3 7</DataArray></CellData>"),
      "a.vtu");
  EXPECT_EQ(state.mesh.triangles.size(), 2u);
  ASSERT_EQ(state.point_data.size(), 1u);
  EXPECT_EQ(state.point_data[0].name, "flow");
  EXPECT_EQ(state.point_data[0].num_components, 2);
  EXPECT_EQ(state.point_data[0].values, (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8.5}));
  ASSERT_EQ(state.cell_data.size(), 1u) << "text is passed over";
  EXPECT_EQ(state.cell_data[0].values, (std::vector<double>{-3, 7}));
  const ImportedState unlimited = parse_vtu_state(
      file("<CellData><DataArray type='Float64' Name='limit' format='ascii'>inf nan</DataArray></CellData>"), "a.vtu");
  EXPECT_TRUE(std::isinf(unlimited.cell_data[0].values[0]) && std::isnan(unlimited.cell_data[0].values[1]));

  const auto reading = [&](const std::string& data) { return [=] { parse_vtu_state(file(data), "a.vtu"); }; };
  EXPECT_TRUE(refuses<InputError>(
      reading("<CellData><DataArray type='Int64' Name='id' format='ascii'>1</DataArray></CellData>"), {"a.vtu:3"}));
  EXPECT_TRUE(refuses<InputError>(
      reading("<CellData><DataArray type='Int64' NumberOfComponents='0' format='ascii'/></CellData>"),
      {"a.vtu:3", "NumberOfComponents '0', must lie in [1, 4096]"}));
}

// Raw bytes behind the XML, in either byte order, with numbers of several sizes, and in two pieces.
TEST(VtuFile, MayAppendRawBytes) {
  for (const bool is_foreign : {false, true}) {
    const auto bytes = [&](auto value) {
      const std::string swapped = foreign(value);
      return is_foreign ? swapped : std::string(swapped.rbegin(), swapped.rend());
    };
    std::string data;
    std::vector<std::size_t> offsets;
    const auto append = [&](const std::string& numbers) {
      offsets.push_back(data.size());
      data += bytes(static_cast<std::uint64_t>(numbers.size())) + numbers;
    };
    std::string points;
    for (const float x : {0.f, 0.f, 0.f, 1.5f, 0.f, 0.f, 0.f, 2.f, 0.25f}) points += bytes(x);
    append(points);
    append(bytes(std::int32_t{2}) + bytes(std::int32_t{0}) + bytes(std::int32_t{1}));
    append(bytes(std::uint16_t{3}));
    append(bytes(std::uint8_t{5}));
    const auto array = [&](const char* type, const char* name, int i) {
      return std::string("<DataArray type='") + type + "' Name='" + name + "' format='appended' offset='" +
             std::to_string(offsets[i]) + "'/>";
    };
    const std::string piece = "<Piece NumberOfPoints='3' NumberOfCells='1'><Points>" + array("Float32", "p", 0) +
                              "</Points><Cells>" + array("Int32", "connectivity", 1) + array("UInt16", "offsets", 2) +
                              array("UInt8", "types", 3) + "</Cells></Piece>";
    const bool is_little = (std::endian::native == std::endian::little) != is_foreign;
    const ImportedMesh mesh =
        parse_vtk("<?xml version='1.0'?><VTKFile type='UnstructuredGrid' header_type='UInt64' byte_order='" +
                      std::string(is_little ? "LittleEndian" : "BigEndian") + "'><UnstructuredGrid>" + piece + piece +
                      "</UnstructuredGrid><AppendedData encoding='raw'>\n_" + data + "\n</AppendedData></VTKFile>",
                  "raw.vtu");
    ASSERT_EQ(mesh.positions.rows(), 6);
    EXPECT_EQ(mesh.positions.row(4), Eigen::RowVector3d(1.5, 0, 0));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{2, 0, 1}, {5, 3, 4}}));
  }
}

TEST(VtuFile, RefusesWhatItCannotRead) {
  const std::string vtu = content(kFolder + "two_zlib.vtu");
  const auto reading = [](const std::string& text) { return [=] { parse_vtk(text, "a.vtu"); }; };
  EXPECT_TRUE(
      refuses<InputError>(reading(replaced(vtu, "vtkZLibDataCompressor", "vtkLZ4DataCompressor")), {"a.vtu:2", "LZ4"}));
  EXPECT_TRUE(refuses<InputError>(reading(replaced(vtu, "NumberOfPoints=\"13\"", "NumberOfPoints=\"12\"")),
                                  {"DataArray", "288 bytes"}));
  EXPECT_TRUE(
      refuses<InputError>(reading(replaced(vtu, "type=\"UnstructuredGrid\"", "type=\"PolyData\"")), {"PolyData"}));
  EXPECT_TRUE(refuses<InputError>(reading("<VTKFile>"), {"a.vtu:1: <VTKFile> is never closed"}));
}

TEST(LegacyVtkFile, TakesVoxelsAndPixelsInTheirOwnOrder) {
  const ImportedMesh mesh = parse_vtk(
      "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n0.5\n"
      "POINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0\n0 0 1 1 0 1 0 1 1 1 1 1\nMETADATA\nINFORMATION 0\n\n"
      "CELLS 2 14\n8 0 1 2 3 4 5 6 7\n4 0 1 2 3\nCELL_TYPES 2\n11 8\nPOINT_DATA 8\nSCALARS s float\n",
      "voxel.vtk");
  ASSERT_EQ(mesh.hexahedra.size(), 1u);
  EXPECT_NO_THROW(HexMesh(mesh.positions, mesh.hexahedra)) << "right side out";
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{0, 1, 3, 2}}));
}

TEST(ObjFile, TakesFacesOfAnySizeLinesAndBackwardNumbers) {
  const ImportedMesh mesh = parse_obj(
      "# comment\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 0.5\nv 1 1 0\nv 0 1 0\nv -1 .5 0\nvn 0 0 1\n"
      "f 1//1 2//1 3/7 4\r\nf 1 2 3 4 5\nf -3 -2 -1\nl 1 2 3\n",
      "faces.obj");
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {2, 3, 4}}));
  EXPECT_EQ(mesh.edges, (std::vector<Edge>{{0, 1}, {1, 2}}));
  EXPECT_TRUE(refuses<InputError>([] { parse_obj("v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj"); }, {"a.obj:3: 2 vertices"}));
  EXPECT_TRUE(refuses<InputError>([] { parse_obj("v 0 0\n", "a.obj"); }, {"a.obj:1", "coordinate"}));
}

TEST(ImportedMesh, IsCompletedTriangulatedAndCleaned) {
  ImportedMesh mesh = read_mesh(kFolder + "two_ascii.vtu");
  add_boundaries_of_cells(mesh);
  EXPECT_EQ(mesh.quads.size(), 11u);
  EXPECT_EQ(mesh.quads[0], (Quad{6, 7, 10, 9})) << "what was there stays first";
  EXPECT_EQ(mesh.edges.size(), 20u + 1u) << "and the diagonal between the triangles";

  remove_unused_nodes(mesh);
  EXPECT_EQ(mesh.positions.rows(), 12);
  mesh.positions.conservativeResize(14, 3);
  mesh.positions.row(12) = mesh.positions.row(13) = Eigen::RowVector3d(7, 7, 7);
  mesh.hexahedra[1][2] = 13;
  remove_unused_nodes(mesh);
  EXPECT_EQ(mesh.hexahedra[1][2], 12);
  EXPECT_EQ(mesh.positions.row(12), Eigen::RowVector3d(7, 7, 7));

  triangulate(mesh);
  EXPECT_TRUE(mesh.quads.empty());
  EXPECT_EQ(mesh.triangles.size(), 2u + 22u);
  EXPECT_EQ(mesh.triangles[3], (Triangle{6, 10, 9}));
}

}  // namespace
}  // namespace hexaplast
