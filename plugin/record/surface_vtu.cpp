// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/surface_vtu.hpp"

#include <fmt/format.h>

#include <optional>

#include "formats/vtu_grid.hpp"
#include "hexaplast/base/error.hpp"
#include "record/state_arrays.hpp"

namespace hexaplast::output {

CarriedSurfaces::CarriedSurfaces(const HexMesh& mesh, std::vector<EmbeddedSurface> embedded_surfaces)
    : embedded_surfaces_(std::move(embedded_surfaces)) {
  for (const EmbeddedSurface& embedded : embedded_surfaces_) embeddings_.push_back(embedded.embedding(mesh));
}

void CarriedSurfaces::write(const std::filesystem::path& file, const HexMesh& mesh, ConstPoints positions,
                            const std::vector<double>& strains, std::span<const unsigned char> alive,
                            const OpenFaces* open) {
  std::optional<CutWalls> walls;
  if (open) walls.emplace(mesh, *open, alive);
  std::vector<CarriedSurface> surfaces;
  std::vector<Embedding> embeddings;
  Eigen::Index num_points = 0;
  for (std::size_t s = 0; s < embedded_surfaces_.size(); ++s) {
    const EmbeddedSurface& embedded = embedded_surfaces_[s];
    embeddings_[s].follow(embedded.carriers(mesh), mesh.num_nodes());
    std::vector<Quad> faces;  // triangles first
    for (const auto& [a, b, c] : embedded.triangles) faces.push_back({a, b, c, c});
    faces.insert(faces.end(), embedded.quads.begin(), embedded.quads.end());
    surfaces.push_back(embedded.cut(mesh, embeddings_[s], std::move(faces), walls ? &*walls : nullptr));
    embeddings.push_back(walls ? embedded.embedding(mesh, surfaces.back()) : embeddings_[s]);
    num_points += surfaces.back().points.rows();
  }
  PointArray points(num_points, 3), displacement(num_points, 3), blended(num_points, 3);
  PointArray at_nodes = PointArray::Zero(positions.rows(), 3);  // in its first column
  at_nodes.col(0) = Eigen::VectorXd::Map(strains.data(), positions.rows());

  std::vector<std::int32_t> surface, connectivity;
  std::vector<int> first_points;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const auto first = static_cast<Eigen::Index>(surface.size()), count = surfaces[s].points.rows();
    embeddings[s].apply(positions, points.middleRows(first, count));
    embeddings[s].apply(at_nodes, blended.middleRows(first, count));
    displacement.middleRows(first, count) = points.middleRows(first, count) - surfaces[s].points;
    first_points.push_back(static_cast<int>(first));
    surface.insert(surface.end(), static_cast<std::size_t>(count), static_cast<std::int32_t>(s));
  }
  // an embedded surface that reaches out of the hexahedra continues their values, and shall not pass them
  const auto [min, max] = std::ranges::minmax(strains);
  std::vector<double> plastic_strain(surface.size());
  for (std::size_t p = 0; p < surface.size(); ++p)
    plastic_strain[p] = std::clamp(blended(static_cast<Eigen::Index>(p), 0), min, max);

  VtuGrid grid{.points = {points.data(), static_cast<std::size_t>(points.size())}, .shown_first = {}};
  std::vector<std::int32_t> is_wall;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (std::size_t f = 0; f < surfaces[s].faces.size(); ++f) {
      const Quad& face = surfaces[s].faces[f];
      if (!is_carried(face, embedded_surfaces_[s], embeddings[s], alive)) continue;
      const int num_corners = face[2] == face[3] ? 3 : 4;
      for (int k = 0; k < num_corners; ++k) connectivity.push_back(first_points[s] + face[k]);
      grid.add_cells(1, num_corners == 3 ? kVtkTriangle : kVtkQuad, num_corners);
      is_wall.push_back(surfaces[s].is_wall[f]);
    }
  grid.connectivity = std::as_bytes(std::span(connectivity));
  grid.point_data = {vectors("displacement", displacement), scalars("Int32", "surface", surface),
                     scalars("Float64", "plastic_strain", plastic_strain)};
  if (walls && !walls->empty()) grid.cell_data = {scalars("Int32", "wall", is_wall)};
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
