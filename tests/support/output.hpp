// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "record/recorder.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {

/// Everything below a directory, by name.
inline std::vector<std::string> names_in(const std::filesystem::path& directory) {
  std::vector<std::string> names;
  for (const std::filesystem::directory_entry& entry : std::filesystem::recursive_directory_iterator(directory))
    names.push_back(entry.path().lexically_relative(directory).string());
  std::ranges::sort(names);
  return names;
}

/// A run that writes a mesh every so many steps, and no pictures.
inline output::RunPlan plan(long steps, int every) {
  return {.title = "test",
          .num_steps = steps,
          .dt = 0.01,
          .output_every = every,
          .num_frames = 0,
          .force = false,
          .loaded_nodes = {}};
}

/// A distorted block whose hexahedra yield, except the first, which never does.
inline Body yielding_block() {
  const HexMesh mesh = distorted_block({2, 3, 5}, 0.1, 0.12, 11);
  std::vector<Material> materials(mesh.num_elements(), Material{.yield_stress = 120, .flow_rate = 4, .hardening = 0.2});
  materials.front().yield_stress = std::numeric_limits<double>::infinity();
  return Body(mesh, materials);
}

/// Stretched along z by the given share, thinner across, sheared a little.
inline PointArray stretched(const PointArray& points, double fraction) {
  Mat3 A;
  A << 1 - 0.4 * fraction, 0.1 * fraction, 0, 0, 1 - 0.45 * fraction, 0.05 * fraction, 0.02 * fraction, 0, 1 + fraction;
  return mapped(points, A, fraction * Vec3(0.3, -0.2, 0.1));
}

/// Two embedded surfaces in the block: a quad and a triangle, and a triangle that reaches out of it.
inline std::vector<output::EmbeddedSurface> two_surfaces() {
  std::vector<output::EmbeddedSurface> surfaces(2);
  surfaces[0].points.resize(5, 3);
  surfaces[0].points << .02, .03, .05, .02, .27, .05, .17, .27, .31, .17, .03, .31, .1, .1, .47;
  surfaces[0].quads = {{0, 1, 2, 3}};
  surfaces[0].triangles = {{3, 2, 4}};
  surfaces[1].points.resize(3, 3);
  surfaces[1].points << .11, .12, .21, .11, .19, .55, .3, .12, .3;
  surfaces[1].triangles = {{0, 1, 2}};
  return surfaces;
}

/// What `--final` writes of a body after so many steps.
inline void write_final(const std::filesystem::path& path, long step, double time, ConstPoints x, ConstPoints v,
                        const Body& body) {
  output::WholeFile file(path);
  output::write_final(file, time, x, v, body, output::state_hash(step, x, v, &body));
}

/// Velocities that are all different.
inline PointArray some_velocities(const Body& body) { return Random(5).field(body.mesh().num_nodes(), 0.7); }

/// Something on every node, and an instrument that pulls at two of them.
inline output::BoundaryConditions some_conditions(const Body& body) {
  output::BoundaryConditions conditions;
  for (int n = 0; n < body.mesh().num_nodes(); ++n) conditions.fixed.push_back(n % 3 == 1);
  conditions.loads = Random(8).field(body.mesh().num_nodes(), 2.5);
  output::Instrument& instrument = conditions.instruments.emplace_back();
  instrument.id = 1;
  instrument.place = Vec3(0.1, 0.2, 0.7);
  instrument.nodes = {4, 9};
  instrument.forces = conditions.loads(instrument.nodes, Eigen::all);
  return conditions;
}

/// Records the initial state and steps 1 .. last of a stretch that grows by 2 % a step; returns the last positions.
inline PointArray record_stretch(output::Recorder& recorder, Body& body, long last, double dt = 0.01) {
  const PointArray velocities = some_velocities(body);
  const output::BoundaryConditions conditions = some_conditions(body);
  PointArray x = body.mesh().positions();
  recorder.record({}, x, velocities, conditions);
  for (long step = 1; step <= last; ++step) {
    x = stretched(body.mesh().positions(), 0.02 * static_cast<double>(step));
    body.linearize(x);
    const FlowReport report = body.flow(x, dt);
    recorder.record({.step = step,
                     .time = static_cast<double>(step) * dt,
                     .kinetic_energy = 0.1 / 3,
                     .flow = report,
                     .solver_iterations = 7,
                     .residual = 1e-6 / 3,
                     .step_ms = 0.125},
                    x, velocities, conditions);
  }
  return x;
}

/// That stretch, recorded so many steps as planned into `run`.
struct Recorded {
  Recorded(const output::RunPlan& plan, long last)
      : recorder(scratch / "run", body, plan), x(record_stretch(recorder, body, last)) {}

  std::string read(const std::string& file) const { return content(scratch / ("run/" + file)); }
  Csv history() const { return Csv(read("history.csv")); }

  const Scratch scratch;
  Body body = yielding_block();
  output::Recorder recorder;
  PointArray x;  ///< [m] the last positions
};

/// A pillar of two hexahedra in each of six layers, of which the fourth is drawn out until it breaks.
struct TornPillar {
  void tear() {
    for (Eigen::Index n = 0; n < x.rows(); ++n)
      if (x(n, 2) > 0.35) x(n, 2) += 0.08;
    body.linearize(x);
    report = body.flow(x, 0.01);
    ASSERT_GT(body.removed().size(), 0u);
    ASSERT_LT(body.removed().size(), 12u);
  }

  Body body{block({1, 2, 6}, 0.1),
            {Material{.yield_stress = 10, .flow_rate = 90, .hardening = 0.5, .fracture_stress = 200}}};
  PointArray x = body.mesh().positions();
  FlowReport report;
};

}  // namespace hexaplast::support
