// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/dense_body.hpp"

#include <algorithm>
#include <utility>

#include "base/memory.hpp"
#include "base/require.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast::parts {
namespace {

std::vector<Lame> lame_of(const std::vector<Material>& materials) {
  std::vector<Lame> all;
  for (const Material& material : materials) all.push_back(lame(material.young_modulus, material.poisson_ratio));
  return all;
}

/// Options, where matrices of so many hexahedra fit into memory besides the body.
HexahedralBodyOptions fitting(HexahedralBodyOptions options, std::size_t num_hexahedra) {
  require_memory(static_cast<double>(num_hexahedra),
                 bytes_per_hexahedron(options.materials, options.settings) + DenseHexahedra::kBytesPerElement);
  return options;
}

bool is_left_handed(ConstPoints rest, const Hexahedron& corners) {
  return centre_jacobian(gather(rest, corners)).determinant() < 0;
}

/// For the measures: the same hexahedra, with corners 4 to 7 first where the other four make them left-handed. SOFA's
/// cubes are the same in both orders.
std::vector<Hexahedron> measured(ConstPoints rest, std::vector<Hexahedron> hexahedra, ElementMatrix matrix) {
  if (matrix != ElementMatrix::kCube) return hexahedra;
  for (const Hexahedron& corners : hexahedra) require_nodes("DenseBody", corners, rest.rows());
  for (Hexahedron& corners : hexahedra)
    if (is_left_handed(rest, corners)) std::rotate(corners.begin(), corners.begin() + 4, corners.end());
  return hexahedra;
}

}  // namespace

ElementFrame frame_of(std::string_view method) {
  if (method == "small") return ElementFrame::kWorld;
  return method == "polar" ? ElementFrame::kPolar : ElementFrame::kMeanEdges;
}

DenseBody::DenseBody(ConstPoints rest, const std::vector<Hexahedron>& hexahedra, HexahedralBodyOptions options,
                     DenseHexahedraSettings settings, double dt)
    : measured_(rest, measured(rest, hexahedra, settings.matrix), fitting(std::move(options), hexahedra.size()), dt),
      hexahedra_(rest, hexahedra, lame_of(body().materials()), settings) {}

void DenseBody::set_options(HexahedralBodyOptions options, double dt) {
  measured_.set_options(std::move(options), dt);
  hexahedra_.set_lame(lame_of(body().materials()));
}

void DenseBody::remove(std::span<const int> elements) {
  measured_.remove(elements);
  hexahedra_.set_alive(body().alive());
}

void DenseBody::reset() {
  measured_.reset();
  hexahedra_.set_alive(body().alive());
}

void DenseBody::serialize(Archive& archive) {
  measured_.serialize(archive);
  hexahedra_.set_lame(lame_of(body().materials()));
  hexahedra_.set_alive(body().alive());
}

}  // namespace hexaplast::parts
