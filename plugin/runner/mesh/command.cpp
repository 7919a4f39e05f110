// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "hexaplast/geometry/voxels.hpp"
#include "runner/report_errors.hpp"
#include "runner/run/common_options.hpp"

namespace hexaplast::runner {
namespace {

constexpr const char* kOut = "File to write, .vtu; replaces an older one";

void add_mesh_export(CLI::App& mesh, MeshExportOptions& options) {
  CLI::App* command = mesh.add_subcommand("export", "Write the scene's bodies for other programs");
  add_scene(*command, options.scene);
  command->add_option("-o,--out", options.out, kOut)->type_name("FILE")->required();
}

void add_mesh_cage(CLI::App& mesh, MeshCageOptions& options) {
  CLI::App* command = mesh.add_subcommand("cage", "Lay coarse hexahedra around a surface of triangles or quads");
  command->footer(kExitCodes);
  command->add_option("surface", options.surface, "Mesh file: .obj, .stl, .vtk, .vtu or .msh")
      ->type_name("SURFACE")
      ->required();
  command->add_option("--cells", options.cells, "Number of cubes along the longest side of the surface's box")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000))
      ->required();
  command->add_option("-o,--out", options.out, kOut)->type_name("FILE")->required();
  command->add_flag("--allow-parts", options.allow_parts, "Accept a cage with unconnected parts");
}

constexpr int kMaxAlong = 1'000'000;  // hexahedra along one direction

/// What every command that makes hexahedra along three directions takes.
CLI::App* add_shape(CLI::App& mesh, const char* name, const char* help, const char* directions,
                    std::array<int, 3>& cells, std::filesystem::path& out) {
  CLI::App* command = mesh.add_subcommand(name, help);
  command->footer(kExitCodes);
  command->add_option("--cells", cells, fmt::format("Number of hexahedra {}", directions))
      ->type_name("N N N")
      ->check(CLI::Range(1, kMaxAlong))
      ->required();
  command->add_option("-o,--out", out, kOut)->type_name("FILE")->required();
  return command;
}

/// A length that makes sense; CLI11's own check names the largest number there is.
std::string refuse_length(const std::string& word) {
  double length = 0;
  const bool is_length = CLI::detail::lexical_cast(word, length) && length > 0 && std::isfinite(length);
  return is_length ? "" : fmt::format("{}: must be a finite number greater than 0", word);
}

CLI::Option* add_length(CLI::App& command, const char* name, double& length, const char* help) {
  return command.add_option(name, length, help)->type_name("M")->check(refuse_length)->required();
}

void add_mesh_grid(CLI::App& mesh, MeshGridOptions& options) {
  CLI::App* command =
      add_shape(mesh, "grid", "Make a box of hexahedra", "along x, y and z", options.cells, options.out);
  command->add_option("--size", options.size, "Lengths along x, y and z [m]")
      ->type_name("M M M")
      ->check(refuse_length)
      ->required();
  command->add_option("--origin", options.origin, "Its lower corner [m]")->type_name("M M M")->capture_default_str();
}

void add_mesh_sheet(CLI::App& mesh, MeshSheetOptions& options) {
  CLI::App* command = add_shape(mesh, "sheet", "Make a sheet, flat or bent, about the origin",
                                "along x, along y and across", options.cells, options.out);
  command->add_option("--size", options.size, "Lengths along x and y, of the middle [m]")
      ->type_name("M M")
      ->check(refuse_length)
      ->required();
  add_length(*command, "--thickness", options.thickness, "Thickness [m]");
  command->add_option("--curvature", options.curvature, "One over the radius about y [1/m]; negative: ends upwards")
      ->type_name("K")
      ->capture_default_str();
}

void add_mesh_tube(CLI::App& mesh, MeshTubeOptions& options) {
  CLI::App* command = add_shape(mesh, "tube", "Make a tube along z, along an arc or along a curve",
                                "outward, around and along", options.cells, options.out);
  add_length(*command, "--inner", options.inner, "Inner radius [m]");
  add_length(*command, "--outer", options.outer, "Outer radius [m]");
  CLI::Option* length = command->add_option("--length", options.length, "Length of a tube from the origin along z [m]")
                            ->type_name("M")
                            ->check(refuse_length);
  command->add_option("--bend", options.bend, "Angle by which it is bent towards x on its way [deg]")
      ->type_name("DEG")
      ->check(CLI::Range(-359.0, 359.0))
      ->needs(length);
  command
      ->add_option("--along", options.along,
                   "Mesh file (.obj, ...) whose vertices, in their order, are points of a smooth centreline")
      ->type_name("FILE")
      ->excludes(length);
}

void add_mesh_sphere_patch(CLI::App& mesh, MeshSpherePatchOptions& options) {
  CLI::App* command = add_shape(mesh, "sphere-patch", "Make a square patch of a spherical shell about the origin",
                                "along x, along y and outward", options.cells, options.out);
  add_length(*command, "--inner", options.inner, "Inner radius [m]");
  add_length(*command, "--outer", options.outer, "Outer radius [m]");
  command->add_option("--angle", options.angle, "Angle from side to side, seen from the centre [deg]")
      ->type_name("DEG")
      ->check(CLI::Range(1e-3, 179.0))
      ->capture_default_str();
}

void add_mesh_offset(CLI::App& mesh, MeshOffsetOptions& options) {
  CLI::App* command = mesh.add_subcommand("offset", "Grow a shell of hexahedra from a surface of quads");
  command->footer(kExitCodes);
  command->add_option("surface", options.surface, "Mesh file: .obj, .vtk, .vtu or .msh, with quads alone")
      ->type_name("SURFACE")
      ->required();
  add_length(*command, "--thickness", options.thickness, "Thickness, measured normal to the quads [m]");
  command->add_option("--layers", options.layers, "Number of hexahedra across it")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxAlong))
      ->capture_default_str();
  command
      ->add_option("--direction", options.direction,
                   "outward: on the side from which the quads run counter-clockwise; both: half to either side")
      ->type_name("inward|outward|both")
      ->check(CLI::IsMember({"inward", "outward", "both"}))
      ->capture_default_str();
  command->add_option("-o,--out", options.out, kOut)->type_name("FILE")->required();
}

void add_mesh_voxels(CLI::App& mesh, MeshVoxelsOptions& options) {
  CLI::App* command = mesh.add_subcommand("voxels", "Make hexahedra of the labelled voxels of a segmented image");
  command->footer(kExitCodes);
  command
      ->add_option("segmentation", options.segmentation, "Volume of labels: .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd")
      ->type_name("SEGMENTATION")
      ->required();
  command->add_option("-o,--out", options.out, kOut)->type_name("FILE")->required();
  command->add_option("--labels", options.labels, "Labels that become hexahedra. Default: all but 0, the background")
      ->type_name("L,L,...")
      ->delimiter(',');
  command
      ->add_option(
          "--coarsen", options.coarsening,
          "One hexahedron for N x N x N voxels, if at least half of them have a label; it has the most frequent "
          "one")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxCoarsening))
      ->capture_default_str();
  command->add_flag("--largest-part", options.largest_part,
                    "Leave out hexahedra that are not connected by faces to the largest part");
  command->add_flag("--ascii", options.ascii, "Write numbers as text, as SOFA's MeshVTKLoader reads them");
  command->add_flag("--surfaces", options.surfaces,
                    "Write a smooth surface around the hexahedra of each label, too: FILE_LABEL.obj");
  command->add_option("--unit", options.unit, "Unit of the coordinates that are written")
      ->type_name("m|cm|mm")
      ->check(CLI::IsMember({"m", "cm", "mm"}))
      ->capture_default_str();
}

void add_mesh_info(CLI::App& mesh, MeshInfoOptions& options) {
  CLI::App* command = mesh.add_subcommand("info", "Print what a mesh file holds, its size, volume and shape");
  command->footer(kExitCodes);
  command->add_option("file", options.file, "Mesh file: .vtu, .vtk, .msh, .obj or .stl")->type_name("FILE")->required();
  command->add_flag("--json", options.json, "As JSON");
}

void add_mesh_convert(CLI::App& mesh, MeshConvertOptions& options) {
  CLI::App* command = mesh.add_subcommand("convert", "Write the cells of a mesh file as .vtu");
  command->footer(kExitCodes);
  command->add_option("file", options.file, "Mesh file: .vtu, .vtk, .msh, .obj or .stl")->type_name("FILE")->required();
  command->add_option("-o,--out", options.out, kOut)->type_name("FILE")->required();
}

}  // namespace

void add_mesh(CLI::App& app, MeshOptions& options) {
  CLI::App* mesh = app.add_subcommand("mesh", "Make meshes, and write those of scenes");
  mesh->require_subcommand(1);
  add_mesh_export(*mesh, options.scene_export);
  add_mesh_offset(*mesh, options.offset);
  add_mesh_cage(*mesh, options.cage);
  add_mesh_grid(*mesh, options.grid);
  add_mesh_sheet(*mesh, options.sheet);
  add_mesh_tube(*mesh, options.tube);
  add_mesh_sphere_patch(*mesh, options.sphere_patch);
  add_mesh_voxels(*mesh, options.voxels);
  add_mesh_info(*mesh, options.info);
  add_mesh_convert(*mesh, options.convert);
}

int run_mesh(const CLI::App& mesh, const MeshOptions& options) {
  const std::string command = mesh.get_subcommands().front()->get_name();
  const auto done = [&](const std::filesystem::path& subject, const auto& action, const auto& its_options) {
    return report_errors(subject.string(), [&] { action(its_options); });
  };
  if (command == "offset") return done(options.offset.surface, make_shell, options.offset);
  if (command == "cage") return done(options.cage.surface, make_cage, options.cage);
  if (command == "grid") return done("hexaplast mesh grid", make_grid, options.grid);
  if (command == "sheet") return done("hexaplast mesh sheet", make_sheet, options.sheet);
  if (command == "tube") return done("hexaplast mesh tube", make_tube, options.tube);
  if (command == "sphere-patch") return done("hexaplast mesh sphere-patch", make_sphere_patch, options.sphere_patch);
  if (command == "voxels") return done(options.voxels.segmentation, make_voxels, options.voxels);
  if (command == "info") return done(options.info.file, print_info, options.info);
  if (command == "convert") return done(options.convert.file, convert, options.convert);
  return done(options.scene_export.scene.file, export_mesh, options.scene_export);
}

}  // namespace hexaplast::runner
