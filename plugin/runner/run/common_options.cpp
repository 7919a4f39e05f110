// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/common_options.hpp"

#include <CLI/CLI.hpp>

#include "hexaplast/base/parallel.hpp"

namespace hexaplast::runner {

void add_threads(CLI::App& command, std::optional<int>& threads, const char* help) {
  command.add_option("--threads", threads, help)->type_name("N")->check(CLI::Range(1, kMaxThreads));
}

CLI::Option* add_steps(CLI::App& command, std::optional<long>& steps, const char* help) {
  return command.add_option("--steps", steps, help)->type_name("N")->check(CLI::Range(0L, 1'000'000'000L));
}

void add_final_state(CLI::App& command, std::optional<std::filesystem::path>& file) {
  command.add_option("--final", file, "Write the last state as JSON")->type_name("FILE");
}

void add_strict(CLI::App& command, bool& strict) {
  command.add_flag("--strict", strict,
                   "A run ends with 4 if hexahedra are inverted, or if the error of the energy balance, or the energy "
                   "added by the integrator, exceeds a fifth of the supplied energy");
}

}  // namespace hexaplast::runner
