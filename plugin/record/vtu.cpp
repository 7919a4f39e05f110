// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/vtu.hpp"

#include <numeric>

#include "formats/vtu_grid.hpp"

namespace hexaplast::output {

void write_vtu(const std::filesystem::path& file, const Bodies& bodies, ConstPoints positions, ConstPoints velocities,
               ElementFields fields, const BoundaryConditions& conditions, const Regions& regions) {
  const HexMesh& mesh = bodies.mesh();
  const std::span<const unsigned char> alive = bodies.alive();
  const PointArray current = positions;
  const PointArray displacement = positions - mesh.positions();
  const PointArray velocity = velocities;

  // removed hexahedra are not shown
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  std::vector<std::int32_t> ids(hexahedra.size());
  std::iota(ids.begin(), ids.end(), 0);
  const auto keep_alive = [&](auto& values) {
    std::size_t kept = 0;
    for (std::size_t e = 0; e < values.size(); ++e)
      if (alive[e]) values[kept++] = values[e];
    values.resize(kept);
  };
  keep_alive(hexahedra);
  keep_alive(ids);
  std::vector<std::int32_t> region(regions.of_hexahedra.begin(), regions.of_hexahedra.end());
  if (!region.empty()) keep_alive(region);
  for (std::vector<double>* values :
       {&fields.plastic_strain, &fields.yield_stress, &fields.volume_ratio, &fields.stress_norm, &fields.strain})
    keep_alive(*values);

  const ConnectedParts parts = connected_parts(mesh, alive);
  std::vector<std::int32_t> part(hexahedra.size());
  for (std::size_t e = 0; e < part.size(); ++e) part[e] = parts.part_of_node[hexahedra[e][0]];

  VtuGrid grid{.points = {current.data(), static_cast<std::size_t>(current.size())},
               .connectivity = std::as_bytes(std::span(hexahedra)),
               .shown_first = "plastic_strain"};
  grid.add_cells(hexahedra.size(), kVtkHexahedron, kCorners);
  grid.point_data = {vectors("displacement", displacement),
                     vectors("plastic_rest_position", bodies.plastic_rest_positions()), vectors("velocity", velocity)};
  std::vector<std::int32_t> initial_nodes;  // in the mesh of all bodies as it was at first
  if (bodies.are_split()) {
    int first = 0;
    for (const Bodies::Entry& entry : bodies.all()) {
      for (const int node : entry.body->copies().initial()) initial_nodes.push_back(first + node);
      first += entry.body->copies().num_initial();
    }
    grid.point_data.push_back(scalars("Int32", kInitialNode, initial_nodes));
  }
  if (!conditions.fixed.empty()) grid.point_data.push_back(scalars("UInt8", "fixed", conditions.fixed));
  if (conditions.loads.rows() > 0) grid.point_data.push_back(vectors("load", conditions.loads));
  grid.cell_data = {scalars("Int32", "id", ids),
                    scalars("Int32", "part", part),
                    scalars("Float64", "stress_norm", fields.stress_norm),
                    scalars("Float64", "plastic_strain", fields.plastic_strain),
                    scalars("Float64", "yield_stress", fields.yield_stress),
                    scalars("Float64", "volume_ratio", fields.volume_ratio),
                    scalars("Float64", "strain", fields.strain)};
  std::vector<double> crossing, removed;
  if (const std::shared_ptr<const OpenFaces> open = bodies.open_faces()) {
    for (std::size_t e = 0; e < open->crossing.size(); ++e) {
      std::vector<double>& values = alive[e] ? crossing : removed;
      if (!alive[e]) {
        values.push_back(static_cast<double>(e));
        values.insert(values.end(), mesh.hexahedra()[e].begin(), mesh.hexahedra()[e].end());
      }
      values.insert(values.end(), open->crossing[e].begin(), open->crossing[e].end());
    }
    grid.cell_data.push_back(reals(kCrossing, 6, crossing));
    if (!removed.empty()) grid.field_arrays = {reals(kRemoved, kNumbersOfRemoved, removed)};
  }
  std::vector<std::int32_t> body_of;
  if (!bodies.is_one()) {
    for (const Bodies::Entry& entry : bodies.all())
      body_of.insert(body_of.end(), static_cast<std::size_t>(entry.body->mesh().num_elements()),
                     static_cast<std::int32_t>(&entry - bodies.all().data()));
    keep_alive(body_of);
    grid.cell_data.insert(grid.cell_data.begin() + 2, scalars("Int32", "body", body_of));
  }
  if (!region.empty()) grid.cell_data.push_back(scalars("Int32", "region", region));
  for (const std::string& name : regions.names)
    grid.field_data.push_back(
        {std::string(kRegionPrefix) + name, static_cast<std::int32_t>(grid.field_data.size()) + 1});
  grid.write(file);
}

}  // namespace hexaplast::output
