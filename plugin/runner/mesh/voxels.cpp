// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/voxels.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "formats/text.hpp"
#include "formats/vtu_grid.hpp"
#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/formats/volume_import.hpp"
#include "hexaplast/formats/whole_file.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "runner/command.hpp"
#include "runner/mesh/mesh.hpp"
#include "runner/mesh/voxel_scene.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

struct MeshVoxelsOptions {
  std::filesystem::path segmentation;
  std::vector<int> labels;  ///< empty: all but 0
  int coarsening = 1;
  bool largest_part = false;
  std::string unit = "m";       ///< of the written lengths: m, cm or mm
  bool ascii = false;           ///< numbers as text
  bool surfaces = false;        ///< besides, FILE_LABEL.obj for each label
  bool covers = false;          ///< VoxelCells::covers
  std::filesystem::path scene;  ///< to write; empty: none
  std::string hold = "back";    ///< VoxelScene::hold
  bool force = false;           ///< an older scene is replaced
  std::filesystem::path out;
};

constexpr double kCubicMillimetresPerMillilitre = 1000;

double mm_per(const std::string& unit) {
  if (unit == "mm") return 1;
  return unit == "cm" ? 10 : 1000;
}

void write_vtu(const std::filesystem::path& file, const VoxelMesh& made, bool is_of_patient, bool ascii) {
  const HexMesh& mesh = made.mesh;
  VtuGrid grid{.points = coordinates_of(mesh.positions()), .connectivity = std::as_bytes(std::span(mesh.hexahedra()))};
  grid.add_cells(mesh.hexahedra().size(), kVtkHexahedron, kCorners);
  const std::vector<std::int32_t> labels(made.labels.begin(), made.labels.end());
  grid.cell_data.push_back(scalars("Int32", "label", labels));
  grid.shown_first = "label";
  if (is_of_patient) grid.field_data.push_back({std::string(kOfPatient), 1});
  if (!ascii) return grid.write(file);
  WholeFile out(file);
  out.write(grid.text());
  out.commit();
}

/// "body.vtu" and "2" make "body_2.obj".
std::filesystem::path surface_place(std::filesystem::path out, std::string_view of) {
  const std::string stem = out.stem().string();
  return out.replace_filename(fmt::format("{}_{}.obj", stem, of));
}

VoxelSurface smooth_surface(const VoxelMesh& made, int label, const ImportedVolume& found, const VoxelCells& cells) {
  return surface_of_label(made, label, cells.coarsening / cells.mm_per_length * found.volume.axes());
}

void write_surface(const std::filesystem::path& file, const ExportedMesh& surface, const ImportedVolume& found) {
  WholeFile out(output_place(file, InputFiles(found.files)));
  out.write(obj_text(surface));
  out.commit();
}

void write_surfaces(const MeshVoxelsOptions& options, const ImportedVolume& found, const VoxelCells& cells,
                    const VoxelMesh& made) {
  for (const int label : std::set<int>(made.labels.begin(), made.labels.end())) {
    const VoxelSurface surface = smooth_surface(made, label, found, cells);
    write_surface(surface_place(options.out, std::to_string(label)),
                  {.points = coordinates_of(surface.positions), .quads = surface.quads}, found);
  }
}

/// The surface around all that has a label, as fine as the image unless that makes it too large. Where a mesh covers
/// its voxels, parts that hang together there may not do so in the image: all are kept that lie within the mesh.
VoxelSurface outer_surface(const ImportedVolume& found, VoxelCells cells, const HexMesh& mesh) {
  constexpr double kMostHexahedra = 250'000;
  double num_voxels = 0;
  for (std::size_t l = 1; l <= found.volume.labels().size(); ++l)
    num_voxels += static_cast<double>(found.volume.count(l));
  const auto least = static_cast<int>(std::ceil(std::cbrt(num_voxels / kMostHexahedra)));
  bool chooses = false;
  if (least < cells.coarsening) {
    cells.coarsening = std::max(least, 1);
    chooses = cells.covers && cells.largest_part;
    cells.covers = false;
    cells.largest_part = cells.largest_part && !chooses;
  }
  VoxelMesh fine = mesh_of_voxels(found.volume, cells);
  std::ranges::fill(fine.labels, 1);
  if (chooses) {
    PointArray centres(fine.mesh.num_elements(), 3);
    for (int e = 0; e < fine.mesh.num_elements(); ++e)
      centres.row(e) =
          gather(fine.mesh.positions(), fine.mesh.hexahedra()[static_cast<std::size_t>(e)]).colwise().mean();
    const Embedding in_mesh(mesh.positions(), mesh.hexahedra(), centres);
    for (int e = 0; e < fine.mesh.num_elements(); ++e)
      if (std::ranges::min(in_mesh.weights_of(e)) < 0) fine.labels[static_cast<std::size_t>(e)] = 2;
  }
  return smooth_surface(fine, 1, found, cells);
}

/// Without links.
std::filesystem::path directory_of(const std::filesystem::path& file) {
  return std::filesystem::weakly_canonical(std::filesystem::absolute(file).parent_path());
}

/// A scene and the surface that it embeds, before they are written.
struct PlannedScene {
  std::filesystem::path surface_file;
  VoxelSurface surface;
  std::string text = {};

  void write(const MeshVoxelsOptions& options, const ImportedVolume& found) const {
    std::vector<Triangle> triangles;  // contact takes these alone
    for (const auto& [a, b, c, d] : surface.quads) triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
    write_surface(surface_file, {.points = coordinates_of(surface.positions), .triangles = triangles}, found);
    WholeFile out(output_place(options.scene, InputFiles(found.files)));
    out.write(text);
    out.commit();
  }
};

PlannedScene plan_scene(const MeshVoxelsOptions& options, const ImportedVolume& found, const VoxelCells& cells,
                        const VoxelMesh& made) {
  const auto seen_from_scene = [&](const std::filesystem::path& of) {
    return (directory_of(of) / of.filename()).lexically_relative(directory_of(options.scene)).generic_string();
  };
  PlannedScene scene{.surface_file = surface_place(options.out, "surface"),
                     .surface = outer_surface(found, cells, made.mesh)};
  const VoxelScene words{.title = options.scene.stem().string(),
                         .mesh_file = seen_from_scene(options.out),
                         .surface_file = seen_from_scene(scene.surface_file),
                         .hold = options.hold,
                         .names = found.volume.names};
  try {
    scene.text = scene_of_voxels(words, made, scene.surface.positions);
  } catch (const InputError& error) {
    throw UsageError(fmt::format("--hold: {}", error.what()));
  }
  return scene;
}

void print_summary(const MeshVoxelsOptions& options, const LabelledVolume& volume, const VoxelMesh& made) {
  const PointArray& x = made.mesh.positions();
  const Vec3 min = x.colwise().minCoeff().transpose(), max = x.colwise().maxCoeff().transpose();
  Vec3 edges;  // [mm]
  for (int d = 0; d < 3; ++d) edges[d] = options.coarsening * volume.axes().col(d).norm();
  const double millilitres =
      std::abs((options.coarsening * volume.axes()).determinant()) / kCubicMillimetresPerMillilitre;

  fmt::print("{}: hexahedra of {:.4g} x {:.4g} x {:.4g} mm\n", printable_line(options.out.stem().string()), edges[0],
             edges[1], edges[2]);
  fmt::print("  nodes               {}\n", made.mesh.num_nodes());
  fmt::print("  hexahedra           {} in {} part{}\n", made.mesh.num_elements(), made.num_parts,
             made.num_parts == 1 ? "" : "s");
  if (made.num_left_out > 0) fmt::print("  left out            {} of smaller parts\n", made.num_left_out);
  std::map<int, int> count;
  for (const int label : made.labels) ++count[label];
  for (const auto& [label, cells] : count) {
    const auto name = volume.names.find(label);
    fmt::print("  {:<20}{} hexahedra, {:.6g} ml{}\n", fmt::format("label {}", label), cells, cells * millilitres,
               name == volume.names.end() ? "" : fmt::format("  {}", printable_line(name->second)));
  }
  fmt::print("  from                {:.6g} {:.6g} {:.6g} {}\n", min[0], min[1], min[2], options.unit);
  fmt::print("  to                  {:.6g} {:.6g} {:.6g} {}\n", max[0], max[1], max[2], options.unit);
  flush_standard_output();
}

/// Regions that a scene would look for in vain.
void warn_of_lost_labels(const MeshVoxelsOptions& options, const LabelledVolume& volume, const VoxelMesh& made) {
  const std::set<int> in_volume(volume.labels().begin(), volume.labels().end());
  for (const auto& [label, name] : volume.names)
    if (!in_volume.contains(label))
      spdlog::warn("{}: warning: no voxel has the label {} of the segment '{}'", options.segmentation.string(), label,
                   printable_line(name));
  std::set<int> lost(options.labels.begin(), options.labels.end());
  if (lost.empty()) lost = in_volume;
  for (const int label : made.labels) lost.erase(label);
  for (const int label : lost) spdlog::warn("warning: no hexahedron has the label {}, though voxels have it", label);
}

/// Writes the labelled voxels of a segmentation as hexahedra (.vtu), with the cell data `label`, and prints what they
/// are; surfaces of the labels too (.obj), if they are wanted.
void make_voxels(const MeshVoxelsOptions& options) {
  require_vtu(options.out);
  if (!options.scene.empty() && options.unit != "m")
    throw UsageError("--scene: scenes are in metres: leave --unit out");
  if (!options.scene.empty()) {
    if (options.scene.extension() != ".scn") throw UsageError("--scene: the name must end in .scn");
    for (const std::filesystem::path& file : {options.scene, surface_place(options.out, "surface")})
      if (!options.force && std::filesystem::exists(file))
        throw OutputError(
            fmt::format("{} is there already: take another name, or --force to replace it", file.string()));
    if (!std::filesystem::is_directory(directory_of(options.scene)))
      throw OutputError(fmt::format("{}: no such directory", directory_of(options.scene).string()));
  }
  const VoxelCells cells{.labels = options.labels,
                         .coarsening = options.coarsening,
                         .covers = options.covers,
                         .largest_part = options.largest_part,
                         .mm_per_length = mm_per(options.unit)};
  const ImportedVolume found =
      load_file(options.segmentation, [&] { return read_volume(options.segmentation, cells); });
  const VoxelMesh made = mesh_of_voxels(found.volume, cells);
  std::optional<PlannedScene> scene;
  if (!options.scene.empty())
    scene.emplace(load_file(options.segmentation, [&] { return plan_scene(options, found, cells, made); }));
  write_vtu(output_place(options.out, InputFiles(found.files)), made, found.has_frame,
            options.ascii || !options.scene.empty());
  if (options.surfaces) write_surfaces(options, found, cells, made);
  if (scene) scene->write(options, found);
  print_summary(options, found.volume, made);
  if (!found.has_frame)
    spdlog::warn("{}: warning: the file does not say where left, back and head are: its axes are taken for x, y and z",
                 options.segmentation.string());
  warn_of_lost_labels(options, found.volume, made);
  if (scene && made.num_parts > 1)
    spdlog::warn(
        "warning: the scene holds a side of {} unconnected parts, of which some may be free to fly: "
        "--largest-part keeps one",
        made.num_parts);
  if (made.num_hinges > 0)
    spdlog::warn("warning: hexahedra meet at {} nodes without sharing a face there: they fold freely about them",
                 made.num_hinges);
}

}  // namespace

void add_mesh_voxels(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "voxels", "Make hexahedra of the labelled voxels of a segmented image", make_voxels,
                     [](const MeshVoxelsOptions& given) { return given.segmentation.string(); });
  add_option(command, "segmentation", options.segmentation, "SEGMENTATION",
             "Volume of labels: .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd")
      ->required();
  add_out(command, options.out);
  add_option(command, "--labels", options.labels, "L,L,...",
             "Labels that become hexahedra. Default: all but 0, the background")
      ->delimiter(',');
  add_option(command, "--coarsen", options.coarsening, "N",
             "One hexahedron for N x N x N voxels, if at least half of them have a label; it has the most frequent "
             "one")
      ->check(CLI::Range(1, kMaxCoarsening))
      ->capture_default_str();
  command.add_flag("--cover", options.covers,
                   "Make a hexahedron wherever any voxel has a label, so that all of them lie within the mesh");
  command.add_flag("--largest-part", options.largest_part,
                   "Leave out hexahedra that are not connected by faces to the largest part");
  command.add_flag("--ascii", options.ascii, "Write numbers as text, as SOFA's MeshVTKLoader reads them");
  command.add_flag("--surfaces", options.surfaces,
                   "Write a smooth surface around the hexahedra of each label, too: FILE_LABEL.obj");
  CLI::Option* scene =
      add_option(command, "--scene", options.scene, "FILE.scn",
                 "Write a scene of this mesh, too: a material for each label, supports, a ball that presses in, "
                 "probes, and a smooth surface, FILE_surface.obj");
  add_option(command, "--hold", options.hold, "SIDE|'X Y Z X Y Z'",
             "What that scene holds: the nodes of a side (left, right, back, front, head or foot), or of a box [m]")
      ->check(CLI::Validator([](const std::string& word) { return is_hold(word) ? "" : "must be a side or a box"; }, "",
                             "hold"))
      ->capture_default_str()
      ->needs(scene);
  command.add_flag("--force", options.force, "Replace an older scene")->needs(scene);
  add_choice(command, "--unit", options.unit, {"m", "cm", "mm"}, "Unit of the coordinates that are written");
}

}  // namespace hexaplast::runner
