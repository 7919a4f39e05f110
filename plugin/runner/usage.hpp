// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace hexaplast::runner {

/// No argument makes sense without a letter, and the name of a file least of all.
void refuse_empty_values(CLI::App& command);

/// What is wrong with the command line, with the option or subcommand that was probably meant.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace hexaplast::runner
