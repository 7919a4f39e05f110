// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/state/model.hpp"

#include <fmt/format.h>

#include <numeric>

#include "hexaplast/base/error.hpp"
#include "hexaplast/kinematics/gradients.hpp"

namespace hexaplast {

namespace {

/// Representative of a node's set in a disjoint-set forest, shortening the path on the way.
int representative(std::vector<int>& parent, int node) {
  while (parent[node] != node) node = parent[node] = parent[parent[node]];
  return node;
}

}  // namespace

Model::Model(HexMesh mesh_, std::vector<Material> materials_, Settings settings_)
    : mesh(std::move(mesh_)), materials(std::move(materials_)), settings(settings_) {
  const int num_elements = mesh.num_elements();
  if (materials.size() != 1 && materials.size() != static_cast<std::size_t>(num_elements))
    throw InputError(
        fmt::format("{} materials for {} hexahedra: one, or one per hexahedron", materials.size(), num_elements));
  validate(materials);
  validate(settings);

  lame.resize(num_elements);
  volume.resize(num_elements);
  corner_jacobian.resize(num_elements);
  original_shape.resize(num_elements);
  for (int e = 0; e < num_elements; ++e) {
    const ElementPoints X = gather(mesh.positions(), mesh.hexahedra()[e]);
    lame[e] = hexaplast::lame(material(e).young_modulus, material(e).poisson_ratio);
    volume[e] = hexaplast::volume(X);
    for (int a = 0; a < kCorners; ++a) corner_jacobian[e][a] = hexaplast::corner_jacobian(X, a).determinant();
    original_shape[e] = X.rowwise() - X.colwise().mean();
  }

  // connected parts, numbered by their first node
  std::vector<int> parent(mesh.num_nodes());
  std::iota(parent.begin(), parent.end(), 0);
  for (const Hexahedron& corners : mesh.hexahedra())
    for (const int node : corners) parent[representative(parent, node)] = representative(parent, corners[0]);
  component_of_node.assign(mesh.num_nodes(), -1);
  std::vector<int> number(mesh.num_nodes(), -1);
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (mesh.incident(n).empty()) continue;
    int& component = number[representative(parent, n)];
    if (component < 0) component = num_components++;
    component_of_node[n] = component;
  }
}

}  // namespace hexaplast
