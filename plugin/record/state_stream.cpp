// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/state_stream.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "hexaplast/base/error.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace {

/// A field of nodes, one row each.
PointArray nodal_values(Field field, const Bodies& bodies, const StreamState& state) {
  const PointArray& initial = bodies.mesh().positions();
  switch (field) {
    case Field::kDisplacement:
      return state.positions - initial;
    case Field::kVelocity:
      return state.velocities;
    case Field::kPlasticDisplacement:
      return bodies.plastic_rest_positions() - initial;
    case Field::kLoads:
      return state.conditions.loads;
    default:
      break;
  }
  PointArray forces = PointArray::Zero(initial.rows(), 3);
  for (const Instrument& instrument : state.conditions.instruments)
    for (std::size_t i = 0; i < instrument.nodes.size(); ++i)
      forces.row(instrument.nodes[i]) += instrument.forces.row(static_cast<Eigen::Index>(i));
  return forces;
}

/// A field of hexahedra.
const std::vector<double>& element_values(Field field, const ElementFields& fields) {
  switch (field) {
    case Field::kStrain:
      return fields.strain;
    case Field::kStress:
      return fields.stress_norm;
    case Field::kYieldStress:
      return fields.yield_stress;
    case Field::kVolumeRatio:
      return fields.volume_ratio;
    default:
      return fields.plastic_strain;
  }
}

nlohmann::ordered_json json_of(const NamedTexts& texts) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [name, text] : texts) json[name] = text;
  return json;
}

}  // namespace

std::optional<Field> field_of(std::string_view word) {
  const auto found = std::ranges::find(kFields, word, &FieldEntry::word);
  if (found == kFields.end()) return std::nullopt;
  return found->field;
}

StateStream::StateStream(int descriptor, Bodies bodies, StatePlan plan)
    : descriptor_(descriptor), bodies_(std::move(bodies)), plan_(std::move(plan)) {
  const HexMesh& mesh = bodies_.mesh();
  nlohmann::ordered_json head = {{"nodes", mesh.num_nodes()},
                                 {"hexahedra", mesh.num_elements()},
                                 {"probes", plan_.probes},
                                 {"measures", plan_.measures},
                                 {"fields", nlohmann::ordered_json::array()},
                                 {"attributes", json_of(plan_.attributes)},
                                 {"overrides", json_of(plan_.overrides)}};
  for (const Field field : plan_.fields) {
    const FieldEntry& entry = entry_of(field);
    head["fields"].push_back({{"name", entry.word},
                              {"unit", entry.unit},
                              {"description", entry.help},
                              {"of", entry.of_nodes ? "nodes" : "hexahedra"}});
  }
  const std::string line = "hexaplast states 1 " + head.dump() + "\n";
  write(line.data(), line.size());
  write(mesh.positions().data(), static_cast<std::size_t>(mesh.num_nodes()) * 3 * sizeof(double));
  write(mesh.hexahedra().data(), static_cast<std::size_t>(mesh.num_elements()) * kCorners * sizeof(int));
}

void StateStream::record(const StreamState& state) {
  if (bodies_.are_split())
    throw InputError("joints of a body have been opened: the data of a run has no place for nodes that split");
  const auto step = static_cast<std::int64_t>(state.step);
  write(&step, sizeof step);
  write(&state.time, sizeof state.time);
  write(state.probes.data(), state.probes.size_bytes());
  write(state.measures.data(), state.measures.size() * sizeof(double));

  const auto is_of_elements = [](Field field) { return !entry_of(field).of_nodes; };
  ElementFields of_elements;
  if (std::ranges::any_of(plan_.fields, is_of_elements)) of_elements = bodies_.fields(state.positions);
  const std::span<const unsigned char> alive = bodies_.alive();
  for (const Field field : plan_.fields) {
    if (is_of_elements(field)) {
      std::vector<double> values = element_values(field, of_elements);
      for (std::size_t e = 0; e < values.size(); ++e)
        if (!alive[e]) values[e] = std::numeric_limits<double>::quiet_NaN();
      write(values.data(), values.size() * sizeof(double));
    } else {
      const PointArray values = nodal_values(field, bodies_, state);
      write(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
    }
  }
  last_step_ = state.step;
}

void StateStream::complete(const NamedTexts& attributes) {
  constexpr std::int64_t kEnd = -1;
  write(&kEnd, sizeof kEnd);
  const std::string json = json_of(attributes).dump();
  write(json.data(), json.size());
}

void StateStream::write(const void* data, std::size_t bytes) const {
  for (const char* at = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t done = ::write(descriptor_, at, bytes);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) throw OutputError("stream of states", "cannot be written", errno);
    at += done;
    bytes -= static_cast<std::size_t>(done);
  }
}

}  // namespace hexaplast::output
