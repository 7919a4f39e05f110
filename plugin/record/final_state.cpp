// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "hexaplast/base/hash.hpp"
#include "record/files.hpp"
#include "record/recorder.hpp"

namespace hexaplast::output {
namespace {

using Json = nlohmann::ordered_json;

/// What is infinite is null in the text of JSON; a NaN must not pass for that.
double exact(double value) {
  if (std::isnan(value)) throw OutputError("the last state holds a number that is not one (NaN)");
  return value;
}

Json row_of(const auto& points, Eigen::Index row) {
  return {exact(points(row, 0)), exact(points(row, 1)), exact(points(row, 2))};
}

/// A list whose entries are made one by one: bodies may have millions.
template <class EntryAt>
void write_list(WholeFile& out, std::string_view name, Eigen::Index count, const EntryAt& entry_at) {
  out.write(fmt::format("  \"{}\": [", name));
  for (Eigen::Index i = 0; i < count; ++i) out.write((i == 0 ? "\n    " : ",\n    ") + Json(entry_at(i)).dump());
  out.write("\n  ],\n");
}

void write_points(WholeFile& out, std::string_view name, ConstPoints points) {
  write_list(out, name, points.rows(), [&](Eigen::Index n) { return row_of(points, n); });
}

void write_values(WholeFile& out, std::string_view name, const std::vector<double>& values) {
  write_list(out, name, std::ssize(values), [&](Eigen::Index e) { return exact(values[static_cast<std::size_t>(e)]); });
}

std::vector<ElementPoints> isolated_shapes(const Bodies& bodies) {
  std::vector<ElementPoints> shapes;
  for (const Bodies::Entry& entry : bodies.all())
    for (int e = 0; e < entry.body->mesh().num_elements(); ++e) shapes.push_back(entry.body->element_rest_shape(e));
  return shapes;
}

std::vector<int> removed_of(const Bodies& bodies) {
  std::vector<int> all;
  for (const Bodies::Entry& entry : bodies.all())
    for (const int hexahedron : entry.body->removed()) all.push_back(entry.first_hexahedron + hexahedron);
  return all;
}

/// Which part of the lists is whose.
Json shares_of(const Bodies& bodies) {
  Json shares = Json::array();
  for (const Bodies::Entry& entry : bodies.all())
    shares.push_back({{"name", entry.name},
                      {"first_node", entry.first_node},
                      {"nodes", entry.body->mesh().num_nodes()},
                      {"first_hexahedron", entry.first_hexahedron},
                      {"hexahedra", entry.body->mesh().num_elements()}});
  return shares;
}

}  // namespace

std::string state_hash(long step, ConstPoints positions, ConstPoints velocities, const Body* body) {
  if (!body) return state_hash(step, positions, velocities, std::span<const Bodies::Entry>());
  return state_hash(step, positions, velocities, Bodies(*body).all());
}

std::string state_hash(long step, ConstPoints positions, ConstPoints velocities,
                       std::span<const Bodies::Entry> bodies) {
  const std::int64_t steps = step;
  const PointArray x = positions, v = velocities;  // contiguous, whatever the views are
  StateHash hash;
  hash.add(&steps, sizeof steps);
  hash.add(x.data(), sizeof(double) * static_cast<std::size_t>(x.size()));
  hash.add(v.data(), sizeof(double) * static_cast<std::size_t>(v.size()));
  for (const Bodies::Entry& entry : bodies) entry.body->add_to(hash);
  return hash.text();
}

void write_final(WholeFile& out, double time, ConstPoints positions, ConstPoints velocities, const Bodies& bodies,
                 const std::string& hash) {
  const ElementFields fields = bodies.fields(positions);
  const std::vector<ElementPoints> shapes = isolated_shapes(bodies);
  out.write(fmt::format("{{\n  \"time\": {},\n", Json(exact(time)).dump()));
  write_points(out, "positions", positions);
  write_points(out, "velocities", velocities);
  write_points(out, "plastic_rest_positions", bodies.plastic_rest_positions());
  write_list(out, "isolated_shapes", std::ssize(shapes), [&](Eigen::Index e) {
    Json corners = Json::array();
    for (int a = 0; a < kCorners; ++a) corners.push_back(row_of(shapes[static_cast<std::size_t>(e)], a));
    return corners;
  });
  write_values(out, "volume_ratio", fields.volume_ratio);
  write_values(out, "yield_stress", fields.yield_stress);
  if (!bodies.is_one()) out.write(fmt::format("  \"bodies\": {},\n", shares_of(bodies).dump()));
  out.write(fmt::format("  \"removed\": {},\n  \"state_hash\": \"{}\"\n}}\n", Json(removed_of(bodies)).dump(), hash));
  out.commit();
}

}  // namespace hexaplast::output
