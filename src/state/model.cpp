// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/simd.hpp"
#include "hexaplast/base/error.hpp"
#include "mesh/trilinear.hpp"
#include "state/history.hpp"

namespace hexaplast {

Model::Model(HexMesh mesh_, std::vector<Material> materials_, Settings settings_)
    : mesh(std::move(mesh_)), copies(mesh.num_nodes()), materials(std::move(materials_)), settings(settings_) {
  simd_target();  // or an error
  validate(settings);
  const int num_elements = mesh.num_elements();
  volume.resize(num_elements);
  double total_volume = 0;
  for (int e = 0; e < num_elements; ++e) {
    volume[e] = hexaplast::volume(gather(mesh.positions(), mesh.hexahedra()[e]));
    total_volume += volume[e];
  }
  if (num_elements > 0) length = std::exp2(std::round(std::log2(total_volume / num_elements) / 3));
  partition = std::make_shared<const Partition>(mesh);
  take_materials();
}

Model::Model(const Model& other, std::vector<Material> materials_) : Model(other) {
  materials = std::move(materials_);
  take_materials();
}

void Model::take_materials() {
  const int num_elements = mesh.num_elements();
  if (materials.size() != 1 && materials.size() != static_cast<std::size_t>(num_elements))
    throw InputError(
        fmt::format("{} materials for {} hexahedra: one, or one per hexahedron", materials.size(), num_elements));
  validate(materials);
  validate(materials, settings);

  is_plain = hexaplast::is_plain(materials, settings);
  tracks_plastic_stretch = settings.rest_shape == RestShape::kJoined &&
                           std::any_of(materials.begin(), materials.end(),
                                       [](const Material& m) { return std::isfinite(m.fracture_stretch); });
  can_stretch =
      std::any_of(materials.begin(), materials.end(), [](const Material& m) { return hexaplast::can_stretch(m); });
  can_rotate = std::any_of(materials.begin(), materials.end(),
                           [&](const Material& m) { return hexaplast::can_rotate(m, settings); });

  lame.resize(num_elements);
  for (int e = 0; e < num_elements; ++e)
    lame[e] = hexaplast::lame(material(e).young_modulus, material(e).poisson_ratio);
  fill_lame_blocks();
}

void Model::fill_lame_blocks() {
  lame_blocks.assign(static_cast<std::size_t>(partition->num_blocks) * 2 * kBlock, 0.0);
  for (int e = 0; e < mesh.num_elements(); ++e) {
    const int place = partition->place_of_element[e];
    double* at = lame_blocks.data() + static_cast<std::size_t>(place / kBlock) * 2 * kBlock + place % kBlock;
    at[0] = lame[e].mu;
    at[kBlock] = lame[e].lambda;
  }
}

const Joints& Model::joints() const {
  std::call_once(joints_->found, [&] { joints_->value.emplace(initial_mesh()); });
  return *joints_->value;
}

std::vector<int> Model::open(const History& history, int first_call) {
  std::vector<int> ends(history.end_of_opening.begin() + first_call, history.end_of_opening.end());
  const int first = first_call == 0 ? 0 : history.end_of_opening[first_call - 1];
  for (int& end : ends) end -= first;
  std::vector<unsigned char> is_open(joints().count(), 0);
  for (int k = 0; k < first; ++k) is_open[history.opened[k]] = 1;
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  std::vector<int> parents = copies.split(initial_mesh(), joints(), std::span(history.opened).subspan(first), ends,
                                          is_open, volume, hexahedra);
  if (parents.empty()) return parents;
  if (!initial_) initial_ = std::make_shared<const HexMesh>(mesh);
  take_mesh({*initial_, copies.initial(), std::move(hexahedra)});
  return parents;
}

void Model::close() {
  if (!copies.is_split()) return;
  copies = NodeCopies(initial_->num_nodes());
  take_mesh(*initial_);
}

void Model::take_mesh(HexMesh changed) {
  mesh = std::move(changed);
  partition = std::make_shared<const Partition>(mesh);
  fill_lame_blocks();
  coarse_ = std::make_shared<Shared<std::vector<CoarseMesh>>>();
}

ElementPoints Model::initial_shape(int element) const {
  return about_mean(gather(mesh.positions(), mesh.hexahedra()[element]));
}

std::array<double, kCorners> Model::corner_jacobian(int element) const {
  const ElementPoints X = gather(mesh.positions(), mesh.hexahedra()[element]);
  std::array<double, kCorners> jacobian;
  for (int a = 0; a < kCorners; ++a) jacobian[a] = hexaplast::corner_jacobian(X, a).determinant();
  return jacobian;
}

const std::vector<unsigned char>& Model::is_thin() const {
  // they are up to 65504 in half precision, and grow as an element becomes thinner by flow
  constexpr double kGreatestCoefficient = 1e3;
  std::call_once(thin_->found, [&] {
    std::vector<unsigned char>& thin = thin_->value.emplace();
    for (int e = 0; e < mesh.num_elements(); ++e) {
      const ElementPoints X = gather(mesh.positions(), mesh.hexahedra()[e]);
      double longest = 0;  // squared
      for (int a = 0; a < kCorners; ++a)
        for (int b = 0; b < a; ++b) longest = std::max(longest, (X.row(a) - X.row(b)).squaredNorm());
      const double min = std::ranges::min(corner_jacobian(e));
      thin.push_back(!(length * longest < kCorners * kGreatestCoefficient * min));
    }
  });
  return *thin_->value;
}

const std::vector<CoarseMesh>& Model::coarse_meshes() const {
  std::call_once(charts_->found, [&] { charts_->value.emplace(initial_mesh()); });
  std::call_once(coarse_->found, [&] { coarse_->value = hexaplast::coarse_meshes(*charts_->value, mesh, *partition); });
  return *coarse_->value;
}

}  // namespace hexaplast
