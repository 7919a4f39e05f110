// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/output_options.hpp"

#include <CLI/CLI.hpp>

namespace hexaplast::runner {

void add_allow_outside(CLI::App& command, scene::OutputRules& rules) {
  command.add_flag("--allow-outside", rules.allows_outside,
                   "Let the scene's components write outside of the run's directory: absolute names, .., links");
}

void add_output_rules(CLI::App& command, scene::OutputRules& rules) {
  add_allow_outside(command, rules);
  command.add_flag("--force", rules.replaces, "Replace files of an earlier run");
}

}  // namespace hexaplast::runner
