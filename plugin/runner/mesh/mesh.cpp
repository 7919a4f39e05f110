// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/mesh.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/offset.hpp"
#include "runner/command.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

/// What is found in a file.
struct MeshFindings {
  ImportedMesh file;
  Vec3 extent = Vec3::Zero();  // [m] of the box around all nodes
  std::optional<HexMesh> mesh;
  std::optional<QuadSurface> surface;  // of quads and nothing else, that can be offset
  OffsetLimits limits;
  std::string no_surface;  // why quads and triangles make none
};

MeshFindings look_at(const std::filesystem::path& name) {
  MeshFindings found;
  found.file = load_mesh(name);
  const ImportedMesh& file = found.file;
  if (file.positions.rows() > 0)
    found.extent = (file.positions.colwise().maxCoeff() - file.positions.colwise().minCoeff()).transpose();
  if (!file.hexahedra.empty()) {
    found.mesh.emplace(file.positions, file.hexahedra);
  } else if (!file.quads.empty() || !file.triangles.empty()) {
    try {
      ImportedMesh faces = file;  // as mesh offset takes them
      faces.edges.clear();
      remove_unused_nodes(faces);
      found.surface = surface_of(faces);
      found.limits = offset_limits(*found.surface, offset_directions(*found.surface));
    } catch (const InputError& error) {
      found.surface.reset();
      found.no_surface = error.what();
    }
  }
  return found;
}

int num_parts(const HexMesh& mesh) {
  return connected_parts(mesh, std::vector<unsigned char>(static_cast<std::size_t>(mesh.num_elements()), 1)).count;
}

Json json_of(const HexMesh& mesh) {
  const MeshQuality shape = quality(mesh);
  return {{"parts", num_parts(mesh)},
          {"volume", shape.volume},
          {"unused_nodes", shape.num_unused_nodes},
          {"boundary_faces", mesh.boundary_faces().size()},
          {"least_scaled_jacobian", shape.min_scaled_jacobian},
          {"worst_hexahedron", shape.worst_element},
          {"shortest_edge", shape.shortest_edge},
          {"longest_edge", shape.longest_edge}};
}

/// What is not limited is infinite, which is null in the text of JSON.
Json json_of(const MeshFindings& found) {
  int num_skipped = 0;
  for (const auto& [kind, count] : found.file.skipped) num_skipped += count;
  Json json = {{"nodes", found.file.positions.rows()},
               {"edges", found.file.edges.size()},
               {"triangles", found.file.triangles.size()},
               {"quads", found.file.quads.size()},
               {"hexahedra", found.file.hexahedra.size()},
               {"skipped_cells", num_skipped},
               {"skipped_kinds", found.file.skipped},
               {"copies", found.file.num_copies},
               {"extent", {found.extent.x(), found.extent.y(), found.extent.z()}},
               {"body", found.mesh ? json_of(*found.mesh) : Json(nullptr)},
               {"surface", nullptr}};
  if (found.surface)
    json["surface"] = {{"closed", found.surface->is_closed()},
                       {"most_inward", found.limits.inward},
                       {"most_outward", found.limits.outward}};
  return json;
}

std::string limit(double value) { return std::isfinite(value) ? fmt::format("less than {:.4g} m", value) : "any way"; }

void print(const MeshFindings& found, const std::string& title) {
  fmt::print("{}\n", printable_line(title));
  fmt::print("  nodes               {}\n", found.file.positions.rows());
  for (const auto& [name, count] :
       {std::pair("edges", found.file.edges.size()), std::pair("triangles", found.file.triangles.size()),
        std::pair("quads", found.file.quads.size())})
    if (count > 0) fmt::print("  {:<20}{}\n", name, count);
  if (found.mesh)
    print_hexahedra(*found.mesh);
  else
    fmt::print("  size                {:.4g} x {:.4g} x {:.4g} m\n", found.extent.x(), found.extent.y(),
               found.extent.z());
  if (found.surface)
    fmt::print("  surface             {}; can be offset {} inward, {} outward\n",
               found.surface->is_closed() ? "closed" : "open", limit(found.limits.inward), limit(found.limits.outward));
  if (!found.no_surface.empty()) fmt::print("  surface             cannot be offset: {}\n", found.no_surface);
}

void warn_of_skipped(const std::filesystem::path& file, const ImportedMesh& mesh) {
  for (const std::string& sentence : what_is_left_out(mesh))
    spdlog::warn("{}: warning: {}", printable_line(file.string()), printable_line(sentence));
}

struct MeshInfoOptions {
  std::filesystem::path file;
  bool json = false;
};

/// Prints what a mesh file holds: counts, size, volume and shape of hexahedra, and how far a surface of quads can be
/// offset. Throws InputError for hexahedra that make no mesh.
void print_info(const MeshInfoOptions& options) {
  const MeshFindings found = look_at(options.file);
  if (options.json)
    fmt::print("{}\n", json_of(found).dump(2));
  else
    print(found, options.file.stem().string());
  flush_standard_output();
  warn_of_skipped(options.file, found.file);
}

struct MeshConvertOptions {
  std::filesystem::path file;
  std::filesystem::path out;
};

/// Nothing is judged or changed; cells of kinds that we do not read are left out, with a warning.
void convert(const MeshConvertOptions& options) {
  require_vtu(options.out);
  const ImportedMesh mesh = load_mesh(options.file);
  warn_of_skipped(options.file, mesh);
  save_mesh(options.out,
            {.points = coordinates_of(mesh.positions),
             .edges = mesh.edges,
             .triangles = mesh.triangles,
             .quads = mesh.quads,
             .hexahedra = mesh.hexahedra},
            InputFiles({options.file}));
}

}  // namespace

void add_out(CLI::App& command, std::filesystem::path& out) {
  add_option(command, "-o,--out", out, "FILE", "File to write, .vtu; replaces an older one")->required();
}

void add_mesh(CLI::App& app, Call& call) {
  CLI::App* mesh = app.add_subcommand("mesh", "Make meshes, and write those of scenes");
  mesh->require_subcommand(1);
  for (const auto add : {add_mesh_export, add_mesh_offset, add_mesh_cage, add_mesh_grid, add_mesh_sheet, add_mesh_tube,
                         add_mesh_sphere_patch, add_mesh_voxels, add_mesh_info, add_mesh_convert})
    add(*mesh, call);
}

void require_vtu(const std::filesystem::path& file) {
  if (file.extension() != ".vtu") throw UsageError(fmt::format("--out {}: the name must end in .vtu", file.string()));
}

void save_mesh(const std::filesystem::path& file, const ExportedMesh& mesh, const InputFiles& inputs) {
  WholeFile out(output_place(file, inputs));
  out.write(vtu_text(mesh));
  out.commit();
}

void print_hexahedra(const HexMesh& mesh) {
  const MeshQuality shape = quality(mesh);
  const Vec3 extent = (mesh.positions().colwise().maxCoeff() - mesh.positions().colwise().minCoeff()).transpose();
  const int parts = num_parts(mesh);
  fmt::print("  hexahedra           {} in {} part{}, {} faces outside\n", mesh.num_elements(), parts,
             parts == 1 ? "" : "s", mesh.boundary_faces().size());
  if (shape.num_unused_nodes > 0) fmt::print("  nodes of none       {}\n", shape.num_unused_nodes);
  fmt::print("  size                {:.4g} x {:.4g} x {:.4g} m, {:.6g} m^3\n", extent.x(), extent.y(), extent.z(),
             shape.volume);
  fmt::print("  shape               min scaled Jacobian {:.3f} (hexahedron {}), edges {:.4g} to {:.4g} m\n",
             shape.min_scaled_jacobian, shape.worst_element, shape.shortest_edge, shape.longest_edge);
}

void add_mesh_info(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "info", "Print what a mesh file holds, its size, volume and shape", print_info,
                     [](const MeshInfoOptions& given) { return given.file.string(); });
  add_option(command, "file", options.file, "FILE", "Mesh file: .vtu, .vtk, .msh, .obj or .stl")->required();
  command.add_flag("--json", options.json, "As JSON");
}

void add_mesh_convert(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "convert", "Write the cells of a mesh file as .vtu", convert,
                     [](const MeshConvertOptions& given) { return given.file.string(); });
  add_option(command, "file", options.file, "FILE", "Mesh file: .vtu, .vtk, .msh, .obj or .stl")->required();
  add_out(command, options.out);
}

}  // namespace hexaplast::runner
