// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/formats/mesh_export.hpp"
#include "mesh_source.hpp"

namespace hexaplast {
namespace {

/// Node of one corner of a face, `v`, `v/vt`, `v//vn` or `v/vt/vn`: from 1 on, or from the latest vertex back.
int corner(const MeshSource& source, std::string_view word, std::int64_t num_vertices) {
  const std::string_view text = word.substr(0, word.find('/'));
  std::int64_t number = 0;
  const bool is_number = read_number(text, number);
  const std::int64_t node = number > 0 ? number - 1 : num_vertices + number;
  if (!is_number || number == 0 || node < 0 || node >= num_vertices)
    source.refuse(fmt::format("'{}' is none of the {} vertices so far", excerpt(text), num_vertices));
  return static_cast<int>(node);
}

}  // namespace

ImportedMesh parse_obj(std::string_view content, const std::string& name) {
  MeshSource source(content, name);
  ImportedMesh mesh;
  std::vector<double> vertices;
  while (!source.at_end()) {
    const std::string_view line = source.line();
    MeshSource words(line, name);
    const std::string_view kind = words.word();
    if (kind == "v") {
      for (int d = 0; d < 3; ++d) {
        const std::string_view word = words.word();
        double number = 0;
        if (!read_number(word, number))
          source.refuse(fmt::format("'{}' is not a coordinate: must be a finite number", excerpt(word)));
        vertices.push_back(number);
      }
    } else if (kind == "f" || kind == "l") {
      std::vector<int> nodes;
      for (std::string_view word = words.word(); !word.empty(); word = words.word())
        nodes.push_back(corner(source, word, static_cast<std::int64_t>(vertices.size() / 3)));
      const std::size_t min = kind == "f" ? 3 : 2;
      if (nodes.size() < min) source.refuse(fmt::format("{} vertices, must be at least {}", nodes.size(), min));
      if (kind == "l") {
        for (std::size_t i = 0; i + 1 < nodes.size(); ++i) mesh.edges.push_back({nodes[i], nodes[i + 1]});
      } else if (nodes.size() == 4) {
        mesh.quads.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
      } else {
        for (std::size_t i = 1; i + 1 < nodes.size(); ++i) mesh.triangles.push_back({nodes[0], nodes[i], nodes[i + 1]});
      }
    }
  }
  mesh.positions = points_of(vertices);
  if (mesh.positions.rows() == 0) source.refuse("the file holds no vertex");
  merge_copies(mesh);
  return mesh;
}

std::string obj_text(const ExportedMesh& mesh) {
  std::string text;
  for (std::size_t i = 0; i + 2 < mesh.points.size(); i += 3)
    text += fmt::format("v {} {} {}\n", mesh.points[i], mesh.points[i + 1], mesh.points[i + 2]);
  const auto add = [&](char kind, const auto& cells) {
    for (const auto& cell : cells) {
      text += kind;
      for (const int node : cell) text += fmt::format(" {}", node + 1);
      text += '\n';
    }
  };
  add('l', mesh.edges);
  add('f', mesh.triangles);
  add('f', mesh.quads);
  return text;
}

}  // namespace hexaplast
