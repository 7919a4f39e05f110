// SPDX-License-Identifier: LGPL-2.1-or-later
// The tables of a run: every number can be read back with its last bit.
#include "record/recorder.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "body_state.hpp"
#include "picture/axis.hpp"
#include "record/recorded_run.hpp"
#include "record/state_arrays.hpp"
#include "support/german_locale.hpp"
#include "support/output.hpp"
#include "support/vtu_reader.hpp"

namespace hexaplast {
namespace {

using namespace support;

using output::OutputError;
using output::Recorder;
using output::RunPlan;

constexpr const char* kHeader =
    "step,time,kinetic_energy,elastic_energy,dissipated_energy,current_volume_ratio,plastic_rest_volume_ratio,"
    "plastic_elongation,plastic_twist_deg,end_displacement,yielded,inverted,removed,solver_iterations,residual,step_ms,"
    "rolled_back,current_elongation,current_twist_deg\n";

TEST(HistoryTable, HasOneRowPerStepWithTheBodysNumbersToTheLastBit) {
  RunPlan loaded = plan(6, 100);
  loaded.loaded_nodes = {3, 17};
  const Recorded run(loaded, 6);
  const Body& body = run.body;
  const PointArray& x = run.x;
  const std::string text = run.read("history.csv");  // before finish(): a killed run keeps its rows
  EXPECT_TRUE(text.starts_with(kHeader)) << text;
  const Csv history(text);
  EXPECT_EQ(history.numbers("step"), (std::vector<double>{0, 1, 2, 3, 4, 5, 6}));

  const PointArray& X = body.mesh().positions();
  const output::Summary summary = output::summarise(body, x);
  for (const auto& [column, value] : std::vector<std::pair<std::string, double>>{
           {"time", 6 * 0.01},
           {"kinetic_energy", 0.1 / 3},
           {"elastic_energy", body.energy(x)},
           {"dissipated_energy", body.dissipated_energy()},
           {"current_volume_ratio", body.volume(x) / body.initial_volume()},
           {"plastic_rest_volume_ratio", body.volume(X) / body.initial_volume()},  // which flow keeps
           {"plastic_elongation", summary.plastic_elongation},
           {"plastic_twist_deg", summary.plastic_twist_deg},
           {"end_displacement", ((x.row(3) - X.row(3)).norm() + (x.row(17) - X.row(17)).norm()) / 2},
           {"removed", 0},
           {"solver_iterations", 7},
           {"residual", 1e-6 / 3},
           {"step_ms", 0.125},
           {"rolled_back", 0},
           {"current_elongation", summary.current_elongation},
           {"current_twist_deg", summary.current_twist_deg}})
    EXPECT_EQ(history.number(6, column), value) << column;
  EXPECT_GT(history.number(6, "yielded"), 0);
}

// Of isolated rest shapes they would take linear systems in every step.
TEST(HistoryTable, LeavesOutTheShapeWithoutLoadWhereItIsNotWanted) {
  RunPlan bare = plan(2, 100);
  bare.has_plastic_ends = false;
  const Recorded run(bare, 2);
  std::vector<std::string> expected = Csv(kHeader).columns();
  std::erase_if(expected, [](const std::string& name) {
    return name.starts_with("plastic_elong") || name.starts_with("plastic_twist");
  });
  EXPECT_EQ(run.history().columns(), expected);
  EXPECT_EQ(run.history().number(2, "current_elongation"), output::summarise(run.body, run.x).current_elongation);
}

TEST(MeshFiles, HaveACopyOfANodeOnEachSideOfACut) {
  const Scratch scratch;
  Body body(block({2, 1, 1}, 0.1), {Material()});
  RunPlan opens = plan(1, 1);
  opens.has_openings = true;
  Recorder recorder(scratch / "run", body, opens);
  PointArray x = body.mesh().positions(), v = PointArray::Zero(x.rows(), 3);
  recorder.record({.step = 0, .time = 0}, x, v);
  const std::vector<int> parents = body.open(std::array{0});
  append_rows(parents, x);
  append_rows(parents, v);
  for (const int node : body.mesh().hexahedra()[1]) x(node, 0) += 0.05;
  recorder.record({.step = 1, .time = 0.01}, x, v);
  recorder.finish();

  const auto files = series_in(scratch / "run");
  ASSERT_EQ(files.size(), 2u);
  const ImportedState whole = read_vtu_state(files[0].second), cut = read_vtu_state(files[1].second);
  EXPECT_EQ(whole.mesh.positions.rows(), 12);
  EXPECT_FALSE(output::has_point_data(whole, "initial_node")) << "as in runs without cuts";
  EXPECT_EQ(cut.mesh.positions, x);
  EXPECT_EQ(cut.mesh.hexahedra, body.mesh().hexahedra());
  EXPECT_EQ(output::point_numbers(files[1].second, cut, "initial_node"), body.copies().initial());
  EXPECT_EQ(output::cell_scalars(files[0].second, whole, "part"), (std::vector<double>{0, 0}));
  EXPECT_EQ(output::cell_scalars(files[1].second, cut, "part"), (std::vector<double>{0, 1}));
  const Csv history(content(scratch / "run/history.csv"));
  EXPECT_NEAR(history.number(1, "current_volume_ratio"), 1, 1e-14);
  EXPECT_EQ(history.numbers("opened"), (std::vector<double>{0, 1}));
  EXPECT_EQ(history.numbers("pieces"), (std::vector<double>{1, 2}));
  EXPECT_EQ(content(scratch / "run/opened.csv"), "step,time,hexahedra\n1,0.01,0 1\n");

  output::RecordedRun run(scratch / "run");
  const auto state = [&](std::size_t k) { return run.state(run.entries()[k], output::Quantity::kPlasticStrain); };
  EXPECT_EQ(state(1).positions, x);
  EXPECT_EQ(run.mesh().hexahedra(), body.mesh().hexahedra());
  EXPECT_EQ(state(0).positions, body.initial_mesh().positions());
  EXPECT_EQ(run.mesh().hexahedra(), body.initial_mesh().hexahedra());
}

TEST(RemovedTable, SaysInWhichStepEachHexahedronWent) {
  const Scratch scratch;
  constexpr int kBars = 2000;
  const PointArray one = block({1, 1, 1}, 0.1).positions();
  PointArray X(8 * kBars, 3);
  std::vector<Hexahedron> hexahedra;
  for (int e = 0; e < kBars; ++e) {
    X.middleRows(8 * e, 8) = one.rowwise() + Eigen::RowVector3d(e, 0, 0);
    hexahedra.push_back(block({1, 1, 1}, 0.1).hexahedra()[0]);
    for (int& node : hexahedra.back()) node += 8 * e;
  }
  Body body(HexMesh(X, hexahedra),
            {Material{.yield_stress = 10, .flow_rate = 90, .hardening = 0.5, .fracture_stress = 200}});
  Recorder recorder(scratch / "run", body, plan(3, 100));
  recorder.record({.step = 0, .time = 0}, X, PointArray::Zero(X.rows(), 3));

  // two in the first step, none in the second, all others in the third
  std::string expected = "step,time,hexahedron\n1,0.01,7\n1,0.01,1203\n";
  PointArray x = X;
  for (int step = 1; step <= 3; ++step) {
    for (int e = 0; e < kBars; ++e) {
      const bool breaks = step == 3 || (step == 1 && (e == 7 || e == 1203));
      for (int n = 8 * e; n < 8 * (e + 1); ++n)
        if (breaks && X(n, 2) > 0.05) x(n, 2) = X(n, 2) + 0.08;
      if (step == 3 && e != 7 && e != 1203) expected += "3,0.03," + std::to_string(e) + "\n";
    }
    const FlowReport report = body.flow(x, 0.01);
    recorder.record({.step = step, .time = step / 100.0, .flow = report}, x, some_velocities(body));
    if (step < 3) {
      EXPECT_EQ(content(scratch / "run/removed.csv"), "step,time,hexahedron\n1,0.01,7\n1,0.01,1203\n");
    }
  }
  EXPECT_EQ(content(scratch / "run/removed.csv"), expected);  // complete before finish(): a killed run keeps its rows
  recorder.finish();

  // with nothing left, all that is written are numbers still
  EXPECT_EQ(body.removed().size(), std::size_t(kBars));
  const Csv history(content(scratch / "run/history.csv"));
  for (const std::string& column : history.columns()) EXPECT_TRUE(std::isfinite(history.number(3, column))) << column;
  EXPECT_EQ(history.number(3, "plastic_rest_volume_ratio"), 0);
  EXPECT_EQ(history.number(3, "removed"), kBars);
  EXPECT_EQ(output::summarise(body, x).num_pieces, 0);
  EXPECT_EQ(output::summarise(body, x).plastic_strain.hexahedron, -1);
}

TEST(FinalState, ComesBackWithAllItsBits) {
  const Scratch scratch;
  Body body = yielding_block();
  PointArray x = stretched(body.mesh().positions(), 0.2);
  const PointArray v = some_velocities(body);
  body.linearize(x);
  body.flow(x, 0.01);
  support::write_final(scratch / "final.json", 42, 0.1 + 0.2, x, v, body);

  std::ifstream in(scratch / "final.json");
  const nlohmann::json read = nlohmann::json::parse(in);
  const ElementFields fields = body.fields(x);
  const auto expect_points = [&](const char* name, const PointArray& points) {
    ASSERT_EQ(read[name].size(), static_cast<std::size_t>(points.rows()));
    for (Eigen::Index n = 0; n < points.rows(); ++n)
      for (int d = 0; d < 3; ++d) EXPECT_EQ(read[name][n][d].get<double>(), points(n, d)) << name << " " << n;
  };
  EXPECT_EQ(read["time"].get<double>(), 0.1 + 0.2);
  expect_points("positions", x);
  expect_points("velocities", v);
  expect_points("plastic_rest_positions", body.plastic_rest_positions());
  const ElementHistory second = body.state().history.element(body.state().model, 1);
  ASSERT_EQ(read["isolated_shapes"].size(), static_cast<std::size_t>(body.mesh().num_elements()));
  for (int a = 0; a < kCorners; ++a) {
    const Vec3 corner = second.rotation_map[a] * second.rest_shape.row(a).transpose();
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(read["isolated_shapes"][1][a][d].get<double>(), corner[d], 1e-15);
  }
  EXPECT_EQ(read["volume_ratio"].get<std::vector<double>>(), fields.volume_ratio);
  EXPECT_TRUE(read["yield_stress"][0].is_null());  // infinite
  EXPECT_EQ(read["yield_stress"][1].get<double>(), fields.yield_stress[1]);
  EXPECT_EQ(read["removed"], nlohmann::json::array());
  EXPECT_EQ(read["state_hash"].get<std::string>(), output::state_hash(42, x, v, &body));
}

TEST(StateHash, FeelsEveryPartOfTheState) {
  Body body = yielding_block();
  const PointArray x = stretched(body.mesh().positions(), 0.2), v = some_velocities(body);
  PointArray other = x;
  other(7, 2) = std::nextafter(other(7, 2), 1);
  const std::string hash = output::state_hash(3, x, v, &body);
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash, output::state_hash(3, x, v, &body));
  EXPECT_NE(hash, output::state_hash(4, x, v, &body));
  EXPECT_NE(hash, output::state_hash(3, other, v, &body));
  EXPECT_NE(hash, output::state_hash(3, x, other, &body));
  EXPECT_NE(hash, output::state_hash(3, x, v, nullptr));
  body.linearize(x);
  body.flow(x, 0.01);
  EXPECT_NE(hash, output::state_hash(3, x, v, &body));
}

TEST(Summary, MeasuresAStretchedBox) {
  const Body body(block({2, 1, 4}, 0.1), {Material{}});
  const Mat3 A = Vec3(0.9, 0.8, 1.5).asDiagonal();
  const PointArray x = mapped(body.mesh().positions(), A);
  const output::Summary summary = output::summarise(body, x);
  EXPECT_NEAR(summary.current_elongation, 0.5, 1e-12);
  EXPECT_NEAR(summary.current_volume_ratio, 0.9 * 0.8 * 1.5, 1e-12);
  EXPECT_NEAR(summary.current_twist_deg, 0, 1e-9);
  EXPECT_NEAR(summary.plastic_elongation, 0, 1e-14);
  EXPECT_NEAR(summary.plastic_rest_volume_ratio, 1, 1e-14);
  EXPECT_NEAR(summary.worst_element_volume_error, 0, 1e-14);
  EXPECT_NEAR(summary.strain.value, 0.5, 1e-12);
  const Vec3 centre = gather(x, body.mesh().hexahedra()[summary.strain.hexahedron]).colwise().mean().transpose();
  EXPECT_EQ(summary.strain.place, centre);
  EXPECT_EQ(summary.plastic_strain.value, 0);
  EXPECT_EQ(summary.num_pieces, 1);
}

// Four cubes in a row, of which the second is drawn out most and the last second most; then the second goes.
TEST(Summary, LargestPlasticStrainIsOfWhatIsLeft) {
  Body body(block({4, 1, 1}, 0.1), {{.young_modulus = 1000, .yield_stress = 10, .flow_rate = 5}});
  PointArray x = body.mesh().positions();
  const std::array<double, 5> place{0, 0.1, 0.26, 0.37, 0.5};  // [m] of the planes between the cubes
  for (Eigen::Index n = 0; n < x.rows(); ++n) x(n, 0) = place[static_cast<std::size_t>(std::lround(x(n, 0) / 0.1))];
  body.linearize(x);
  body.flow(x, 0.01);
  const std::vector<double> strain = body.fields(x).plastic_strain;
  const output::Summary whole = output::summarise(body, x);
  EXPECT_EQ(whole.plastic_strain.hexahedron, 1);
  EXPECT_EQ(whole.plastic_strain.value, strain[1]);
  EXPECT_EQ(whole.num_pieces, 1);

  const int second = 1;
  body.remove({&second, 1});
  ASSERT_EQ(body.fields(x).plastic_strain[1], strain[1]) << "what has gone keeps its strain";
  const output::Summary torn = output::summarise(body, x);
  EXPECT_EQ(torn.plastic_strain.hexahedron, 3);
  EXPECT_EQ(torn.plastic_strain.value, strain[3]);
  EXPECT_NEAR(torn.plastic_strain.place.x(), 0.435, 1e-12);
  EXPECT_NEAR(torn.plastic_strain.place.y(), 0.05, 1e-12);
  EXPECT_EQ(torn.num_pieces, 2);
}

TEST(Ticks, AreRoundAndInside) {
  const output::Ticks within = output::ticks_within(0, 0.4078, 5);
  ASSERT_EQ(within.values.size(), 5u);
  EXPECT_EQ(within.label(within.values[3]), "0.3");
  EXPECT_EQ(within.label(within.values[0]), "0");
  const output::Ticks around = output::ticks_around(-0.031, 0.17, 5);
  EXPECT_NEAR(around.min, -0.05, 1e-15);
  EXPECT_NEAR(around.max, 0.2, 1e-15);
  EXPECT_EQ(around.label(around.values.back()), "0.20");
  EXPECT_EQ(output::ticks_within(0, 3e-7, 3).label(2e-7), "2e-07");
}

/// Everything that a run writes, by file names.
std::map<std::string, std::string> written_by_a_run(const fs::path& directory) {
  const Body body = yielding_block();
  const PointArray x = stretched(body.mesh().positions(), 0.1), v = some_velocities(body);
  output::Recorder recorder(directory, body, plan(4, 2));
  recorder.record({}, x, v);
  for (long step = 1; step <= 4; ++step)
    recorder.record({.step = 1000 * step,
                     .time = 0.0125 * static_cast<double>(step),
                     .kinetic_energy = 1234.5,
                     .solver_iterations = 7,
                     .residual = 1e-6 / 3,
                     .step_ms = 1234.5},
                    x, v);
  recorder.finish();
  support::write_final(directory / "final.json", 4000, 0.05, x, v, body);
  return files_in(directory);
}

TEST(Locale, OfTheHostChangesNoByteOfWhatARunWrites) {
  const Scratch scratch;
  const auto expected = written_by_a_run(scratch / "plain");
  ASSERT_GE(expected.size(), 4u);
  EXPECT_TRUE(has(expected.at("history.csv"), "1234.5"));
  EXPECT_TRUE(has(expected.at("history.csv"), "\n4000,0.05,"));

  std::map<std::string, std::string> found;
  bool is_made = false;
  {
    const GermanLocale german;
    is_made = german.is_made();
    char number[16];
    std::snprintf(number, sizeof number, "%.1f", 1.5);
    EXPECT_STREQ(number, is_made ? "1,5" : "1.5");
    std::ostringstream stream;
    stream << 1234.5;
    EXPECT_EQ(stream.str(), "1.234,5");
    found = written_by_a_run(scratch / "german");
  }
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == bytes) << name << " differs";
  }
  EXPECT_EQ(found.size(), expected.size());
  if (!is_made) GTEST_SKIP() << "only C++ streams were tried: localedef has no de_DE here";
}

}  // namespace
}  // namespace hexaplast
