// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <new>
#include <type_traits>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/geometry/voxels.hpp"
#include "record/recorder.hpp"
#include "runner/exit_code.hpp"
#include "runner/look/command_page.hpp"
#include "runner/look/compare.hpp"
#include "runner/look/list.hpp"
#include "runner/look/render.hpp"
#include "runner/look/view.hpp"
#include "runner/mesh/cage.hpp"
#include "runner/mesh/export.hpp"
#include "runner/mesh/info.hpp"
#include "runner/mesh/make.hpp"
#include "runner/mesh/voxels.hpp"
#include "runner/run/bench.hpp"
#include "runner/run/check.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/output_options.hpp"
#include "runner/run/resume.hpp"
#include "runner/run/run.hpp"
#include "runner/standard_output.hpp"
#include "runner/study/element.hpp"
#include "runner/study/fit.hpp"
#include "runner/study/sweep.hpp"
#include "runner/terminal_log.hpp"
#include "scene/reader.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::runner;

constexpr const char* kExitCodes =
    "Exit codes: 0 ok, 2 usage, 3 scene or mesh rejected, 4 numerical failure, 5 input/output, 6 plugin, 130/143 "
    "interrupted.";

void add_plugin_options(CLI::App& command, std::vector<std::string>& plugins,
                        std::vector<std::filesystem::path>& plugin_path) {
  command.add_option("--plugin", plugins, "Plugin to load, by name; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command.add_option("--plugin-path", plugin_path, "Directory to look for plugins in; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

void add_mesh_path(CLI::App& command, SceneOptions& options) {
  command
      .add_option("--mesh-path", options.mesh_path,
                  "Directory to look for the scene's meshes and includes in; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

/// What the subcommands of `mesh` take.
struct MeshOptions {
  MeshExportOptions scene_export;
  MeshCageOptions cage;
  MeshOffsetOptions offset;
  MeshGridOptions grid;
  MeshSheetOptions sheet;
  MeshTubeOptions tube;
  MeshSpherePatchOptions sphere_patch;
  MeshVoxelsOptions voxels;
  MeshInfoOptions info;
  MeshConvertOptions convert;
};

/// What every command that reads a scene takes.
void add_scene(CLI::App& command, SceneOptions& options) {
  command.footer(kExitCodes);
  command.add_option("scene", options.file, "Scene file")->type_name("SCENE")->required();
  command.add_option("--set", options.overrides, "Replace an attribute of the scene; may be repeated")
      ->type_name("PATH.attribute=VALUE")
      ->allow_extra_args(false);
  command.add_flag(
      "--sofa-compat", options.sofa_compat,
      "Pass over unknown components, attributes, templates and plugins with a warning, as SOFA does, but for "
      "those that would change the motion");
  add_mesh_path(command, options);
  add_plugin_options(command, options.plugins, options.plugin_path);
}

long parse_every(const std::string& text) {
  constexpr std::string_view kEvery = "every=";
  long steps = 0;
  const char* end = text.data() + text.size();
  if (text.starts_with(kEvery)) {
    const auto [stop, error] = std::from_chars(text.data() + kEvery.size(), end, steps);
    if (error == std::errc() && stop == end && steps >= 1 && steps <= 1'000'000'000L) return steps;
  }
  throw CLI::ValidationError("--checkpoint", fmt::format("'{}' must be every=N with a number of steps from 1", text));
}

void add_run(CLI::App& app, RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "Run a scene headless");
  add_scene(*run, options.scene);
  add_steps(*run, options.steps);
  CLI::Option* out =
      run->add_option(
             "--out", options.out,
             "Write history.csv, mesh.pvd, frames, plot.svg, manifest.json and report.html into this directory")
          ->type_name("DIR");
  add_final_state(*run, options.final_state);
  run->add_option("--summary", options.summary, "Write the results of the run as JSON")->type_name("FILE");
  CLI::Option* data =
      run->add_option("--data", options.data, "Write states for other programs into an HDF5 file (docs/studies.md)")
          ->type_name("FILE.h5");
  data->needs(add_fields(*run, options.fields));
  add_every(*run, options.every)->needs(data);
  add_threads(*run, options.threads);
  run->add_option("--frames", options.frames, "Number of pictures, spread over the run; 0 for none")
      ->type_name("N")
      ->check(CLI::Range(0, 100'000))
      ->needs(out);
  run->add_option_function<std::string>(
         "--checkpoint", [&options](const std::string& text) { options.checkpoint_every = parse_every(text); },
         "Write a checkpoint every N steps, at the end and when a signal ends the run: hexaplast resume continues from "
         "it")
      ->type_name("every=N")
      ->needs(out);
  add_field(*run, options.field)->needs(out);
  run->add_option("--video", options.video, "Film of the run in real time: .mp4 by ffmpeg, or .png, animated")
      ->type_name("FILE")
      ->needs(out)
      ->check(refuse_film_name);
  add_write_below(*run, options.write_below);
  add_output_rules(*run, options.scene.output);
  run->add_flag("--quiet", options.quiet, "Print nothing but errors");
  add_strict(*run, options.strict);
}

void add_element(CLI::App& app, ElementOptions& options) {
  CLI::App* element = app.add_subcommand("element", "Print all intermediate results of one hexahedron as JSON");
  element->footer(kExitCodes);
  element
      ->add_option("file", options.file, "JSON that describes the hexahedron (docs/element.md); - for standard input")
      ->type_name("FILE.json|-");
  element
      ->add_option("--path", options.path,
                   "CSV rows time,F11,F12,...,F33: deform the hexahedron along them and print its response as CSV")
      ->type_name("FILE.csv");
}

void add_mesh_export(CLI::App& mesh, MeshExportOptions& options) {
  CLI::App* command = mesh.add_subcommand("export", "Write the scene's body for other programs");
  add_scene(*command, options.scene);
  command
      ->add_option(
          "--format", options.format,
          "inp: static analysis for Abaqus and CalculiX, with constraints, elasticity and loads; vtu: mesh for "
          "ParaView")
      ->type_name("inp|vtu")
      ->check(CLI::IsMember({"inp", "vtu"}))
      ->required();
  command->add_option("-o,--out", options.out, "File to write; replaces an older one")->type_name("FILE")->required();
  command
      ->add_option("--time", options.time,
                   "Loads at this time [s]; default: at the first step of the run at which they are largest")
      ->type_name("T")
      ->check(CLI::NonNegativeNumber);
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
  command->add_option("-o,--out", options.out, "File to write, .vtu; replaces an older one")
      ->type_name("FILE")
      ->required();
  command->add_flag("--allow-parts", options.allow_parts, "Accept a cage with unconnected parts");
}

constexpr const char* kMeshFormats = "File to write, .vtu, .msh or .inp; replaces an older one";
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
  command->add_option("-o,--out", out, kMeshFormats)->type_name("FILE")->required();
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
  command->add_option("surface", options.surface, "Mesh file: .obj, .vtk, .vtu, .msh or .inp, with quads alone")
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
  command->add_option("-o,--out", options.out, kMeshFormats)->type_name("FILE")->required();
}

void add_mesh_voxels(CLI::App& mesh, MeshVoxelsOptions& options) {
  CLI::App* command = mesh.add_subcommand("voxels", "Make hexahedra of the labelled voxels of a segmented image");
  command->footer(kExitCodes);
  command
      ->add_option("segmentation", options.segmentation, "Volume of labels: .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd")
      ->type_name("SEGMENTATION")
      ->required();
  command->add_option("-o,--out", options.out, "File to write, .vtu; replaces an older one")
      ->type_name("FILE")
      ->required();
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
  command->add_option("file", options.file, "Mesh file: .vtu, .vtk, .msh, .obj, .stl or .inp")
      ->type_name("FILE")
      ->required();
  command->add_flag("--json", options.json, "As JSON");
}

void add_mesh_convert(CLI::App& mesh, MeshConvertOptions& options) {
  CLI::App* command = mesh.add_subcommand("convert", "Write the cells of a mesh file in another format");
  command->footer(kExitCodes);
  command->add_option("file", options.file, "Mesh file: .vtu, .vtk, .msh, .obj, .stl or .inp")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--out", options.out, kMeshFormats)->type_name("FILE")->required();
}

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

void add_view(CLI::App& app, ViewOptions& options) {
  CLI::App* command = app.add_subcommand(
      "view", "Run a scene in a window, and pull and push at it with the mouse; or look at a finished run");
  add_scene(*command, options.scene);
  add_view_options(*command, options);
}

void add_check(CLI::App& app, CheckOptions& options) {
  CLI::App* check = app.add_subcommand("check", "Read a scene as run does and print a model check, without a step");
  add_scene(*check, options.scene);
  check->add_option("--out", options.out, "Directory that the run would have")->type_name("DIR");
  add_write_below(*check, options.write_below);
  add_output_rules(*check, options.scene.output, "As the run with --force, which replaces files that are there");
  check->add_flag("--json", options.json, "As JSON");
}

void add_list(CLI::App& app, ListOptions& options) {
  CLI::App* list = app.add_subcommand("list", "Print the components that scenes may name, and what they take");
  list->footer(kExitCodes);
  CLI::Option* component =
      list->add_option("component", options.component, "One component with its attributes")->type_name("COMPONENT");
  CLI::Option* json = list->add_flag("--json", options.json, "As JSON");
  list->add_flag("--markdown", options.markdown, "As the page docs/components.md")->excludes(component)->excludes(json);
  add_plugin_options(*list, options.plugins, options.plugin_path);
}

void add_bench(CLI::App& app, BenchOptions& options) {
  CLI::App* bench =
      app.add_subcommand("bench",
                         "Measure implicit steps of a soft bar, of many small ones, or of a scene, and of a "
                         "dense reference implementation; check that results do not depend on threads");
  bench->footer(kExitCodes);
  bench->add_option("--json", options.json, "Write the records as JSON; - for standard output, without the table")
      ->type_name("FILE|-");
  CLI::Option* sizes =
      bench
          ->add_option("--sizes", options.sizes,
                       "Hexahedra of the bars; k for a thousand. Default 1k,10k,100k; with --batch 90,250,1k")
          ->type_name("N,N,...")
          ->delimiter(',');
  bench->add_option("--threads", options.threads, "Numbers of threads, which must agree bit for bit. Default 1,2")
      ->type_name("N,N,...")
      ->delimiter(',')
      ->check(CLI::Range(1, kMaxThreads));
  CLI::Option* quick = bench->add_flag("--quick", options.quick, "One iteration count, one solver, few repetitions");
  bench->add_option("--simd", options.simd, "Instruction set of the kernels; otherwise the machine's best")
      ->type_name("TARGET");
  CLI::Option* baseline =
      bench->add_option("--baseline", options.baseline, "Fail where records fall behind those of an earlier --json")
          ->type_name("FILE");
  bench
      ->add_option("--ratio", options.ratio,
                   "Fraction of the baseline's speed relative to the dense reference that is required. Default 0.5")
      ->type_name("R")
      ->check(CLI::Range(0.0, 10.0))
      ->needs(baseline);
  CLI::Option* scene = bench->add_option("--scene", options.scene.file, "Measure a scene instead of the bars")
                           ->type_name("SCENE")
                           ->excludes(sizes)
                           ->excludes(quick);
  CLI::Option* batch = bench
                           ->add_flag("--batch", options.is_batch,
                                      "Measure many small bars in one process: one after the other, and stepped at "
                                      "once; check that each has the bits that it has alone")
                           ->excludes(scene)
                           ->excludes(baseline);
  bench->add_option("--bodies", options.bodies, "How many. Default 64")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000))
      ->needs(batch);
  add_mesh_path(*bench, options.scene);
  add_plugin_options(*bench, options.scene.plugins, options.scene.plugin_path);
}

int report(ExitCode code, const std::string& message) {
  spdlog::error("{}", message);
  return code;
}

/// The innermost subcommand that was recognised, or the command itself.
const CLI::App& innermost(const CLI::App& app) {
  const std::vector<CLI::App*> inner = app.get_subcommands();
  return inner.empty() ? app : innermost(*inner.front());
}

/// "hexaplast mesh grid"
std::string path_of(const CLI::App& command) {
  return command.get_parent() ? path_of(*command.get_parent()) + " " + command.get_name() : command.get_name();
}

/// No argument makes sense without a letter, and the name of a file least of all.
void refuse_empty_values(CLI::App& command) {
  for (CLI::Option* option : command.get_options())
    if (option->get_items_expected_max() > 0)
      option->check([](const std::string& word) { return std::string(word.empty() ? "must not be empty" : ""); });
  for (CLI::App* inner : command.get_subcommands({})) refuse_empty_values(*inner);
}

/// What is wrong with the command line, with the option or subcommand that was probably meant.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  std::vector<std::string> unknown = app.remaining(true);
  // an option that is not known leaves its value behind, and that is no mistake of its own
  std::stable_partition(unknown.begin(), unknown.end(), [](const std::string& word) { return word.starts_with('-'); });

  // a wrong value may be the name of the next option, whose own value is then left over
  const bool is_value_wrong = dynamic_cast<const CLI::ConversionError*>(&error) != nullptr ||
                              dynamic_cast<const CLI::ValidationError*>(&error) != nullptr;
  std::vector<std::string> known;
  std::string text = error.what(), hint;
  if (!unknown.empty() && unknown.front().starts_with('-')) {
    const std::string option = unknown.front().substr(0, unknown.front().find('='));
    for (const CLI::Option* other : command.get_options())
      for (const std::string& name : other->get_lnames()) known.push_back("--" + name);
    text = fmt::format("unknown option '{}'", option);
    hint = scene::did_you_mean(option, {known.begin(), known.end()});
  } else if (!unknown.empty() && !is_value_wrong) {
    for (const CLI::App* other : command.get_subcommands({})) known.push_back(other->get_name());
    text = fmt::format("{} '{}'", known.empty() ? "unexpected argument" : "unknown subcommand", unknown.front());
    hint = scene::did_you_mean(unknown.front(), {known.begin(), known.end()});
  }
  return scene::format_error({path_of(command), 0}, text, hint) + "\nRun with --help for more information.";
}

/// A closed standard stream would give its number to the next file, which messages then corrupt. What is printed into
/// a closed output is lost, and that is to be noticed: nothing can be written there.
void open_standard_streams() {
  for (const auto& [stream, access] :
       {std::pair(STDIN_FILENO, O_RDONLY), {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}})
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", access) != stream) std::_Exit(kInputOutput);
}

/// Carries out a subcommand, which may return an exit code, and turns what it throws into a message about `subject` and
/// an exit code.
template <class Action>
int report_errors(const std::string& subject, const Action& action) {
  try {
    int code = kOk;
    if constexpr (std::is_void_v<decltype(action())>)
      action();
    else
      code = action();
    flush_standard_output();
    return code;
  } catch (const UsageError& error) {
    return report(kUsage, scene::format_error({"hexaplast", 0}, error.what(), error.hint()));
  } catch (const scene::OverrideError& error) {
    return report(kUsage, error.what());
  } catch (const scene::SceneError& error) {
    return report(kScene, error.what());
  } catch (const InputError& error) {
    return report(kScene, scene::format_error({subject, 0}, error.what()));
  } catch (const std::bad_alloc&) {
    return report(kScene, scene::format_error({subject, 0}, "it does not fit into memory"));
  } catch (const NumericalError& error) {
    return report(kNumerical, scene::format_error({subject, 0}, error.what()));
  } catch (const scene::FileError& error) {
    return report(kInputOutput, error.what());
  } catch (const output::OutputError& error) {
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  } catch (const std::filesystem::filesystem_error& error) {
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  } catch (const scene::PluginError& error) {
    return report(kPlugin, error.what());
  } catch (const std::exception& error) {  // what the system refuses: threads, locales, files
    return report(kInputOutput, scene::format_error({"hexaplast", 0}, error.what()));
  }
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

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();

  // Messages are sentences with their own place and severity; the log adds nothing to them.
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("hexaplast", make_terminal_log()));

  CLI::App app("Hexaplast: hexahedral corotational elastoplastic finite elements in real time", "hexaplast");
  app.set_version_flag("--version", "hexaplast " HEXAPLAST_VERSION);
  app.require_subcommand(1);
  RunOptions run_options;
  add_run(app, run_options);
  ViewOptions view_options;
  add_view(app, view_options);
  ElementOptions element_options;
  add_element(app, element_options);
  MeshOptions mesh_options;
  add_mesh(app, mesh_options);
  CheckOptions check_options;
  add_check(app, check_options);
  CompareOptions compare_options;
  add_compare(app, compare_options)->footer(kExitCodes);
  ListOptions list_options;
  add_list(app, list_options);
  BenchOptions bench_options;
  add_bench(app, bench_options);
  ResumeOptions resume_options;
  add_resume(app, resume_options)->footer(kExitCodes);
  RenderOptions render_options;
  add_render(app, render_options)->footer(kExitCodes);
  std::string page_format;
  add_page(app, page_format);
  SweepOptions sweep_options;
  CLI::App* sweep_command = add_sweep(app, sweep_options);
  add_scene(*sweep_command, sweep_options.scene);
  sweep_command->get_option("scene")->required(false);  // --merge takes none
  FitOptions fit_options;
  add_scene(*add_fit(app, fit_options), fit_options.scene);
  refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return report(kUsage, usage_message(app, error));
    return report_errors("hexaplast", [&] { return app.exit(error); });  // --help, --version
  }

  if (app.got_subcommand("view"))
    return report_errors(view_options.scene.file.string(), [&] { return view(view_options); });
  if (app.got_subcommand("page"))
    return report_errors("hexaplast", [&] {
      fmt::print("{}",
                 page_format == "man" ? man_page(app, HEXAPLAST_VERSION) : bash_completion(app, component_names()));
    });
  if (app.got_subcommand("element")) return report_errors(element_options.file, [&] { run_element(element_options); });
  if (app.got_subcommand("mesh")) return run_mesh(*app.get_subcommand("mesh"), mesh_options);
  if (app.got_subcommand("check"))
    return report_errors(check_options.scene.file.string(), [&] { check(check_options); });
  if (app.got_subcommand("compare")) return report_errors("hexaplast compare", [&] { compare(compare_options); });
  if (app.got_subcommand("bench")) {
    const bool has_scene = !bench_options.scene.file.empty();
    return report_errors(has_scene ? bench_options.scene.file.string() : "hexaplast", [&] { bench(bench_options); });
  }
  if (app.got_subcommand("list")) return report_errors("hexaplast", [&] { list(list_options); });
  if (app.got_subcommand("render")) return report_errors(render_options.run.string(), [&] { render(render_options); });
  if (app.got_subcommand("sweep"))
    return report_errors(sweep_options.merge.empty() ? sweep_options.scene.file.string() : "hexaplast sweep",
                         [&] { return sweep(sweep_options); });
  if (app.got_subcommand("fit"))
    return report_errors(fit_options.scene.file.string(), [&] { return fit(fit_options); });
  // the stream alone: warnings are kept for the manifest of the run
  if (run_options.quiet || resume_options.quiet)
    spdlog::default_logger()->sinks().front()->set_level(spdlog::level::err);
  std::vector<std::string> words = {"hexaplast"};
  words.insert(words.end(), argv + 1, argv + argc);
  run_options.command = resume_options.command = words;
  if (app.got_subcommand("resume"))
    return report_errors(resume_options.run.string(), [&] { return resume(resume_options); });
  return report_errors(run_options.scene.file.string(), [&] { return run(run_options); });
}
