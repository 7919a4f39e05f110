// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <utility>

#include "runner/command.hpp"
#include "runner/log.hpp"
#include "runner/process.hpp"
#include "runner/subcommand.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::runner;

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
  Call call{.words = {"hexaplast"}};
  call.words.insert(call.words.end(), argv + 1, argv + argc);
  for (const auto add : {add_run, add_view, add_element, add_mesh, add_check, add_compare, add_list, add_bench,
                         add_resume, add_render, add_describe})
    add(app, call);
  // programs in Python, which have been started where they are asked for
  app.add_subcommand("sweep", "Run a scene for every combination of attribute values; continues what was begun");
  app.add_subcommand("fit", "Find the attribute values with which a scene repeats a measured curve");
  refuse_empty_values(app);
  if (argc == 1) return report_errors("hexaplast", [&] { return app.exit(CLI::CallForHelp()); });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return report(kUsage, usage_message(app, error));
    return report_errors("hexaplast", [&] { return app.exit(error); });  // --help, --version
  }

  return call.exit_code;
}
