// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/surface_vtu.hpp"

#include <fmt/format.h>

#include "formats/vtu_grid.hpp"
#include "hexaplast/base/error.hpp"
#include "record/state_arrays.hpp"

namespace hexaplast::output {

CarriedSurfaces::CarriedSurfaces(const HexMesh& mesh, std::vector<EmbeddedSurface> embedded_surfaces)
    : embedded_surfaces_(std::move(embedded_surfaces)) {
  for (const EmbeddedSurface& embedded : embedded_surfaces_) embeddings_.push_back(embedded.embedding(mesh));
}

void CarriedSurfaces::write(const std::filesystem::path& file, const HexMesh& mesh, ConstPoints positions,
                            const std::vector<double>& strains, std::span<const unsigned char> alive) {
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s)
    embeddings_[s].follow(embedded_surfaces_[s].carriers(mesh), mesh.num_nodes());
  Eigen::Index num_points = 0;
  for (const EmbeddedSurface& embedded : embedded_surfaces_) num_points += embedded.points.rows();
  PointArray points(num_points, 3), displacement(num_points, 3), blended(num_points, 3);
  PointArray at_nodes = PointArray::Zero(positions.rows(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(strains.data(), positions.rows());

  std::vector<std::int32_t> surface, connectivity;
  std::vector<int> first_points;
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
    const auto first = static_cast<Eigen::Index>(surface.size()), count = embedded_surfaces_[s].points.rows();
    embeddings_[s].apply(positions, points.middleRows(first, count));
    embeddings_[s].apply(at_nodes, blended.middleRows(first, count));
    displacement.middleRows(first, count) = points.middleRows(first, count) - embedded_surfaces_[s].points;
    first_points.push_back(static_cast<int>(first));
    surface.insert(surface.end(), static_cast<std::size_t>(count), static_cast<std::int32_t>(s));
  }
  // an embedded surface that reaches out of the hexahedra continues their values, and shall not pass them
  const auto [min, max] = std::ranges::minmax(strains);
  std::vector<double> plastic_strain(surface.size());
  for (std::size_t p = 0; p < surface.size(); ++p)
    plastic_strain[p] = std::clamp(blended(static_cast<Eigen::Index>(p), 0), min, max);

  VtuGrid grid{.points = {points.data(), static_cast<std::size_t>(points.size())}, .shown_first = {}};
  const auto add_faces = [&](const auto& faces, std::size_t s, std::uint8_t type) {
    for (const auto& face : faces) {
      if (!is_carried(face, embedded_surfaces_[s], embeddings_[s], alive)) continue;
      for (const int point : face) connectivity.push_back(first_points[s] + point);
      grid.add_cells(1, type, static_cast<int>(face.size()));
    }
  };
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
    add_faces(embedded_surfaces_[s].triangles, s, kVtkTriangle);
    add_faces(embedded_surfaces_[s].quads, s, kVtkQuad);
  }
  grid.connectivity = std::as_bytes(std::span(connectivity));
  grid.point_data = {vectors("displacement", displacement), scalars("Int32", "surface", surface),
                     scalars("Float64", "plastic_strain", plastic_strain)};
  grid.write(file);
}

std::vector<EmbeddedSurface> read_embedded_surfaces(const std::filesystem::path& file) {
  const ImportedState state = read_vtu_state(file);
  const PointArray initial = state.mesh.positions - point_vectors(file, state, "displacement");
  const std::vector<int> surface = point_numbers(file, state, "surface");

  // points of an embedded surface follow one another
  std::vector<EmbeddedSurface> embedded_surfaces;
  std::vector<int> number(surface.size());  // of a point in its embedded surface
  for (std::size_t p = 0; p < surface.size(); ++p) {
    if (surface[p] == static_cast<int>(embedded_surfaces.size())) embedded_surfaces.emplace_back();
    if (surface[p] + 1 != static_cast<int>(embedded_surfaces.size()))
      throw InputError(fmt::format("{}: array 'surface' must count from 0 in steps of one", file.string()));
    number[p] = p > 0 && surface[p] == surface[p - 1] ? number[p - 1] + 1 : 0;
  }
  for (std::size_t s = 0, first = 0; s < embedded_surfaces.size(); ++s) {
    std::size_t last = first;
    while (last < surface.size() && surface[last] == static_cast<int>(s)) ++last;
    embedded_surfaces[s].points =
        initial.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last - first));
    first = last;
  }
  const auto add_to_surface = [&](auto face, auto faces_of_surface) {
    const int s = surface[static_cast<std::size_t>(face[0])];
    for (int& point : face) {
      if (surface[static_cast<std::size_t>(point)] != s)
        throw InputError(fmt::format("{}: a face has points of two surfaces", file.string()));
      point = number[static_cast<std::size_t>(point)];
    }
    (embedded_surfaces[static_cast<std::size_t>(s)].*faces_of_surface).push_back(face);
  };
  for (const Triangle& triangle : state.mesh.triangles) add_to_surface(triangle, &EmbeddedSurface::triangles);
  for (const Quad& quad : state.mesh.quads) add_to_surface(quad, &EmbeddedSurface::quads);
  return embedded_surfaces;
}

}  // namespace hexaplast::output
