// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <cmath>
#include <cstdint>

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

void write_isolated_shapes(WholeFile& out, const Body& body) {
  out.write("  \"isolated_shapes\": [");
  for (int e = 0; e < body.mesh().num_elements(); ++e) {
    const ElementPoints shape = body.element_rest_shape(e);
    out.write(e == 0 ? "\n    [" : ",\n    [");
    for (int a = 0; a < kCorners; ++a)
      out.write(fmt::format("{}[{}, {}, {}]", a == 0 ? "" : ", ", exact(shape(a, 0)), exact(shape(a, 1)),
                            exact(shape(a, 2))));
    out.write("]");
  }
  out.write("\n  ],\n");
}

}  // namespace

std::string state_hash(long step, ConstPoints positions, ConstPoints velocities, const Body* body) {
  const std::int64_t steps = step;
  const PointArray x = positions, v = velocities;  // contiguous, whatever the views are
  StateHash hash;
  hash.add(&steps, sizeof steps);
  hash.add(x.data(), sizeof(double) * static_cast<std::size_t>(x.size()));
  hash.add(v.data(), sizeof(double) * static_cast<std::size_t>(v.size()));
  if (body) body->add_to(hash);
  return hash.text();
}

void write_final(const std::filesystem::path& file, long step, double time, ConstPoints positions,
                 ConstPoints velocities, const Body& body) {
  WholeFile out(file);
  write_final(out, step, time, positions, velocities, body);
}

void write_final(WholeFile& out, long step, double time, ConstPoints positions, ConstPoints velocities,
                 const Body& body) {
  const ElementFields fields = body.fields(positions);
  out.write(fmt::format("{{\n  \"time\": {},\n", exact(time)));
  write_points(out, "positions", positions);
  write_points(out, "velocities", velocities);
  write_points(out, "material_positions", body.plastic_rest_positions());
  write_isolated_shapes(out, body);
  write_values(out, "volume_ratio", fields.volume_ratio);
  write_values(out, "yield_stress", fields.yield_stress);
  out.write(fmt::format("  \"removed\": [{}],\n", fmt::join(body.removed(), ", ")));
  out.write(fmt::format("  \"state_hash\": \"{}\"\n}}\n", state_hash(step, positions, velocities, &body)));
  out.commit();
}

}  // namespace hexaplast::output
