// SPDX-License-Identifier: LGPL-2.1-or-later
// VTK's XML files made to hurt: refused with a message, in 100 MB above their own size.
#include <zlib.h>

#include <algorithm>
#include <vector>

#include "support/cost.hpp"

namespace {

using namespace hexaplast::support;

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
      "<Piece NumberOfPoints='1' NumberOfCells='0'><Points><DataArray type='Float64' format='ascii'>1 2 3"
      "</DataArray></Points></Piece>";
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
      "1 2"
      " 0 1 2</DataArray></Points>";
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
