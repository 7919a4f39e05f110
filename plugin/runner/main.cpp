// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdlib>
#include <utility>

#include "hexaplast/base/parallel.hpp"
#include "runner/exit_code.hpp"
#include "runner/look/command_page.hpp"
#include "runner/look/compare.hpp"
#include "runner/look/list.hpp"
#include "runner/look/render.hpp"
#include "runner/look/view.hpp"
#include "runner/mesh/command.hpp"
#include "runner/program.hpp"
#include "runner/report_errors.hpp"
#include "runner/run/bench.hpp"
#include "runner/run/check.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/resume.hpp"
#include "runner/run/run.hpp"
#include "runner/study/describe.hpp"
#include "runner/study/element.hpp"
#include "runner/terminal_log.hpp"
#include "runner/usage.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::runner;

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
  CLI::Option* fields = add_fields(*run, options.fields);
  data->needs(fields);
  add_every(*run, options.every)->needs(fields);
  // for programs in Python
  run->add_option("--stream", options.stream)->group("");
  run->add_option("--measure", options.measures)->delimiter(',')->group("");
  run->add_option("--parent", options.parent)->group("");
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
  run->add_flag("--force", options.force, "Replace files of an earlier run");
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

void add_view(CLI::App& app, ViewOptions& options) {
  CLI::App* command = app.add_subcommand(
      "view", "Run a scene in a window, and pull and push at it with the mouse; or look at a finished run");
  add_scene(*command, options.scene);
  add_view_options(*command, options);
}

void add_check(CLI::App& app, CheckOptions& options) {
  CLI::App* check = app.add_subcommand("check", "Read a scene as run does and print a model check, without a step");
  add_scene(*check, options.scene);
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
  CLI::Option* flow = bench
                          ->add_flag("--flow", options.flow,
                                     "Measure what flow costs, step by step in turn: elastic bars, those of which a "
                                     "twentieth and all flows, and those that relax")
                          ->excludes(scene);
  CLI::Option* batch = bench
                           ->add_flag("--batch", options.is_batch,
                                      "Measure many small bars in one process: one after the other, and stepped at "
                                      "once; check that each has the bits that it has alone")
                           ->excludes(scene)
                           ->excludes(flow)
                           ->excludes(baseline);
  bench->add_option("--bodies", options.bodies, "How many. Default 64")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000))
      ->needs(batch);
  add_mesh_path(*bench, options.scene);
  add_plugin_options(*bench, options.scene.plugins, options.scene.plugin_path);
}

/// A closed standard stream would give its number to the next file, which messages then corrupt. What is printed into
/// a closed output is lost, and that is to be noticed: nothing can be written there.
void open_standard_streams() {
  for (const auto& [stream, access] :
       {std::pair(STDIN_FILENO, O_RDONLY), {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}})
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", access) != stream) std::_Exit(kInputOutput);
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();

  // Messages are sentences with their own place and severity; the log adds nothing to them.
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("hexaplast", make_terminal_log()));

  if (const std::string verb = argc > 1 ? argv[1] : ""; verb == "sweep" || verb == "fit")
    return report_errors("hexaplast", [&]() -> int { become_program("hexaplast-" + verb, {argv + 2, argv + argc}); });

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
  SceneOptions describe_options;
  add_describe(app, describe_options);
  // programs in Python, which have been started where they are asked for
  app.add_subcommand("sweep", "Run a scene for every combination of attribute values; continues what was begun");
  app.add_subcommand("fit", "Find the attribute values with which a scene repeats a measured curve");
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
  if (app.got_subcommand("describe"))
    return report_errors(describe_options.file.string(), [&] { describe(describe_options); });
  if (app.got_subcommand("list")) return report_errors("hexaplast", [&] { list(list_options); });
  if (app.got_subcommand("render")) return report_errors(render_options.run.string(), [&] { render(render_options); });
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
