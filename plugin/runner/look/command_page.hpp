// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

/// What shells and manuals say of the command, made from the tree that its arguments are parsed by.
namespace hexaplast::runner {

/// Manual page hexaplast(1) in man's macros: every subcommand with all its options.
std::string man_page(const CLI::App& app, const std::string& version);

/// Completion for bash: subcommands, options, and their values where they are a choice of words, a file, or one of the
/// components.
std::string bash_completion(const CLI::App& app, const std::vector<std::string>& components);

/// Adds the hidden subcommand `page man|bash`, which prints one of them.
void add_page(CLI::App& app, std::string& format);

}  // namespace hexaplast::runner
