// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/output_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "record/files.hpp"

namespace hexaplast::runner {
namespace {

using std::filesystem::path;

/// The same for all names of a place, whether or not something is there.
path resolved(const path& place) {
  return std::filesystem::weakly_canonical((std::filesystem::absolute(place) / "").parent_path());
}

}  // namespace

void add_allow_outside(CLI::App& command, scene::OutputRules& rules) {
  command.add_flag("--allow-outside", rules.allows_outside,
                   "Let the scene's components write outside of the run's directory: absolute names, .., links");
}

void add_output_rules(CLI::App& command, scene::OutputRules& rules, const char* force_help) {
  add_allow_outside(command, rules);
  command.add_flag("--force", rules.replaces, force_help);
}

void add_write_below(CLI::App& command, std::optional<path>& write_below) {
  command
      .add_option("--write-below", write_below,
                  "Directory for what the scene's components write; otherwise that of --out, or the working directory")
      ->type_name("DIR")
      ->excludes("--out");
}

bool OwnFiles::has_in_run(const path& file) const {
  if (!run) return false;
  const path below = resolved(file).lexically_relative(resolved(*run));
  const std::string first = below.empty() ? "" : below.begin()->string();
  return output::is_of_run(first) || first == "frames";
}

bool OwnFiles::has(const path& file) const {
  return has_in_run(file) || std::ranges::any_of(named, [&](const auto& own) { return own && resolved(*own) == file; });
}

scene::OutputRules rules_beside(OwnFiles own, path directory, scene::OutputRules rules) {
  rules.directory = std::move(directory);
  rules.is_taken = [own = std::move(own)](const path& file) { return own.has(file); };
  return rules;
}

bool writes_into(const scene::OutputFiles& files, const path& directory) {
  return std::ranges::any_of(files.claimed(), [&](const std::string& file) {
    return *path(file).lexically_relative(resolved(directory)).begin() != "..";
  });
}

}  // namespace hexaplast::runner
