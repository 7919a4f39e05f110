// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "record/files.hpp"

namespace hexaplast::output {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kStates = {"running", "finished", "interrupted", "failed"};

Json json_of(const std::vector<ComponentRecord>& components) {
  Json list = Json::array();
  for (const ComponentRecord& component : components) {
    Json attributes = Json::object();
    for (const AttributeRecord& attribute : component.attributes) attributes[attribute.name] = attribute.value;
    list.push_back({{"path", component.path}, {"class", component.class_name}, {"attributes", attributes}});
  }
  return list;
}

Json json_of(const std::vector<Figure>& figures) {
  Json list = Json::object();
  for (const Figure& figure : figures) list[figure.label] = figure.value;
  return list;
}

Json json_of(const std::vector<ProbeRecord>& probes) {
  Json list = Json::array();
  for (const ProbeRecord& probe : probes) list.push_back({{"name", probe.name}, {"unit", probe.unit}});
  return list;
}

/// JSON's numbers know no limits.
template <std::integral Integer>
Integer integer_of(const Json& json) {
  const double number = json;
  constexpr double kMax = static_cast<double>(std::numeric_limits<Integer>::max() / 2);
  if (!json.is_number_integer() || !(number >= 0 && number <= kMax))
    throw OutputError(fmt::format("a number {}: must be a whole one from 0 to {}", json.dump(), kMax));
  return json;
}

std::vector<ComponentRecord> components_of(const Json& list) {
  std::vector<ComponentRecord> components;
  for (const Json& json : list) {
    ComponentRecord component{.path = json.at("path"), .class_name = json.at("class")};
    for (const auto& [name, value] : json.at("attributes").items()) component.attributes.push_back({name, value});
    components.push_back(std::move(component));
  }
  return components;
}

Json json_of(const Vec3& vector) { return {vector.x(), vector.y(), vector.z()}; }

Vec3 vector_of(const Json& json) { return Vec3(json.at(0), json.at(1), json.at(2)); }

Json json_of(const std::optional<Viewpoint>& viewpoint) {
  if (!viewpoint) return nullptr;
  Json json{{"towards", json_of(viewpoint->towards)}};
  if (viewpoint->up) json["up"] = json_of(*viewpoint->up);
  if (const auto& eye = viewpoint->eye)
    json["eye"] = {{"position", json_of(eye->position)},
                   {"looks_at", json_of(eye->looks_at)},
                   {"field_of_view_deg", eye->field_of_view},
                   {"perspective", eye->is_perspective}};
  return json;
}

std::optional<Viewpoint> viewpoint_of(const Json& json) {
  if (json.is_null()) return std::nullopt;
  Viewpoint viewpoint{vector_of(json.at("towards")), {}, {}};
  if (json.contains("up")) viewpoint.up = vector_of(json.at("up"));
  if (json.contains("eye")) {
    const Json& eye = json.at("eye");
    viewpoint.eye = Viewpoint::Eye{vector_of(eye.at("position")), vector_of(eye.at("looks_at")),
                                   eye.at("field_of_view_deg"), eye.at("perspective")};
  }
  return viewpoint;
}

Json json_of(const PictureRecord& pictures) {
  Json json{{"hexahedra", pictures.shows_hexahedra},
            {"loads", pictures.shows_loads},
            {"camera", json_of(pictures.viewpoint)},
            {"gravity_m_per_s2", json_of(pictures.gravity)},
            {"anatomical", pictures.is_anatomical}};
  if (pictures.up) json["up"] = json_of(*pictures.up);
  return json;
}

PictureRecord pictures_of(const Json& json) {
  return {.shows_hexahedra = json.at("hexahedra"),
          .shows_loads = json.at("loads"),
          .viewpoint = viewpoint_of(json.at("camera")),
          .gravity = vector_of(json.at("gravity_m_per_s2")),
          .is_anatomical = json.value("anatomical", false),  // earlier versions did not write it
          .up = json.contains("up") ? std::optional(vector_of(json.at("up"))) : std::nullopt};
}

RunState state_of(const std::string& word) {
  const auto found = std::ranges::find(kStates, word);
  if (found == kStates.end()) throw OutputError(fmt::format("state: '{}', must be {}", word, fmt::join(kStates, ", ")));
  return static_cast<RunState>(found - kStates.begin());
}

Json json_of(const Manifest& run) {
  Json json{{"program", "hexaplast"},
            {"version", run.version},
            {"state", describe(run.state)},
            {"exit_reason", run.exit_reason},
            {"command", run.command},
            {"working_directory", run.working_directory},
            {"scene",
             {{"name", run.title},
              {"file", run.scene_file},
              {"xxh64", run.scene_hash},
              {"heading", run.heading},
              {"description", run.description}}},
            {"overrides", run.overrides},
            {"threads", run.threads},
            {"simd", run.simd},
            {"precision", run.precision},
            {"solver", {{"motion", run.motion_solver}, {"linear", run.linear_solver}}},
            {"machine", {{"processor", run.processor}, {"cores", run.cores}, {"memory_bytes", run.memory_bytes}}},
            {"started", run.started},
            {"duration_s", run.duration},
            {"dt_s", run.dt},
            {"steps", {{"asked", run.steps_asked}, {"done", run.steps_done}}},
            {"state_hash", run.state_hash},
            {"summary", json_of(run.summary)},
            {"warnings", run.warnings}};
  if (run.pictures) json["pictures"] = json_of(*run.pictures);
  if (!run.probes.empty()) json["probes"] = json_of(run.probes);
  json["components"] = json_of(run.components);
  return json;
}

Manifest manifest_of(const Json& json) {
  Manifest run;
  run.version = json.at("version");
  run.state = state_of(json.at("state"));
  run.exit_reason = json.at("exit_reason");
  run.command = json.at("command").get<std::vector<std::string>>();
  run.working_directory = json.at("working_directory");
  run.title = json.at("scene").at("name");
  run.heading = json.at("scene").value("heading", "");  // earlier versions did not write it
  run.description = json.at("scene").value("description", "");
  run.scene_file = json.at("scene").at("file");
  run.scene_hash = json.at("scene").at("xxh64");
  run.overrides = json.at("overrides").get<std::vector<std::string>>();
  run.threads = integer_of<int>(json.at("threads"));
  run.simd = json.at("simd");
  run.precision = json.at("precision");
  run.motion_solver = json.at("solver").at("motion");
  run.linear_solver = json.at("solver").at("linear");
  run.processor = json.at("machine").at("processor");
  run.cores = integer_of<int>(json.at("machine").at("cores"));
  run.memory_bytes = integer_of<std::uint64_t>(json.at("machine").at("memory_bytes"));
  run.started = json.at("started");
  run.duration = json.at("duration_s");
  run.dt = json.at("dt_s");
  run.steps_asked = integer_of<long>(json.at("steps").at("asked"));
  run.steps_done = integer_of<long>(json.at("steps").at("done"));
  run.state_hash = json.at("state_hash");
  for (const auto& [label, value] : json.at("summary").items()) run.summary.push_back({label, value});
  run.warnings = json.at("warnings").get<std::vector<std::string>>();
  if (json.contains("pictures")) run.pictures = pictures_of(json.at("pictures"));
  for (const Json& probe : json.value("probes", Json::array()))
    run.probes.push_back({.name = probe.at("name"), .unit = probe.at("unit")});
  run.components = components_of(json.at("components"));
  return run;
}

/// The content of a file in a directory that a stranger may have filled: of more than a million values, or a hundred in
/// one another, nothing is kept. A value costs up to 80 bytes of memory, however few it takes in the file.
Json read_json(const std::filesystem::path& file) {
  constexpr long kMaxValues = 1'000'000;
  constexpr int kMaxLevels = 100;
  require_readable(file);
  std::ifstream in(file);
  long num_values = 0;
  return Json::parse(in, [&](int level, Json::parse_event_t event, Json&) {
    const bool opens = event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    if (opens || event == Json::parse_event_t::value) ++num_values;
    if (num_values > kMaxValues || (opens && level >= kMaxLevels))
      throw Json::other_error::create(599, "more than a million values, or a hundred in one another", nullptr);
    return true;
  });
}

}  // namespace

std::string_view describe(RunState state) { return kStates[static_cast<std::size_t>(state)]; }

void write_manifest(const std::filesystem::path& directory, const Manifest& manifest) {
  WholeFile out(directory / kManifestName);
  // words of a command line may be any bytes, JSON is UTF-8
  out.write(json_of(manifest).dump(2, ' ', false, Json::error_handler_t::replace));
  out.write("\n");
  out.commit();
}

std::optional<Manifest> read_manifest(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / kManifestName;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  try {
    return manifest_of(read_json(file));
  } catch (const nlohmann::json::exception& problem) {
    throw OutputError(fmt::format("{}: is no manifest of a run: {}", file.string(), problem.what()));
  } catch (const OutputError& problem) {
    throw OutputError(fmt::format("{}: {}", file.string(), problem.what()));
  }
}

}  // namespace hexaplast::output
