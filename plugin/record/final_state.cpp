// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "hexaplast/base/hash.hpp"
#include "record/files.hpp"
#include "record/recorder.hpp"

namespace hexaplast::output {
namespace {

/// 17 significant digits give every double back; JSON has no infinity, and a NaN must not pass for one.
std::string exact(double value) {
  if (std::isnan(value)) throw OutputError("the last state holds a number that is not one (NaN)");
  return std::isfinite(value) ? fmt::format("{:.17g}", value) : "null";
}

void write_points(WholeFile& out, std::string_view name, ConstPoints points) {
  out.write(fmt::format("  \"{}\": [", name));
  for (Eigen::Index n = 0; n < points.rows(); ++n)
    out.write(fmt::format("{}\n    [{}, {}, {}]", n == 0 ? "" : ",", exact(points(n, 0)), exact(points(n, 1)),
                          exact(points(n, 2))));
  out.write("\n  ],\n");
}

void write_values(WholeFile& out, std::string_view name, const std::vector<double>& values) {
  out.write(fmt::format("  \"{}\": [", name));
  for (std::size_t e = 0; e < values.size(); ++e) out.write((e == 0 ? "" : ", ") + exact(values[e]));
  out.write("],\n");
}

void write_isolated_shapes(WholeFile& out, const Bodies& bodies) {
  out.write("  \"isolated_shapes\": [");
  bool is_first = true;
  for (const Bodies::Entry& entry : bodies.all())
    for (int e = 0; e < entry.body->mesh().num_elements(); ++e) {
      const ElementPoints shape = entry.body->element_rest_shape(e);
      out.write(std::exchange(is_first, false) ? "\n    [" : ",\n    [");
      for (int a = 0; a < kCorners; ++a)
        out.write(fmt::format("{}[{}, {}, {}]", a == 0 ? "" : ", ", exact(shape(a, 0)), exact(shape(a, 1)),
                              exact(shape(a, 2))));
      out.write("]");
    }
  out.write("\n  ],\n");
}

std::vector<int> removed_of(const Bodies& bodies) {
  std::vector<int> all;
  for (const Bodies::Entry& entry : bodies.all())
    for (const int hexahedron : entry.body->removed()) all.push_back(entry.first_hexahedron + hexahedron);
  return all;
}

void write_fractions(WholeFile& out, const Bodies& bodies) {
  std::vector<std::string> ranges;
  for (const Bodies::Entry& entry : bodies.all())
    ranges.push_back(nlohmann::ordered_json{{"name", entry.name},
                                            {"first_node", entry.first_node},
                                            {"nodes", entry.body->mesh().num_nodes()},
                                            {"first_hexahedron", entry.first_hexahedron},
                                            {"hexahedra", entry.body->mesh().num_elements()}}
                         .dump());
  out.write(fmt::format("  \"bodies\": [{}],\n", fmt::join(ranges, ", ")));
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

void write_final(const std::filesystem::path& file, long step, double time, ConstPoints positions,
                 ConstPoints velocities, const Bodies& bodies) {
  WholeFile out(file);
  write_final(out, step, time, positions, velocities, bodies);
}

void write_final(WholeFile& out, long step, double time, ConstPoints positions, ConstPoints velocities,
                 const Bodies& bodies, std::string hash) {
  if (hash.empty()) hash = state_hash(step, positions, velocities, bodies.all());
  const ElementFields fields = bodies.fields(positions);
  out.write(fmt::format("{{\n  \"time\": {},\n", exact(time)));
  write_points(out, "positions", positions);
  write_points(out, "velocities", velocities);
  write_points(out, "plastic_rest_positions", bodies.plastic_rest_positions());
  write_isolated_shapes(out, bodies);
  write_values(out, "volume_ratio", fields.volume_ratio);
  write_values(out, "yield_stress", fields.yield_stress);
  if (!bodies.is_one()) write_fractions(out, bodies);
  out.write(fmt::format("  \"removed\": [{}],\n", fmt::join(removed_of(bodies), ", ")));
  out.write(fmt::format("  \"state_hash\": \"{}\"\n}}\n", hash));
  out.commit();
}

}  // namespace hexaplast::output
