// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/voxels.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>

#include "formats/text.hpp"
#include "formats/vtu_grid.hpp"
#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/formats/volume_import.hpp"
#include "hexaplast/formats/whole_file.hpp"
#include "runner/mesh/command.hpp"
#include "runner/mesh/file.hpp"
#include "runner/standard_output.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

struct MeshVoxelsOptions {
  std::filesystem::path segmentation;
  std::vector<int> labels;  ///< empty: all but 0
  int coarsening = 1;
  bool largest_part = false;
  std::string unit = "m";  ///< of the written lengths: m, cm or mm
  bool ascii = false;      ///< numbers as text
  bool surfaces = false;   ///< besides, FILE_LABEL.obj for each label
  std::filesystem::path out;
};

constexpr double kCubicMillimetresPerMillilitre = 1000;

double mm_per(const std::string& unit) {
  if (unit == "mm") return 1;
  return unit == "cm" ? 10 : 1000;
}

void write_vtu(const std::filesystem::path& file, const VoxelMesh& made, bool ascii) {
  const HexMesh& mesh = made.mesh;
  VtuGrid grid{.points = coordinates_of(mesh.positions()), .connectivity = std::as_bytes(std::span(mesh.hexahedra()))};
  grid.add_cells(mesh.hexahedra().size(), kVtkHexahedron, kCorners);
  const std::vector<std::int32_t> labels(made.labels.begin(), made.labels.end());
  grid.cell_data.push_back(scalars("Int32", "label", labels));
  grid.shown_first = "label";
  if (!ascii) return grid.write(file);
  WholeFile out(file);
  out.write(grid.text());
  out.commit();
}

/// "body.vtu" and 2 make "body_2.obj".
std::filesystem::path surface_place(std::filesystem::path out, int label) {
  const std::string stem = out.stem().string();
  return out.replace_filename(fmt::format("{}_{}.obj", stem, label));
}

void write_surfaces(const MeshVoxelsOptions& options, const ImportedVolume& found, const VoxelCells& cells,
                    const VoxelMesh& made) {
  const Mat3 cell = cells.coarsening / cells.mm_per_length * found.volume.axes();
  for (const int label : std::set<int>(made.labels.begin(), made.labels.end())) {
    const VoxelSurface surface = surface_of_label(made, label, cell);
    WholeFile file(output_place(surface_place(options.out, label), InputFiles(found.files)));
    file.write(obj_text({.points = coordinates_of(surface.positions), .quads = surface.quads}));
    file.commit();
  }
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
  const VoxelCells cells{.labels = options.labels,
                         .coarsening = options.coarsening,
                         .largest_part = options.largest_part,
                         .mm_per_length = mm_per(options.unit)};
  const ImportedVolume found =
      load_file(options.segmentation, [&] { return read_volume(options.segmentation, cells); });
  const VoxelMesh made = mesh_of_voxels(found.volume, cells);
  write_vtu(output_place(options.out, InputFiles(found.files)), made, options.ascii);
  if (options.surfaces) write_surfaces(options, found, cells, made);
  print_summary(options, found.volume, made);
  if (!found.has_frame)
    spdlog::warn("{}: warning: the file does not say where left, back and head are: its axes are taken for x, y and z",
                 options.segmentation.string());
  warn_of_lost_labels(options, found.volume, made);
  if (made.num_hinges > 0)
    spdlog::warn("warning: hexahedra meet at {} nodes without sharing a face there: they fold freely about them",
                 made.num_hinges);
}

}  // namespace

void add_mesh_voxels(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "voxels", "Make hexahedra of the labelled voxels of a segmented image", make_voxels,
                     [](const MeshVoxelsOptions& given) { return given.segmentation.string(); });
  command
      .add_option("segmentation", options.segmentation, "Volume of labels: .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd")
      ->type_name("SEGMENTATION")
      ->required();
  add_out(command, options.out);
  command.add_option("--labels", options.labels, "Labels that become hexahedra. Default: all but 0, the background")
      ->type_name("L,L,...")
      ->delimiter(',');
  command
      .add_option(
          "--coarsen", options.coarsening,
          "One hexahedron for N x N x N voxels, if at least half of them have a label; it has the most frequent "
          "one")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxCoarsening))
      ->capture_default_str();
  command.add_flag("--largest-part", options.largest_part,
                   "Leave out hexahedra that are not connected by faces to the largest part");
  command.add_flag("--ascii", options.ascii, "Write numbers as text, as SOFA's MeshVTKLoader reads them");
  command.add_flag("--surfaces", options.surfaces,
                   "Write a smooth surface around the hexahedra of each label, too: FILE_LABEL.obj");
  command.add_option("--unit", options.unit, "Unit of the coordinates that are written")
      ->type_name("m|cm|mm")
      ->check(CLI::IsMember({"m", "cm", "mm"}))
      ->capture_default_str();
}

}  // namespace hexaplast::runner
