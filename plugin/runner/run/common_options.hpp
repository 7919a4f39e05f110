// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <vector>

#include "record/field_file.hpp"

namespace hexaplast::runner {

// Options that several commands share.

void add_threads(CLI::App& command, std::optional<int>& threads,
                 const char* help = "Number of threads; results do not depend on it");

CLI::Option* add_steps(CLI::App& command, std::optional<long>& steps,
                       const char* help = "Number of time steps; default: that of the scene's RunSettings");

/// --final
void add_final_state(CLI::App& command, std::optional<std::filesystem::path>& file);

/// --fields and --every: what data sets hold.
CLI::Option* add_fields(CLI::App& command, std::vector<output::Field>& fields);
CLI::Option* add_every(CLI::App& command, long& every);

void add_strict(CLI::App& command, bool& strict);

}  // namespace hexaplast::runner
