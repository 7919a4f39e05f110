// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes and VTK's XML files made to hurt: refused with a message, in little memory, and never by a crash. What is
// refused is tested in formats/xml_test.cpp and scene/reading_test.cpp.
#include <zlib.h>

#include <cstdint>

#include "hexaplast/material/material.hpp"
#include "support/cost.hpp"

namespace {

using namespace hexaplast::support;

class HostileScene : public Hostile {
 protected:
  void expect_refused_scene(const std::string& text, const std::string& message) {
    expect_bounded({"run", directory_ / "hostile.scn", "--steps=1"}, "hostile.scn", text, message, 20, 2);
  }
};

/// A body as the scene file has it and as the guard sees it.
struct BodyKind {
  const char* name;
  std::string attributes;
  hexaplast::Material material;
  hexaplast::Settings settings;
};

std::vector<BodyKind> body_kinds() {
  const hexaplast::Material elastic, flows{.yield_stress = 1, .flow_rate = 1};
  hexaplast::Material tears = flows;
  tears.fracture_stretch = 100;
  const hexaplast::Settings in_double, mixed{.precision = hexaplast::Precision::kMixed},
      plain{.implementation = hexaplast::Implementation::kPlain}, joined{.rest_shape = hexaplast::RestShape::kJoined},
      joined_plain{.rest_shape = hexaplast::RestShape::kJoined, .implementation = hexaplast::Implementation::kPlain};
  hexaplast::Settings corners = joined_plain, relaxing = plain;
  relaxing.relaxation = {1, 0.1, 1, 0.2};
  corners.rotation_plasticity = hexaplast::RotationPlasticity::kVertex;
  const std::string flowing = "yieldStress='1e-9' plasticFlowRate='2' rotationFlowRate='1' restShape='joined' ";
  const std::string tearing = flowing + "fractureStretch='100' ", in_mixed = "precision='mixed'",
                    in_plain = "implementation='plain'", alone = "yieldStress='1e-9' plasticFlowRate='2' ";
  return {{"ElasticDouble", "", elastic, in_double},
          {"ElasticMixed", in_mixed, elastic, mixed},
          {"ElasticPlain", in_plain, elastic, plain},
          {"IsolatedDouble", alone, flows, in_double},
          {"IsolatedMixed", alone + in_mixed, flows, mixed},
          {"IsolatedPlain", alone + in_plain, flows, plain},
          {"FlowingDouble", flowing, flows, joined},
          {"TearingPlain", tearing + in_plain, tears, joined_plain},
          {"CornersPlain", flowing + "rotationPlasticity='vertex' " + in_plain, flows, corners},
          {"RelaxingPlain", alone + "relaxation='1 .1 1 .2' " + in_plain, flows, relaxing}};
}

void PrintTo(const BodyKind& kind, std::ostream* out) { *out << kind.name; }

/// What a run of a grid takes at most, with a step after the first, and with all that it writes.
class BodyMemory : public Command, public testing::WithParamInterface<BodyKind> {
 protected:
  bool is_plain() const { return GetParam().settings.implementation == hexaplast::Implementation::kPlain; }

  double megabytes(int cells) {
    const std::string nodes = std::to_string(cells + 1);
    write("body.scn",
          "<Node dt='0.01' gravity='0 0 -5'><EulerImplicitSolver/><MultigridCGLinearSolver/>"
          "<RegularGridTopology n='" +
              nodes + " " + nodes + " " + nodes +
              "'/><MechanicalObject/>"
              "<DiagonalMass massDensity='1000'/><BoxROI name='foot' box='-1 -1 -.001 2 2 .001'/>"
              "<FixedProjectiveConstraint indices='@foot.indices'/><HexahedronElastoplasticFEMForceField " +
              GetParam().attributes + "/></Node>");
    std::vector<std::string> words{"run", directory_ / "body.scn", "--steps=2"};
    if (!is_plain()) words.insert(words.end(), {"--out", directory_ / "run", "--force"});
    const Cost cost = cost_of(words, directory_ / "err");
    EXPECT_EQ(cost.code, 0) << read("err");
    return cost.megabytes;
  }
};

TEST_F(HostileScene, NestingAndSize) {
  expect_refused_scene(repeated("<Node>", 1'000'000), ":1: error: more than 100 levels of elements");
  expect_refused_scene("<Node>" + repeated("<BoxROI/>", 100'000) + "</Node>", ":1: error: more than 10000 elements");
  std::string attributes;
  for (int i = 0; i < 100'001; ++i) attributes += " a" + std::to_string(i) + "=''";
  expect_refused_scene("<Node" + attributes + "/>", ":1: error: more than 100000 '='");
  expect_refused_scene("<Node>" + repeated("\n<Nonsense/>", 9'000) + "</Node>",
                       "at least 80 further errors are not shown");
}

TEST_F(HostileScene, LinksInChains) {
  std::string chain = "<IndexValueMapper name='r0' inputValues='0'/>";
  for (int i = 1; i < 5'000; ++i)
    chain = "<IndexValueMapper name='r" + std::to_string(i) + "' inputValues='@r" + std::to_string(i - 1) +
            ".outputValues'/>" + chain;
  write("hostile.scn",
        "<Node>" + chain + "<SphereROI position='0 0 0' centers='0 0 0' radii='@r4999.outputValues'/></Node>");
  expect_refused({{"run hostile.scn", 3, "more than 100 components follow one another"}});
}

TEST_F(HostileScene, NumbersThatWouldBeAllocated) {
  expect_refused_scene("<Node>\n<RegularGridTopology n='100000 100000 100000'/></Node>",
                       ":2: error: RegularGridTopology.n: 1e+15 cells");
  for (const char* index : {"-1", "2147483648", "9223372036854775808"})
    expect_refused_scene("<Node>\n<FixedProjectiveConstraint indices='" + std::string(index) + "'/></Node>",
                         ":2: error: FixedProjectiveConstraint.indices: ");
  expect_refused_scene("<Node>\n<FixedProjectiveConstraint indices='0-2147483646'/></Node>", "stands for more than");
}

// What keeps a body that the machine cannot hold from being begun must not count less than it takes. Of a small body
// pictures of its surface take more: the plain implementation, which is slow, goes without.
TEST_P(BodyMemory, IsWhatTheGuardCounts) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "sanitizers hold memory of their own";
#endif
  const int few = is_plain() ? 12 : 20, many = is_plain() ? 20 : 32;
  const double hexahedra = many * many * many - few * few * few;
  const double counted = hexaplast::bytes_per_hexahedron({GetParam().material}, GetParam().settings);
  const double taken = 1e6 * (megabytes(many) - megabytes(few)) / hexahedra;
  EXPECT_LT(taken, 1.05 * counted);  // pages of the allocator come and go
  EXPECT_GT(taken, 0.6 * counted);
}

INSTANTIATE_TEST_SUITE_P(Kinds, BodyMemory, testing::ValuesIn(body_kinds()),
                         [](const auto& kind) { return std::string(kind.param.name); });

class HostileMesh : public Hostile {
 protected:
  void expect_refused_mesh(const std::string& text, const std::string& message) {
    expect_bounded({"mesh", "info", directory_ / "hostile.vtu"}, "hostile.vtu", text, message);
  }

  void expect_refused_series(const std::string& text, const std::string& message) {
    fs::create_directories(directory_ / "run");
    expect_bounded({"render", directory_ / "run", "-o", directory_ / "picture.png"}, "run/mesh.pvd", text, message);
  }
};

std::string many_attributes(int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += " a" + std::to_string(i) + "=''";
  return all;
}

const std::string kBegin = "<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'",
                  kSeries = "<VTKFile type='Collection'><Collection>";

TEST_F(HostileMesh, AttributesElementsAndLevelsInNumber) {
  const std::string attributes = many_attributes(1'200'000);  // 14 MB
  expect_refused_mesh(kBegin + attributes + "/>", "hostile.vtu:1: more than 500000 '='");
  expect_refused_series("<VTKFile" + attributes + "/>", ":1: more than 500000 '='");
  const std::string element = "<DataArray" + many_attributes(100) + "/>";
  expect_refused_mesh(kBegin + ">" + repeated(element, 20'000), "more than 500000 '='");
  expect_refused_mesh(kBegin + ">" + repeated("<a/>", 3'000'000), "more than 100000 elements");
  expect_refused_mesh(repeated("<a>", 4'000'000), "more than 100 levels of elements");
  expect_refused_series(kSeries + repeated("<DataSet timestep='0' group='' part='0' file='a'/>", 99'990) +
                            "\n<DataSet timestep='x' file='a'/></Collection></VTKFile>",
                        ":2: DataSet.timestep 'x', must be a finite number");
}

// As many pieces as a file may have elements for: their points are not moved for each of them anew.
TEST_F(HostileMesh, ManyPieces) {
  const std::string piece =
      "<Piece NumberOfPoints='1' NumberOfCells='0'><Points><DataArray type='Float64' format='ascii'>1 2 "
      "3</DataArray></Points></Piece>";
  expect_refused_mesh(
      kBegin + "><UnstructuredGrid>" + repeated(piece, 33'000) + "\n<Piece/></UnstructuredGrid></VTKFile>",
      "hostile.vtu:2: Piece: NumberOfPoints");
}

/// Data of zlib's: `count` blocks of 64 MB of zeros, as one data array.
class Inflated {
 public:
  Inflated() {
    const std::string zeros(kBlock, '\0');
    uLongf size = compressBound(kBlock);
    block_.resize(size);
    compress2(reinterpret_cast<Bytef*>(block_.data()), &size, reinterpret_cast<const Bytef*>(zeros.data()), kBlock, 9);
    block_.resize(size);
  }

  std::string array(std::uint64_t count) const {
    std::string bytes;
    const auto add = [&](std::uint64_t number) { bytes.append(reinterpret_cast<const char*>(&number), 8); };
    for (const std::uint64_t number : {count, std::uint64_t{kBlock}, std::uint64_t{0}}) add(number);
    for (std::uint64_t i = 0; i < count; ++i) add(block_.size());
    for (std::uint64_t i = 0; i < count; ++i) bytes += block_;
    return bytes;
  }

  static constexpr std::size_t kBlock = 64u << 20;

 private:
  std::string block_;
};

/// A file with the numbers of points and cells, and text arrays of offsets and types, that appends `data`.
std::string compressed(std::uint64_t points, std::uint64_t cells, const std::string& arrays, const std::string& data) {
  return kBegin +
         " header_type='UInt64' compressor='vtkZLibDataCompressor'><UnstructuredGrid>\n<Piece NumberOfPoints='" +
         std::to_string(points) + "' NumberOfCells='" + std::to_string(cells) + "'>" + arrays +
         "</Piece></UnstructuredGrid><AppendedData encoding='raw'>_" + data + "</AppendedData></VTKFile>";
}

TEST_F(HostileMesh, FewBytesThatStandForMany) {
  const Inflated zeros;
  const std::string array = zeros.array(18);  // 1.2 MB, 1.2 GB
  const std::uint64_t numbers = 18 * Inflated::kBlock / 8;
  EXPECT_LT(array.size(), 2'000'000u);
  const std::string points =
      "<Points><DataArray type='Float64' format='ascii'>0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 0 0 2 1 0 2 1 "
      "1 2 0 1 2</DataArray></Points>";
  const auto cells = [&](const std::string& type) {
    std::string ends = std::to_string(numbers), types = type;
    for (int i = 1; i < 8; ++i) ends += " " + std::to_string(numbers), types += " " + type;
    return "<Cells><DataArray type='Int64' Name='connectivity' format='appended' offset='0'/><DataArray type='Int64' "
           "Name='offsets' format='ascii'>" +
           ends + "</DataArray><DataArray type='UInt8' Name='types' format='ascii'>" + types + "</DataArray></Cells>";
  };
  expect_refused_mesh(compressed(12, 8, points + cells("12"), array), "cell 0 is of type 12 and has 150994944 points");
  expect_refused_mesh(compressed(12, 8, points + cells("7"), array), "DataArray: 150994996 numbers so far: ");
  expect_refused_mesh(
      compressed(numbers / 3, 8, "<Points><DataArray type='Float64' format='appended' offset='0'/></Points>", array),
      "numbers so far: ");
  const std::string appended = "format='appended' offset='0'/>";
  expect_refused_mesh(compressed(12, numbers * 8,
                                 points + "<Cells><DataArray type='UInt8' Name='offsets' " + appended +
                                     "<DataArray type='UInt8' Name='types' " + appended + "</Cells>",
                                 array),
                      "numbers so far: ");
}

// What is no number gives none leave.
TEST_F(HostileMesh, NumbersAreCountedAgainstTheirOwnData) {
  const std::uint64_t points = 3 * Inflated::kBlock / 8 / 3;
  // one copy alone: what the test itself holds would be charged to the command
  const std::string text =
      compressed(points, 0,
                 "<!--" + std::string(12'000'000, 'x') +
                     "--><Points><DataArray type='Float64' format='appended' offset='0'/></Points>",
                 Inflated().array(3));
  expect_refused_mesh(text, "25165824 numbers so far: ");
}

// Arrays that name the same bytes multiply them.
TEST_F(HostileMesh, ManyArraysOfTheSameBytes) {
  const std::uint64_t size = 12'000'000;
  const std::string data = std::string(reinterpret_cast<const char*>(&size), 8) + std::string(size, '\0');
  const std::string piece =
      "<Piece NumberOfPoints='500000' NumberOfCells='0'><Points><DataArray type='Float64' format='appended' "
      "offset='0'/></Points></Piece>";
  expect_refused_mesh(kBegin + " header_type='UInt64'><UnstructuredGrid>" + repeated(piece, 1000) +
                          "</UnstructuredGrid><AppendedData encoding='raw'>_" + data + "</AppendedData></VTKFile>",
                      "takes bytes that belong to other arrays");
}

}  // namespace
