// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/subcommand.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

/// The innermost subcommand that was recognised, or the command itself.
const CLI::App& innermost(const CLI::App& app) {
  const std::vector<CLI::App*> inner = app.get_subcommands();
  return inner.empty() ? app : innermost(*inner.front());
}

/// "hexaplast mesh grid"
std::string path_of(const CLI::App& command) {
  return command.get_parent() ? path_of(*command.get_parent()) + " " + command.get_name() : command.get_name();
}

}  // namespace

CLI::Option* add_choice(CLI::App& command, const std::string& names, std::string& value,
                        const std::vector<std::string>& words, const std::string& help) {
  return add_option(command, names, value, fmt::format("{}", fmt::join(words, "|")), help)
      ->check(CLI::IsMember(words))
      ->capture_default_str();
}

void refuse_empty_values(CLI::App& command) {
  for (CLI::Option* option : command.get_options())
    if (option->get_items_expected_max() > 0)
      option->check([](const std::string& word) { return std::string(word.empty() ? "must not be empty" : ""); });
  for (CLI::App* inner : command.get_subcommands({})) refuse_empty_values(*inner);
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  std::vector<std::string> unknown = app.remaining(true);
  // an option that is not known leaves its value behind, and that is no mistake of its own
  std::stable_partition(unknown.begin(), unknown.end(), [](const std::string& word) { return word.starts_with('-'); });

  // a wrong value may be the name of the next option, whose own value is then left over
  const bool is_value_wrong = dynamic_cast<const CLI::ConversionError*>(&error) != nullptr ||
                              dynamic_cast<const CLI::ValidationError*>(&error) != nullptr;
  std::vector<std::string> known;
  std::string text = error.what(), hint;
  if (!unknown.empty() && unknown.front().starts_with('-')) {
    const std::string option = unknown.front().substr(0, unknown.front().find('='));
    for (const CLI::Option* other : command.get_options())
      for (const std::string& name : other->get_lnames()) known.push_back("--" + name);
    text = fmt::format("unknown option '{}'", option);
    hint = scene::did_you_mean(option, {known.begin(), known.end()});
  } else if (!unknown.empty() && !is_value_wrong) {
    for (const CLI::App* other : command.get_subcommands({})) known.push_back(other->get_name());
    text = fmt::format("{} '{}'", known.empty() ? "unexpected argument" : "unknown subcommand", unknown.front());
    hint = scene::did_you_mean(unknown.front(), {known.begin(), known.end()});
  }
  return scene::format_error({path_of(command), 0}, text, hint) + "\nRun with --help for more information.";
}

}  // namespace hexaplast::runner
