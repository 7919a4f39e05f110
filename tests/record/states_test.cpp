// SPDX-License-Identifier: LGPL-2.1-or-later
// The meshes of a run, and what belongs to them: an independent reader sees what was written.
#include <cstring>
#include <numeric>

#include "hexaplast/base/error.hpp"
#include "record/conditions_vtu.hpp"
#include "record/recorded_run.hpp"
#include "record/surface_vtu.hpp"
#include "support/compare.hpp"
#include "support/vtu_reader.hpp"

namespace hexaplast {
namespace {

using namespace support;

using output::Recorder;
using output::RunPlan;

TEST(MeshFile, ComesBackBitForBitInAnIndependentReader) {
  const Recorded run(plan(5, 5), 5);
  const Body& body = run.body;
  const PointArray& x = run.x;
  const auto read = read_with_meshio(
      run.scratch, run.scratch / "run/mesh_000005.vtu",
      {"points", "cells", "displacement", "plastic_rest_position", "velocity", "stress_norm", "plastic_strain",
       "yield_stress", "volume_ratio", "strain", "id", "part", "fixed", "load", "kinds"});
  ASSERT_EQ(read.size(), 15u);
  EXPECT_EQ(read.at("kinds"), "hexahedron");
  EXPECT_EQ(read.at("fixed"), bytes_of(some_conditions(body).fixed));
  EXPECT_EQ(read.at("load"), bytes_of(some_conditions(body).loads));
  const PointArray displacement = x - body.mesh().positions();
  const ElementFields fields = body.fields(x);
  EXPECT_EQ(read.at("points"), bytes_of(x));
  EXPECT_EQ(read.at("cells"), std::string(reinterpret_cast<const char*>(body.mesh().hexahedra().data()),
                                          sizeof(Hexahedron) * body.mesh().hexahedra().size()));
  EXPECT_EQ(read.at("displacement"), bytes_of(displacement));
  EXPECT_EQ(read.at("plastic_rest_position"), bytes_of(body.plastic_rest_positions()));
  EXPECT_EQ(read.at("velocity"), bytes_of(some_velocities(body)));
  EXPECT_EQ(read.at("stress_norm"), bytes_of(fields.stress_norm));
  EXPECT_EQ(read.at("plastic_strain"), bytes_of(fields.plastic_strain));
  EXPECT_EQ(read.at("yield_stress"), bytes_of(fields.yield_stress));
  EXPECT_TRUE(std::isinf(fields.yield_stress.front()));  // infinite values pass
  EXPECT_EQ(read.at("volume_ratio"), bytes_of(fields.volume_ratio));
  EXPECT_EQ(read.at("strain"), bytes_of(fields.strain));
  std::vector<std::int32_t> ids(body.mesh().num_elements());
  std::iota(ids.begin(), ids.end(), 0);
  EXPECT_EQ(read.at("id"), bytes_of(ids));
  EXPECT_EQ(read.at("part"), bytes_of(std::vector<std::int32_t>(ids.size(), 0)));
}

TEST(MeshFile, LeavesRemovedHexahedraOut) {
  const Scratch scratch;
  TornPillar pillar;
  const Body& body = pillar.body;
  Recorder recorder(scratch / "run", body, plan(1, 1));
  pillar.tear();
  const std::size_t removed = body.removed().size();
  recorder.record({.step = 1, .time = 0.01, .flow = pillar.report}, pillar.x, some_velocities(body));

  // the layers below and above are left, in two pieces; what is left keeps its number
  std::vector<Hexahedron> left;
  std::vector<std::int32_t> ids, parts;
  for (int e = 0; e < 12; ++e) {
    if (!body.alive()[e]) continue;
    left.push_back(body.mesh().hexahedra()[e]);
    ids.push_back(e);
    parts.push_back(e < 6 ? 0 : 1);
  }
  ASSERT_EQ(ids.size(), 12 - removed);
  const auto read =
      read_with_meshio(scratch, scratch / "run/mesh_000001.vtu", {"cells", "strain", "id", "part", "kinds"});
  EXPECT_EQ(read.at("kinds"), "hexahedron");
  EXPECT_EQ(read.at("cells"), bytes_of(left));
  EXPECT_EQ(read.at("strain").size(), (12 - removed) * sizeof(double));
  EXPECT_EQ(read.at("id"), bytes_of(ids));
  EXPECT_EQ(read.at("part"), bytes_of(parts));
  const Csv history(content(scratch / "run/history.csv"));
  EXPECT_EQ(history.numbers("removed").back(), static_cast<double>(removed));
}

TEST(TimeSeries, NamesTheFirstTheRegularAndTheLastState) {
  Recorded run(plan(10, 4), 10);
  run.recorder.finish();
  std::vector<std::string> expected{"history.csv",     "mesh.pvd",        "mesh_000000.vtu", "mesh_000004.vtu",
                                    "mesh_000008.vtu", "mesh_000010.vtu", "removed.csv",     "viewer.json"};
  EXPECT_EQ(names_in(run.scratch / "run"), expected);
  const auto series = series_in(run.scratch / "run");
  ASSERT_EQ(series.size(), 4u);
  EXPECT_EQ(series[1].first, 0.04);
  EXPECT_EQ(series[3].second.filename(), "mesh_000010.vtu");
}

TEST(TimeSeries, OfARunThatEndedEarlyHasItsLastState) {
  Recorded run(plan(500, 4), 6);
  EXPECT_EQ(series_in(run.scratch / "run").size(), 2u);
  run.recorder.finish();
  EXPECT_EQ(series_in(run.scratch / "run").back().second.filename(), "mesh_000006.vtu");
}

TEST(RecordedRun, RefusesRegionsThatHaveNoName) {
  RunPlan named = plan(5, 5);
  named.staging.regions.of_hexahedra.assign(static_cast<std::size_t>(yielding_block().mesh().num_elements()), 1);
  named.staging.regions.names = {"wall"};
  const Recorded good(named, 5);
  EXPECT_EQ(output::RecordedRun(good.scratch / "run").regions().names, std::vector<std::string>{"wall"});
  named.staging.regions.of_hexahedra.back() = 2;
  const Recorded bad(named, 5);
  EXPECT_THROW(output::RecordedRun(bad.scratch / "run"), InputError);
}

TEST(Companions, AreSeriesOfTheSameTimes) {
  RunPlan with_all = plan(10, 4);
  with_all.staging.embedded_surfaces = two_surfaces();
  with_all.has_instruments = with_all.has_springs = true;
  Recorded run(with_all, 10);
  run.recorder.finish();
  const auto meshes = series_in(run.scratch / "run");
  for (const std::string kind : {"surface", "instruments", "springs"}) {
    const auto series = series_in(run.scratch / "run", kind + ".pvd");
    ASSERT_EQ(series.size(), meshes.size());
    for (std::size_t k = 0; k < series.size(); ++k) {
      EXPECT_EQ(series[k].first, meshes[k].first);
      EXPECT_EQ(series[k].second.filename().string(), kind + meshes[k].second.filename().string().substr(4));
    }
  }
}

TEST(SurfaceFile, ShowsWhereTheHexahedraCarryIt) {
  const std::vector<output::EmbeddedSurface> embedded_surfaces = two_surfaces();
  RunPlan with_surfaces = plan(5, 5);
  with_surfaces.staging.embedded_surfaces = embedded_surfaces;
  const Recorded run(with_surfaces, 5);
  const auto read = read_with_meshio(run.scratch, run.scratch / "run/surface_000005.vtu",
                                     {"points", "kinds", "displacement", "surface", "plastic_strain"});
  PointArray X(8, 3);
  X << embedded_surfaces[0].points, embedded_surfaces[1].points;
  const PointArray x = stretched(X, 0.1);  // as the whole body
  const auto numbers = [&](const char* name) {
    PointArray points(8, 3);
    EXPECT_EQ(read.at(name).size(), sizeof(double) * 24);
    std::memcpy(points.data(), read.at(name).data(), read.at(name).size());
    return points;
  };
  EXPECT_LT((numbers("points") - x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((numbers("displacement") - (x - X)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(read.at("kinds"), "triangle quad triangle");
  EXPECT_EQ(read.at("surface"), bytes_of(std::vector<std::int32_t>{0, 0, 0, 0, 0, 1, 1, 1}));

  // every value lies within those of the hexahedra
  const std::vector<double> strain = run.body.fields(run.x).plastic_strain;
  std::vector<double> shown(8);
  std::memcpy(shown.data(), read.at("plastic_strain").data(), 8 * sizeof(double));
  EXPECT_GE(std::ranges::min(shown), std::ranges::min(strain));
  EXPECT_LE(std::ranges::max(shown), std::ranges::max(strain));
  EXPECT_GT(std::ranges::max(shown), std::ranges::min(shown));

  // and what was put in comes out again, from the state at rest with all its bits
  const std::vector<output::EmbeddedSurface> back =
      output::read_embedded_surfaces(run.scratch / "run/surface_000000.vtu");
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_LT((back[s].points - embedded_surfaces[s].points).cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_EQ(back[s].triangles, embedded_surfaces[s].triangles);
    EXPECT_EQ(back[s].quads, embedded_surfaces[s].quads);
  }
}

TEST(SurfaceFile, LosesFacesWithTheirHexahedra) {
  const Scratch scratch;
  const HexMesh mesh = distorted_block({2, 3, 5}, 0.1, 0.12, 11);
  const std::vector<output::EmbeddedSurface> embedded_surfaces = two_surfaces();
  output::CarriedSurfaces carried(mesh, embedded_surfaces);
  const std::vector<double> strains(mesh.num_nodes(), 0.1);
  std::vector<unsigned char> alive(mesh.num_elements(), 1);
  const Embedding embedding(mesh.positions(), mesh.hexahedra(), embedded_surfaces[0].points);
  alive[embedding.hexahedron_of(4)] = 0;  // only the triangle of the first embedded surface has this corner
  carried.write(scratch / "torn.vtu", mesh, mesh.positions(), strains, alive);
  EXPECT_EQ(read_with_meshio(scratch, scratch / "torn.vtu", {"kinds"}).at("kinds"), "quad triangle");
}

TEST(InstrumentFile, HasTheToolAndWhatItHolds) {
  RunPlan with_instruments = plan(2, 1);
  with_instruments.has_instruments = true;
  Recorded run(with_instruments, 2);
  const fs::path file = run.scratch / "run/instruments_000002.vtu";
  const output::Instrument instrument = some_conditions(run.body).instruments[0];
  const auto read = read_with_meshio(run.scratch, file, {"points", "kinds", "id", "node", "force"});
  PointArray points(3, 3), forces(3, 3);
  points << instrument.place.transpose(), run.x.row(4), run.x.row(9);
  forces << instrument.forces.row(0) + instrument.forces.row(1), instrument.forces;
  EXPECT_EQ(read.at("points"), bytes_of(points));
  EXPECT_EQ(read.at("kinds"), "vertex line");
  EXPECT_EQ(read.at("id"), bytes_of(std::vector<std::int32_t>{1, 1, 1}));
  EXPECT_EQ(read.at("node"), bytes_of(std::vector<std::int32_t>{-1, 4, 9}));
  EXPECT_EQ(read.at("force"), bytes_of(forces));

  // nothing is held: a file without points
  run.recorder.record({.step = 3, .time = 0.03}, run.x, some_velocities(run.body));
  EXPECT_TRUE(output::read_instruments(run.scratch / "run/instruments_000003.vtu").empty());
  const std::vector<output::Instrument> back = output::read_instruments(file);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].nodes, instrument.nodes);
  EXPECT_EQ(back[0].forces, instrument.forces);
  EXPECT_EQ(back[0].place, instrument.place);
}

TEST(InstrumentFile, HasTheSurfaceOfTheTool) {
  const Scratch scratch;
  Body body = yielding_block();
  std::vector<output::Instrument> instruments(2, some_conditions(body).instruments[0]);
  for (int k = 0; k < 2; ++k) {
    instruments[k].id = k;
    instruments[k].shape_points = PointArray::Random(4 + k, 3);
    instruments[k].shape_triangles = {{0, 1, 2}, {3 + k, 1, 0}};
  }
  output::write_instruments(scratch / "shapes.vtu", instruments, body.mesh().positions());
  EXPECT_EQ(read_with_meshio(scratch, scratch / "shapes.vtu", {"kinds"}).at("kinds"),
            "vertex line triangle vertex line triangle");
  const std::vector<output::Instrument> back = output::read_instruments(scratch / "shapes.vtu");
  ASSERT_EQ(back.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(back[k].nodes, instruments[k].nodes);
    EXPECT_EQ(back[k].shape_points, instruments[k].shape_points);
    EXPECT_EQ(back[k].shape_triangles, instruments[k].shape_triangles);
  }
}

TEST(InstrumentFile, IsRefusedWhereItMakesNoSense) {
  const Scratch scratch;
  Body body = yielding_block();
  output::Instrument instrument = some_conditions(body).instruments[0];
  output::write_instruments(scratch / "good.vtu", {&instrument, 1}, body.mesh().positions());
  const std::string good = content(scratch / "good.vtu");
  const auto refusal = [&](const std::string& text) {
    put(scratch / "bad.vtu", text);
    return error_of<InputError>([&] { output::read_instruments(scratch / "bad.vtu"); });
  };
  EXPECT_EQ(refusal(good), "");
  EXPECT_TRUE(has(refusal(replaced(good, "Name=\"node\"", "Name=\"nodo\"")), "holds no array 'node' of points"));
  // -1, 4, 9: the tool becomes a node
  const std::string numbers("\xff\xff\xff\xff\x04\0\0\0\x09\0\0\0", 12), stray("\x02\0\0\0\x04\0\0\0\x09\0\0\0", 12);
  EXPECT_TRUE(has(refusal(replaced(good, numbers, stray)), "point 0 is neither a tool, nor held"));
  EXPECT_NE(refusal(good.substr(0, good.size() / 2)), "");
}

}  // namespace
}  // namespace hexaplast
