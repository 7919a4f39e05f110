// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/faces.hpp"

#include <algorithm>
#include <set>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

std::vector<Quad> faces_of(std::span<const Hexahedron> hexahedra) {
  std::vector<Quad> faces;
  std::set<Quad> known;  // by sorted nodes
  for (const Hexahedron& corners : hexahedra) {
    for (const auto& local : kFaces) {
      Quad face = face_of(corners, local);
      if (!known.insert(sorted(face)).second) continue;
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      faces.push_back(face);
    }
  }
  return faces;
}

std::vector<Edge> edges_of(std::span<const Hexahedron> hexahedra) {
  std::vector<Edge> edges;
  std::set<Edge> known;
  for (const Hexahedron& corners : hexahedra) {
    for (const auto& [a, b] : kEdges) {
      const Edge edge = sorted(Edge{corners[a], corners[b]});
      if (known.insert(edge).second) edges.push_back(edge);
    }
  }
  return edges;
}

std::vector<double> nodal_means(const HexMesh& mesh, std::span<const double> of_hexahedra,
                                std::span<const unsigned char> alive) {
  require_count("nodal_means", "of_hexahedra", std::ssize(of_hexahedra), mesh.num_elements());
  if (!alive.empty()) require_count("nodal_means", "alive", std::ssize(alive), mesh.num_elements());
  std::vector<double> means(mesh.num_nodes(), 0.0);
  for (int node = 0; node < mesh.num_nodes(); ++node) {
    int count = 0;
    for (const HexMesh::Incidence& at : mesh.incident(node)) {
      if (!alive.empty() && !alive[at.element]) continue;
      means[node] += of_hexahedra[at.element];
      ++count;
    }
    if (count > 0) means[node] /= count;
  }
  return means;
}

bool hold_together(const HexMesh& mesh, std::span<const unsigned char> alive, std::span<const int> nodes) {
  require_count("hold_together", "alive", std::ssize(alive), mesh.num_elements());
  require_nodes("hold_together", nodes, mesh.num_nodes());
  if (nodes.empty()) throw InputError("hold_together: nodes has 0 rows, must have 1 at least");
  bool had_element = false;
  for (const auto& [element, corner] : mesh.incident(nodes[0])) {
    const Hexahedron& corners = mesh.hexahedra()[element];
    const bool has_all = std::ranges::all_of(nodes, [&](int node) { return std::ranges::count(corners, node) > 0; });
    if (has_all && alive[element]) return true;
    had_element = had_element || has_all;
  }
  return !had_element;
}

}  // namespace hexaplast
