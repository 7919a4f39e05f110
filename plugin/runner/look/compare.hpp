// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

namespace hexaplast::runner {

/// `hexaplast compare`, as the command line gives it.
struct CompareOptions {
  std::filesystem::path a, b;                ///< directories of runs
  std::optional<std::filesystem::path> out;  ///< page to write
};

CLI::App* add_compare(CLI::App& app, CompareOptions& options);

/// Prints where two runs are farthest apart, and writes the page. Throws OutputError and InputError; then no page is
/// written.
void compare(const CompareOptions& options);

}  // namespace hexaplast::runner
