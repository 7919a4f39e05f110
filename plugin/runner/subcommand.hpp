// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "runner/command.hpp"

namespace hexaplast::runner {

/// Defines a subcommand, which does `act(options)` when the command line names it. subject_of(options): what messages
/// of errors are about. Returns the subcommand and its options, which live as long as it does.
template <class Options, class Result, class Subject>
std::pair<CLI::App&, Options&> add_subcommand(CLI::App& app, Call& call, const char* name, const char* help,
                                              Result (*act)(const Options&), const Subject& subject_of) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(name, help);
  command->footer(
      "Exit codes: 0 ok, 2 usage, 3 scene or mesh rejected, 4 numerical failure, 5 input/output, 6 plugin, 130/143 "
      "interrupted.");
  command->callback([options, act, subject_of, &call] {
    call.exit_code = report_errors(subject_of(*options), [&] { return act(*options); });
  });
  return {*command, *options};
}

/// An option and what follows it: "FILE", "LO:HI".
template <class T>
CLI::Option* add_option(CLI::App& command, const std::string& names, T& value, const std::string& type,
                        const std::string& help) {
  return command.add_option(names, value, help)->type_name(type);
}
/// One of some words; there is one by default.
CLI::Option* add_choice(CLI::App& command, const std::string& names, std::string& value,
                        const std::vector<std::string>& words, const std::string& help);

/// No argument makes sense without a letter, and the name of a file least of all.
void refuse_empty_values(CLI::App& command);

/// What is wrong with the command line, with the option or subcommand that was probably meant.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace hexaplast::runner
