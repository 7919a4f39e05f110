// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "hexaplast/base/error.hpp"
#include "mesh/copies.hpp"

namespace hexaplast {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

std::string name_of_vtk_cell(int kind) {
  static const std::map<int, const char*> kNames{{1, "points"},
                                                 {4, "polylines"},
                                                 {7, "polygons"},
                                                 {10, "tetrahedra"},
                                                 {13, "prisms"},
                                                 {14, "pyramids"},
                                                 {21, "edges of 3 nodes"},
                                                 {22, "triangles of 6 nodes"},
                                                 {23, "quads of 8 nodes"},
                                                 {24, "tetrahedra of 10 nodes"},
                                                 {25, "hexahedra of 20 nodes"},
                                                 {26, "prisms of 15 nodes"},
                                                 {27, "pyramids of 13 nodes"},
                                                 {28, "quads of 9 nodes"},
                                                 {29, "hexahedra of 27 nodes"},
                                                 {32, "prisms of 18 nodes"},
                                                 {72, "hexahedra of higher order"}};
  const auto found = kNames.find(kind);
  return found == kNames.end() ? fmt::format("cells of VTK type {}", kind) : found->second;
}

/// Leaves the first one of equal cells. Returns the new number of each.
template <class Cell>
std::vector<int> leave_first(std::vector<Cell>& cells, int& num_copies) {
  std::vector<int> number = first_copies<Cell>(cells);
  int next = 0;
  for (std::size_t c = 0; c < number.size(); ++c) {
    if (number[c] != static_cast<int>(c)) {
      number[c] = number[number[c]];  // of the first, which has its new one
      ++num_copies;
    } else {
      cells[next] = cells[c];
      number[c] = next++;
    }
  }
  cells.resize(static_cast<std::size_t>(next));
  return number;
}

template <class Number>
bool read_whole(std::string_view word, Number& number) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);  // from_chars knows no plus sign
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, number);
  return error == std::errc() && stop == end;
}

}  // namespace

bool read_number(std::string_view word, double& number) { return read_whole(word, number) && std::isfinite(number); }
bool read_value(std::string_view word, double& number) { return read_whole(word, number); }
bool read_number(std::string_view word, std::int64_t& number) { return read_whole(word, number); }

std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return small;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  return text.substr(first, text.find_last_not_of(" \t\r\n") + 1 - first);
}

PointArray points_of(const std::vector<double>& coordinates) {
  return Eigen::Map<const PointArray>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
}

void MeshSource::refuse(const std::string& what) const {
  const auto line = 1 + std::count(content_.begin(), content_.begin() + static_cast<std::ptrdiff_t>(latest_), '\n');
  throw InputError(fmt::format("{}:{}: {}", name_, line, what));
}

void MeshSource::refuse_at_byte(const std::string& what) const {
  throw InputError(fmt::format("{}: byte {}: {}", name_, at_, what));
}

void MeshSource::refuse_data(const std::string& what) const { is_binary ? refuse_at_byte(what) : refuse(what); }

std::string_view MeshSource::line() {
  latest_ = at_;
  const std::size_t end = std::min(content_.find('\n', at_), content_.size());
  std::string_view found = content_.substr(at_, end - at_);
  at_ = std::min(end + 1, content_.size());
  if (found.ends_with('\r')) found.remove_suffix(1);
  return found;
}

std::string_view MeshSource::word() {
  const std::size_t first = std::min(content_.find_first_not_of(kBlanks, at_), content_.size());
  const std::size_t end = std::min(content_.find_first_of(kBlanks, first), content_.size());
  latest_ = first;
  at_ = end;
  return content_.substr(first, end - first);
}

std::string_view MeshSource::expected_word(std::string_view what) {
  const std::string_view found = word();
  if (found.empty()) refuse(fmt::format("the file ends where {} is expected", what));
  return found;
}

void MeshSource::expect(std::string_view wanted) {
  const std::string_view found = expected_word(wanted);
  if (found != wanted) refuse(fmt::format("'{}' stands where {} is expected", excerpt(found), wanted));
}

double MeshSource::real(const char* what) {
  const std::string_view text = expected_word(what);
  double number = 0;
  if (!read_number(text, number)) refuse(fmt::format("'{}' is not {}: must be a finite number", excerpt(text), what));
  return number;
}

std::int64_t MeshSource::integer(const char* what, std::int64_t min, std::int64_t max) {
  const std::string_view text = expected_word(what);
  std::int64_t number = 0;
  if (!read_number(text, number) || number < min || number > max)
    refuse(fmt::format("'{}' is not {}: must be a whole number in [{}, {}]", excerpt(text), what, min, max));
  return number;
}

std::size_t MeshSource::count(const char* what, std::size_t bytes) {
  return checked_count(static_cast<std::uint64_t>(integer(what, 0, kMost)), what, bytes, false);
}

std::size_t MeshSource::checked_count(std::uint64_t number, const char* what, std::size_t bytes,
                                      bool is_in_data) const {
  if (const std::size_t max = remaining() / bytes; number > max) {
    const std::string reason = fmt::format("{} is {}: the rest of the file has room for {} at most", what, number, max);
    is_in_data ? refuse_data(reason) : refuse(reason);
  }
  return static_cast<std::size_t>(number);
}

std::int64_t MeshSource::number(const NumberType& type, const char* what, std::int64_t min, std::int64_t max) {
  if (!is_binary) return integer(what, min, max);
  if (type.is_real) refuse_at_byte("real numbers stand where whole ones must be");
  const auto number = binary<std::int64_t>(type);
  if (number < min || number > max)
    refuse_at_byte(fmt::format("{} is not {}: must lie in [{}, {}]", number, what, min, max));
  return number;
}

const char* MeshSource::skip(std::size_t bytes) {
  if (remaining() < bytes) refuse_at_byte("the file ends in the middle of binary data");
  at_ += bytes;
  return content_.data() + at_ - bytes;
}

void MeshSource::skip_past_line(std::string_view wanted) {
  while (!at_end())
    if (line() == wanted) return;
  refuse(fmt::format("the file ends where {} is expected", wanted));
}

std::vector<int> merge_copies(ImportedMesh& mesh) {
  leave_first(mesh.edges, mesh.num_copies);
  leave_first(mesh.triangles, mesh.num_copies);
  leave_first(mesh.quads, mesh.num_copies);
  return leave_first(mesh.hexahedra, mesh.num_copies);
}

std::size_t corners_of_vtk_cell(int kind) {
  static constexpr std::array<std::size_t, 13> kCornersOfKind{0, 0, 0, 2, 0, 3, 0, 0, 4, 4, 0, 8, 8};
  const auto place = static_cast<std::size_t>(kind);
  return place < kCornersOfKind.size() ? kCornersOfKind[place] : 0;
}

bool add_vtk_cell(int kind, const std::int64_t* nodes, std::size_t num_nodes, ImportedMesh& mesh) {
  const auto take = [&]<std::size_t N>(std::vector<std::array<int, N>>& cells, const std::array<int, N>& order) {
    if (num_nodes != N) return false;
    std::array<int, N> cell;
    for (std::size_t a = 0; a < N; ++a) cell[a] = static_cast<int>(nodes[order[a]]);
    cells.push_back(cell);
    return true;
  };
  switch (kind) {
    case 3:
      return take(mesh.edges, {0, 1});
    case 5:
      return take(mesh.triangles, {0, 1, 2});
    case 8:  // a pixel's corners lie row by row
      return take(mesh.quads, {0, 1, 3, 2});
    case 9:
      return take(mesh.quads, {0, 1, 2, 3});
    case 11:  // and so do a voxel's
      return take(mesh.hexahedra, {0, 1, 3, 2, 4, 5, 7, 6});
    case 12:
      return take(mesh.hexahedra, {0, 1, 2, 3, 4, 5, 6, 7});
    default:
      ++mesh.skipped[name_of_vtk_cell(kind)];
      return true;
  }
}

}  // namespace hexaplast
