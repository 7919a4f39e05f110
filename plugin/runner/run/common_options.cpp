// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/common_options.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "hexaplast/base/parallel.hpp"
#include "picture/film.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

std::string names_of_fields() {
  std::vector<std::string_view> names;
  for (const output::FieldEntry& entry : output::kFields) names.push_back(entry.word);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

void add_plugins(CLI::App& command, SceneOptions& options) {
  add_option(command, "--plugin", options.plugins, "NAME", "Plugin to load, by name; may be repeated")
      ->allow_extra_args(false);
  add_option(command, "--plugin-path", options.plugin_path, "DIR", "Directory to look for plugins in; may be repeated")
      ->allow_extra_args(false);
}

void add_mesh_path(CLI::App& command, SceneOptions& options) {
  add_option(command, "--mesh-path", options.mesh_path, "DIR",
             "Directory to look for the scene's meshes and includes in; may be repeated")
      ->allow_extra_args(false);
}

void add_scene(CLI::App& command, SceneOptions& options) {
  add_option(command, "scene", options.file, "SCENE", "Scene file")->required();
  add_option(command, "--set", options.overrides, "PATH.attribute=VALUE",
             "Replace an attribute of the scene; may be repeated")
      ->allow_extra_args(false);
  add_mesh_path(command, options);
  add_plugins(command, options);
}

void add_threads(CLI::App& command, std::optional<int>& threads, const char* help) {
  add_option(command, "--threads", threads, "N", help)->check(CLI::Range(1, kMaxThreads));
}

CLI::Option* add_steps(CLI::App& command, std::optional<long>& steps, const char* help) {
  return add_option(command, "--steps", steps, "N", help)->check(CLI::Range(0L, 1'000'000'000L));
}

void add_final_state(CLI::App& command, std::optional<std::filesystem::path>& file) {
  add_option(command, "--final", file, "FILE", "Write the last state as JSON");
}

std::string why_no_fields(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (!output::field_of(word)) return fmt::format("'{}' is none of {}", word, names_of_fields());
    if (std::ranges::count(words, word) > 1) return fmt::format("'{}' is given twice", word);
  }
  return "";
}

CLI::Option* add_fields(CLI::App& command, std::vector<output::Field>& fields) {
  const auto take = [&fields](const std::vector<std::string>& words) {
    if (const std::string why = why_no_fields(words); !why.empty()) throw CLI::ValidationError("--fields", why);
    for (const std::string& word : words) fields.push_back(*output::field_of(word));
  };
  return command
      .add_option_function<std::vector<std::string>>("--fields", take,
                                                     fmt::format("What data sets hold: {}", names_of_fields()))
      ->type_name("FIELD,...")
      ->delimiter(',')
      ->allow_extra_args(false);
}

CLI::Option* add_every(CLI::App& command, long& every) {
  return add_option(command, "--every", every, "N", "Steps between two states in data sets. Default 1")
      ->check(CLI::Range(1L, 1'000'000'000L));
}

void add_strict(CLI::App& command, bool& strict) {
  command.add_flag("--strict", strict,
                   "A run ends with 4 if hexahedra are inverted, if a solver stops before its tolerance, or if the "
                   "error of the energy balance, or the energy "
                   "added by the integrator, exceeds a fifth of the supplied energy");
}

void add_quiet(CLI::App& command, bool& quiet) {
  const auto quieten = [&quiet] {
    quiet = true;
    spdlog::default_logger()->sinks().front()->set_level(spdlog::level::err);
  };
  command.add_flag_callback("--quiet", quieten, "Print nothing but errors");
}

std::vector<CLI::Option*> add_pictures(CLI::App& command, PictureOptions& options) {
  std::vector<std::string> words;
  for (const output::QuantityEntry& entry : output::kQuantities) words.emplace_back(entry.word);
  return {
      command.add_option("--field", options.field, "What colours show. Default plastic_strain; of --region: region")
          ->type_name(fmt::format("{}", fmt::join(words, "|")))
          ->check(CLI::IsMember(words)),
      add_option(command, "--region", options.regions, "NAME",
                 "Show a region of the material within a translucent body; may be repeated")
          ->allow_extra_args(false),
      command
          .add_option("--up", options.up, "What is up. Default: against gravity; without it the patient's head, or y")
          ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}))
          ->type_name("AXIS")};
}

CLI::Option* add_video(CLI::App& command, std::optional<std::filesystem::path>& video, const char* help) {
  const auto refuse = [](const std::string& file) { return output::refusal_of_film(file); };
  return add_option(command, "--video", video, "FILE.png", help)->check(refuse);
}

}  // namespace hexaplast::runner
