// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>

#include "scene/output_files.hpp"

namespace hexaplast::runner {

/// Defines --allow-outside, for commands in which a scene's components write files.
void add_allow_outside(CLI::App& command, scene::OutputRules& rules);

/// The same, and --force.
void add_output_rules(CLI::App& command, scene::OutputRules& rules);

}  // namespace hexaplast::runner
