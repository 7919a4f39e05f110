// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// A program in Python that belongs to the command (hexaplast-sweep, hexaplast-fit, hexaplast-data): the first of that
/// name beside the command, or on PATH. Throws OutputError where there is none, with the packages that it needs.
std::filesystem::path find_program(const std::string& name);

/// Replaces this process by the program: with its exit code, signals and streams. It finds this command by the
/// environment variable HEXAPLAST_COMMAND. Throws OutputError where it cannot be started.
[[noreturn]] void become_program(const std::string& name, const std::vector<std::string>& arguments);

/// Starts the program with `descriptor` as its standard input and output. Its other files are closed, but for `kept`.
/// Returns the number of the process. Throws OutputError.
int start_program(const std::string& name, const std::vector<std::string>& arguments, int descriptor, int kept);

}  // namespace hexaplast::runner
