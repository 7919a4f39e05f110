// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/surface_vtu.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/vtu_grid.hpp"
#include "record/state_arrays.hpp"

namespace hexaplast::output {

CarriedSkins::CarriedSkins(const HexMesh& mesh, std::vector<Skin> skins) : skins_(std::move(skins)) {
  for (const Skin& skin : skins_) embeddings_.emplace_back(mesh.positions(), mesh.hexahedra(), skin.points);
}

void CarriedSkins::write(const std::filesystem::path& file, ConstPoints positions, const std::vector<double>& strains,
                         std::span<const unsigned char> alive) const {
  Eigen::Index num_points = 0;
  for (const Skin& skin : skins_) num_points += skin.points.rows();
  PointArray points(num_points, 3), displacement(num_points, 3), blended(num_points, 3);
  PointArray at_nodes = PointArray::Zero(positions.rows(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(strains.data(), positions.rows());

  std::vector<std::int32_t> surface, connectivity;
  std::vector<int> first_points;
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    const auto first = static_cast<Eigen::Index>(surface.size()), count = skins_[s].points.rows();
    embeddings_[s].apply(positions, points.middleRows(first, count));
    embeddings_[s].apply(at_nodes, blended.middleRows(first, count));
    displacement.middleRows(first, count) = points.middleRows(first, count) - skins_[s].points;
    first_points.push_back(static_cast<int>(first));
    surface.insert(surface.end(), static_cast<std::size_t>(count), static_cast<std::int32_t>(s));
  }
  // a skin that reaches out of the hexahedra continues their values, and shall not pass them
  const auto [least, most] = std::ranges::minmax(strains);
  std::vector<double> plastic_strain(surface.size());
  for (std::size_t p = 0; p < surface.size(); ++p)
    plastic_strain[p] = std::clamp(blended(static_cast<Eigen::Index>(p), 0), least, most);

  VtuGrid grid{.points = {points.data(), static_cast<std::size_t>(points.size())}, .shown_first = {}};
  const auto add_faces = [&](const auto& faces, std::size_t s, std::uint8_t type) {
    for (const auto& face : faces) {
      if (!is_carried(face, embeddings_[s], alive)) continue;
      for (const int point : face) connectivity.push_back(first_points[s] + point);
      grid.add_cells(1, type, static_cast<int>(face.size()));
    }
  };
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    add_faces(skins_[s].triangles, s, kVtkTriangle);
    add_faces(skins_[s].quads, s, kVtkQuad);
  }
  grid.connectivity = std::as_bytes(std::span(connectivity));
  grid.point_data = {vectors("displacement", displacement), scalars("Int32", "surface", surface),
                     scalars("Float64", "plastic_strain", plastic_strain)};
  grid.write(file);
}

std::vector<Skin> read_skins(const std::filesystem::path& file) {
  const ImportedState state = read_vtu_state(file);
  const PointArray original = state.mesh.positions - point_vectors(file, state, "displacement");
  const std::vector<int> surface = point_numbers(file, state, "surface");

  // points of a skin follow one another
  std::vector<Skin> skins;
  std::vector<int> number(surface.size());  // of a point in its skin
  for (std::size_t p = 0; p < surface.size(); ++p) {
    if (surface[p] == static_cast<int>(skins.size())) skins.emplace_back();
    if (surface[p] + 1 != static_cast<int>(skins.size()))
      throw InputError(fmt::format("{}: array 'surface' must count from 0 in steps of one", file.string()));
    number[p] = p > 0 && surface[p] == surface[p - 1] ? number[p - 1] + 1 : 0;
  }
  for (std::size_t s = 0, first = 0; s < skins.size(); ++s) {
    std::size_t last = first;
    while (last < surface.size() && surface[last] == static_cast<int>(s)) ++last;
    skins[s].points = original.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last - first));
    first = last;
  }
  const auto add_to_skin = [&](auto face, auto faces_of_skin) {
    const int s = surface[static_cast<std::size_t>(face[0])];
    for (int& point : face) {
      if (surface[static_cast<std::size_t>(point)] != s)
        throw InputError(fmt::format("{}: a face has points of two surfaces", file.string()));
      point = number[static_cast<std::size_t>(point)];
    }
    (skins[static_cast<std::size_t>(s)].*faces_of_skin).push_back(face);
  };
  for (const Triangle& triangle : state.mesh.triangles) add_to_skin(triangle, &Skin::triangles);
  for (const Quad& quad : state.mesh.quads) add_to_skin(quad, &Skin::quads);
  return skins;
}

}  // namespace hexaplast::output
