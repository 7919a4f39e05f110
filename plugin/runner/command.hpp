// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hexaplast::runner {

/// A call of the command.
struct Call {
  std::vector<std::string> words;  ///< of the command line
  int exit_code = 0;               ///< of the subcommand
};

// Each defines a subcommand, which is carried out when the command line names it.
void add_run(CLI::App& app, Call& call);
void add_view(CLI::App& app, Call& call);
void add_element(CLI::App& app, Call& call);
void add_mesh(CLI::App& app, Call& call);
void add_check(CLI::App& app, Call& call);
void add_compare(CLI::App& app, Call& call);
void add_list(CLI::App& app, Call& call);
void add_bench(CLI::App& app, Call& call);
void add_resume(CLI::App& app, Call& call);
void add_render(CLI::App& app, Call& call);
void add_page(CLI::App& app, Call& call);      ///< hidden: the manual page, and completion for bash
void add_describe(CLI::App& app, Call& call);  ///< hidden: what hexaplast-sweep and hexaplast-fit ask of a scene

}  // namespace hexaplast::runner
