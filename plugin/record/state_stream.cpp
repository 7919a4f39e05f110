// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/state_stream.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "record/files.hpp"

namespace hexaplast::output {
namespace {

constexpr std::int64_t kEnd = -1, kSplit = -2;  // in place of a step

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
                              {"of", entry.of_elements ? "hexahedra" : "nodes"}});
  }
  const std::string line = "hexaplast states 2 " + head.dump() + "\n";
  write(line.data(), line.size());
  write(mesh.positions().data(), static_cast<std::size_t>(mesh.num_nodes()) * 3 * sizeof(double));
  write(mesh.hexahedra().data(), static_cast<std::size_t>(mesh.num_elements()) * kCorners * sizeof(int));
  num_nodes_ = mesh.num_nodes();
  for (const Bodies::Entry& entry : bodies_.all()) {
    std::vector<int>& numbers = node_of_stream_.emplace_back(entry.body->mesh().num_nodes());
    std::iota(numbers.begin(), numbers.end(), entry.first_node);
  }
}

void StateStream::write_split() {
  std::vector<std::int32_t> initial;
  std::vector<Hexahedron> hexahedra;
  for (std::size_t k = 0; k < node_of_stream_.size(); ++k) {
    const Body& body = *bodies_.all()[k].body;
    std::vector<int>& numbers = node_of_stream_[k];
    for (std::size_t n = numbers.size(); n < body.copies().initial().size(); ++n) {
      numbers.push_back(num_nodes_++);
      initial.push_back(numbers[body.copies().initial()[n]]);
    }
    for (Hexahedron corners : body.mesh().hexahedra()) {
      for (int& node : corners) node = numbers[node];
      hexahedra.push_back(corners);
    }
  }
  const std::array<std::int64_t, 2> head = {kSplit, static_cast<std::int64_t>(initial.size())};
  write(head.data(), sizeof head);
  write(initial.data(), initial.size() * sizeof(std::int32_t));
  write(hexahedra.data(), hexahedra.size() * sizeof(Hexahedron));
}

PointArray StateStream::in_order_of_stream(const PointArray& values) const {
  PointArray ordered(num_nodes_, 3);
  for (std::size_t k = 0; k < node_of_stream_.size(); ++k)
    for (std::size_t n = 0; n < node_of_stream_[k].size(); ++n)
      ordered.row(node_of_stream_[k][n]) = values.row(bodies_.all()[k].first_node + static_cast<Eigen::Index>(n));
  return ordered;
}

void StateStream::record(const StreamState& state) {
  if (bodies_.mesh().num_nodes() > num_nodes_) write_split();
  const auto step = static_cast<std::int64_t>(state.step);
  write(&step, sizeof step);
  write(&state.time, sizeof state.time);
  write(state.probes.data(), state.probes.size_bytes());
  write(state.measures.data(), state.measures.size() * sizeof(double));

  const auto is_of_elements = [](Field field) { return entry_of(field).of_elements != nullptr; };
  ElementFields of_elements;
  if (std::ranges::any_of(plan_.fields, is_of_elements)) of_elements = bodies_.fields(state.positions);
  const std::span<const unsigned char> alive = bodies_.alive();
  for (const Field field : plan_.fields) {
    if (is_of_elements(field)) {
      std::vector<double> values = of_elements.*entry_of(field).of_elements;
      for (std::size_t e = 0; e < values.size(); ++e)
        if (!alive[e]) values[e] = std::numeric_limits<double>::quiet_NaN();
      write(values.data(), values.size() * sizeof(double));
    } else {
      const PointArray values = in_order_of_stream(nodal_values(field, bodies_, state));
      write(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
    }
  }
  last_step_ = state.step;
}

void StateStream::complete(const NamedTexts& attributes) {
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
