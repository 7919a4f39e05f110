// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "base/simd.hpp"
#include "hexaplast/base/error.hpp"
#include "runner/command.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/common_options.hpp"
#include "runner/study/measured.hpp"
#include "runner/subcommand.hpp"
#include "scene/identity.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

using Json = nlohmann::ordered_json;

/// The first of the places where an input of the scene would be lost, else null.
Json lost_input(scene::Scene& scene, const Json& places) {
  for (const Json& place : places)
    if (const auto found = scene.root().files().inputs.replaced_by(place.get<std::string>()); !found.empty())
      return found.string();
  return nullptr;
}

/// Checks every value against its attribute, so that no run is spent on a mistyped one.
Json describe_varied(scene::Scene& scene, const Json& asked) {
  Json found = Json::array();
  std::map<const scene::Data*, std::string> varied;
  for (const Json& factor : asked) {
    const std::string attribute = factor.at("attribute"), option = factor.at("option");
    for (const Json& value : factor.at("values"))
      scene::override_attribute(scene, fmt::format("{}={}", attribute, value.get<std::string>()), option);
    const scene::Data& data = scene::named_attribute(scene, attribute, option);
    if (const auto [other, is_new] = varied.emplace(&data, attribute); !is_new)
      throw UsageError(fmt::format("{} {}: this attribute is varied already, as {}", option, attribute, other->second));
    found.push_back({{"unit", data.attribute().unit}});
  }
  return found;
}

/// The attribute's value where it is one number.
Json one_number(scene::Data& data) {
  if (!data.link().empty()) return nullptr;
  if (const double* number = std::get_if<double>(&data.value())) return *number;
  if (const auto* numbers = std::get_if<std::vector<double>>(&data.value()); numbers && numbers->size() == 1)
    return numbers->front();
  return nullptr;
}

/// Refuses attributes that are no numbers which the scene gives, and limits that they do not take.
Json describe_free(scene::Scene& scene, const Json& asked) {
  Json found = Json::array();
  for (const Json& one : asked) {
    const std::string option = one.at("option");
    scene::Data& data = scene::named_attribute(scene, one.at("attribute").get<std::string>(), option);
    const attributes::Attribute& attribute = data.attribute();
    const bool is_real = attribute.type == attributes::Type::kReal || attribute.type == attributes::Type::kReals;
    const bool is_chosen =
        attribute.access == attributes::Access::kInput || attribute.access == attributes::Access::kState;
    if (!is_real || !is_chosen)
      throw scene::OverrideError(scene::format_error(
          {option, 0},
          fmt::format("{}.{} holds {}, must be a number that the scene gives", data.owner().class_name(),
                      attribute.name, is_chosen ? attributes::describe(attribute.type) : "what is computed")));
    for (const double limit : one.at("limits").get<std::vector<double>>()) try {
        scene::read_value(attribute, fmt::format("{}", limit));
      } catch (const InputError& error) {
        throw scene::OverrideError(scene::format_error(
            {option, 0}, fmt::format("{}.{}: {}", data.owner().class_name(), attribute.name, error.what())));
      }
    found.push_back({{"unit", attribute.unit}, {"given", one_number(data)}});
  }
  return found;
}

Json describe_curve(SceneOptions options, const Json& asked, const Json& places, Json& input) {
  for (const Json& assignment : asked.at("assignments")) options.overrides.push_back(assignment.get<std::string>());
  Simulation simulation(options);
  if (!simulation.bodies())
    throw scene::SceneError(
        scene::format_error(simulation.scene().root().place(), "no body in the scene: there is nothing to fit"));
  input = lost_input(simulation.scene(), places);
  Json found = {{"dt", simulation.dt()},
                {"bodies", simulation.scene_bodies().size()},
                {"ends", measures_ends(simulation)},
                {"probes", Json::array()}};
  for (scene::Probe* probe : simulation.probes())
    found["probes"].push_back({{"name", probe->name()}, {"unit", probe->unit()}});
  if (asked.at("pulls") && simulation.bodies()->is_one()) {
    const Json& steps = asked.at("steps");
    found["pulls"] = pulls_of(
        simulation, required_steps(simulation, steps.is_null() ? std::nullopt : std::optional(steps.get<long>())));
  }
  return found;
}

/// Reads a request (JSON) from standard input, and prints what it needs to know of the scene (JSON):
///
///   version, simd, scene_hash; steps: those of RunSettings, or null; inputs: device and inode of each file that is
///   read vary: [{option, attribute, values}]  -> attributes: [{unit}]; every value is checked free: [{option,
///   attribute, limits}]  -> free: [{unit, given}]; given: the value of the scene, null if not one number curve:
///   {steps, pulls, assignments}   -> curve: {dt, bodies, ends, probes: [{name, unit}], pulls}: of the scene with
///                                           the assignments, initialised; pulls: per step [N], if asked for
///
/// Throws what reading a scene throws, and UsageError.
void describe_scene(const SceneOptions& options) {
  const Json asked = Json::parse(std::cin);
  if (const std::string why = why_no_fields(asked.value("fields", std::vector<std::string>())); !why.empty())
    throw UsageError("--fields: " + why);
  scene::Scene scene = read_scene(options);
  scene.diagnostics().throw_errors();
  const Json places = asked.value("outputs", Json::array());
  scene::Component* settings = find_settings(scene);
  Json found = {{"version", HEXAPLAST_VERSION},
                {"simd", simd_target()},
                {"scene_hash", scene::hash_scene(scene)},
                {"steps", settings && settings->is_given("steps") ? Json(settings->integer("steps")) : Json(nullptr)},
                {"input", lost_input(scene, places)}};
  found["free"] = describe_free(scene, asked.value("free", Json::array()));
  found["vary"] = describe_varied(scene, asked.value("vary", Json::array()));
  if (asked.contains("curve")) found["curve"] = describe_curve(options, asked["curve"], places, found["input"]);
  fmt::print("{}\n", found.dump());
}

}  // namespace

void add_describe(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "describe", "Describe a scene for hexaplast-sweep and hexaplast-fit", describe_scene,
                     [](const SceneOptions& given) { return given.file.string(); });
  command.group("");
  add_scene(command, options);
}

}  // namespace hexaplast::runner
