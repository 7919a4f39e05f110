// SPDX-License-Identifier: LGPL-2.1-or-later
// The meshes of a run, and what belongs to them: an independent reader sees what was written.
#include <cstring>
#include <numeric>

#include "hexaplast/base/error.hpp"
#include "record/instruments_vtu.hpp"
#include "record/surface_vtu.hpp"
#include "support/vtu_reader.hpp"

namespace hexaplast {
namespace {

using output::Recorder;
using output::RunPlan;
using support::bytes_of;
using support::content;
using support::names_in;
using support::plan;
using support::read_with_meshio;
using support::Scratch;
using support::series_in;

TEST(MeshFile, ComesBackBitForBitInAnIndependentReader) {
  const Scratch scratch;
  Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(5, 5));
  const PointArray x = support::record_stretch(recorder, body, 5);
  const auto read = read_with_meshio(
      scratch, scratch / "run/mesh_000005.vtu",
      {"points", "cells", "displacement", "plastic_rest_position", "velocity", "stress_norm", "plastic_strain",
       "yield_stress", "volume_ratio", "strain", "id", "part", "fixed", "load", "kinds"});
  ASSERT_EQ(read.size(), 15u);
  EXPECT_EQ(read.at("kinds"), "hexahedron");
  EXPECT_EQ(read.at("fixed"), bytes_of(support::some_conditions(body).fixed));
  EXPECT_EQ(read.at("load"), bytes_of(support::some_conditions(body).loads));
  const PointArray displacement = x - body.mesh().positions();
  const ElementFields fields = body.fields(x);
  EXPECT_EQ(read.at("points"), bytes_of(x));
  EXPECT_EQ(read.at("cells"), std::string(reinterpret_cast<const char*>(body.mesh().hexahedra().data()),
                                          sizeof(Hexahedron) * body.mesh().hexahedra().size()));
  EXPECT_EQ(read.at("displacement"), bytes_of(displacement));
  EXPECT_EQ(read.at("plastic_rest_position"), bytes_of(body.plastic_rest_positions()));
  EXPECT_EQ(read.at("velocity"), bytes_of(support::some_velocities(body)));
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
  Body body(support::block({1, 2, 6}, 0.1),
            {Material{.yield_stress = 10, .flow_rate = 90, .hardening = 0.5, .fracture_stress = 200}});
  Recorder recorder(scratch / "run", body, plan(1, 1));
  PointArray x = body.mesh().positions();
  for (Eigen::Index n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 0.35) x(n, 2) += 0.08;  // only the fourth layer of hexahedra is stretched
  body.linearize(x);
  const FlowReport report = body.flow(x, 0.01);
  const std::size_t removed = body.removed().size();
  ASSERT_GT(removed, 0u);
  ASSERT_LT(removed, 12u);
  recorder.record({.step = 1, .time = 0.01, .flow = report}, x, support::some_velocities(body));

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
  const support::Csv history(content(scratch / "run/history.csv"));
  EXPECT_EQ(history.numbers("removed").back(), static_cast<double>(removed));
}

TEST(TimeSeries, NamesTheFirstTheRegularAndTheLastState) {
  const Scratch scratch;
  Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(10, 4));
  support::record_stretch(recorder, body, 10);
  recorder.finish();
  std::vector<std::string> expected{"history.csv",     "mesh.pvd",        "mesh_000000.vtu", "mesh_000004.vtu",
                                    "mesh_000008.vtu", "mesh_000010.vtu", "removed.csv",     "viewer.json"};
  EXPECT_EQ(names_in(scratch / "run"), expected);
  const auto series = series_in(scratch / "run");
  ASSERT_EQ(series.size(), 4u);
  EXPECT_EQ(series[1].first, 0.04);
  EXPECT_EQ(series[3].second.filename(), "mesh_000010.vtu");
}

TEST(TimeSeries, OfARunThatEndedEarlyHasItsLastState) {
  const Scratch scratch;
  Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(500, 4));
  support::record_stretch(recorder, body, 6);
  EXPECT_EQ(series_in(scratch / "run").size(), 2u);
  recorder.finish();
  const auto series = series_in(scratch / "run");
  ASSERT_EQ(series.size(), 3u);
  EXPECT_EQ(series.back().second.filename(), "mesh_000006.vtu");
}

/// Two embedded surfaces in the block of 2 x 3 x 5 hexahedra: a quad and a triangle, and a triangle that reaches out of
/// it.
std::vector<output::EmbeddedSurface> two_surfaces() {
  std::vector<output::EmbeddedSurface> embedded_surfaces(2);
  embedded_surfaces[0].points.resize(5, 3);
  embedded_surfaces[0].points << .02, .03, .05, .02, .27, .05, .17, .27, .31, .17, .03, .31, .1, .1, .47;
  embedded_surfaces[0].quads = {{0, 1, 2, 3}};
  embedded_surfaces[0].triangles = {{3, 2, 4}};
  embedded_surfaces[1].points.resize(3, 3);
  embedded_surfaces[1].points << .11, .12, .21, .11, .19, .55, .3, .12, .3;
  embedded_surfaces[1].triangles = {{0, 1, 2}};
  return embedded_surfaces;
}

TEST(Companions, AreSeriesOfTheSameTimes) {
  const Scratch scratch;
  Body body = support::yielding_block();
  RunPlan run = plan(10, 4);
  run.staging.embedded_surfaces = two_surfaces();
  run.has_instruments = true;
  run.has_springs = true;
  Recorder recorder(scratch / "run", body, run);
  support::record_stretch(recorder, body, 10);
  recorder.finish();
  const auto meshes = series_in(scratch / "run");
  for (const std::string kind : {"surface", "instruments", "springs"}) {
    const auto series = series_in(scratch / "run", kind + ".pvd");
    ASSERT_EQ(series.size(), meshes.size());
    for (std::size_t k = 0; k < series.size(); ++k) {
      EXPECT_EQ(series[k].first, meshes[k].first);
      EXPECT_EQ(series[k].second.filename().string(), kind + meshes[k].second.filename().string().substr(4));
    }
  }
}

TEST(SurfaceFile, ShowsWhereTheHexahedraCarryIt) {
  const Scratch scratch;
  Body body = support::yielding_block();
  RunPlan run = plan(5, 5);
  const std::vector<output::EmbeddedSurface> embedded_surfaces = two_surfaces();
  run.staging.embedded_surfaces = embedded_surfaces;
  Recorder recorder(scratch / "run", body, run);
  support::record_stretch(recorder, body, 5);
  const auto read = read_with_meshio(scratch, scratch / "run/surface_000005.vtu",
                                     {"points", "kinds", "displacement", "surface", "plastic_strain"});
  // the body is mapped by one matrix, and so is what it carries
  const PointArray unmoved = body.mesh().positions(), moved = support::stretched(body, 0.1);
  const Eigen::MatrixXd affine = (Eigen::MatrixXd(unmoved.rows(), 4) << unmoved, Eigen::VectorXd::Ones(unmoved.rows()))
                                     .finished()
                                     .colPivHouseholderQr()
                                     .solve(moved);
  PointArray X(8, 3);
  X << embedded_surfaces[0].points, embedded_surfaces[1].points;
  const PointArray x = (Eigen::MatrixXd(8, 4) << X, Eigen::VectorXd::Ones(8)).finished() * affine;
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
  const std::vector<double> strain = body.fields(moved).plastic_strain;
  std::vector<double> shown(8);
  std::memcpy(shown.data(), read.at("plastic_strain").data(), 8 * sizeof(double));
  EXPECT_GE(std::ranges::min(shown), std::ranges::min(strain));
  EXPECT_LE(std::ranges::max(shown), std::ranges::max(strain));
  EXPECT_GT(std::ranges::max(shown), std::ranges::min(shown));

  // and what was put in comes out again, from the state at rest with all its bits
  const std::vector<output::EmbeddedSurface> back = output::read_embedded_surfaces(scratch / "run/surface_000000.vtu");
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_LT((back[s].points - embedded_surfaces[s].points).cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_EQ(back[s].triangles, embedded_surfaces[s].triangles);
    EXPECT_EQ(back[s].quads, embedded_surfaces[s].quads);
  }
}

TEST(SurfaceFile, LosesFacesWithTheirHexahedra) {
  const Scratch scratch;
  const HexMesh mesh = support::distorted_block({2, 3, 5}, 0.1, 0.12, 11);
  const std::vector<output::EmbeddedSurface> embedded_surfaces = two_surfaces();
  const output::CarriedSurfaces carried(mesh, embedded_surfaces);
  const std::vector<double> strains(mesh.num_nodes(), 0.1);
  std::vector<unsigned char> alive(mesh.num_elements(), 1);
  const Embedding embedding(mesh.positions(), mesh.hexahedra(), embedded_surfaces[0].points);
  alive[embedding.hexahedron_of(4)] = 0;  // only the triangle of the first embedded surface has this corner
  carried.write(scratch / "torn.vtu", mesh.positions(), strains, alive);
  EXPECT_EQ(read_with_meshio(scratch, scratch / "torn.vtu", {"kinds"}).at("kinds"), "quad triangle");
}

TEST(InstrumentFile, HasTheToolAndWhatItHolds) {
  const Scratch scratch;
  Body body = support::yielding_block();
  RunPlan run = plan(2, 1);
  run.has_instruments = true;
  Recorder recorder(scratch / "run", body, run);
  const PointArray x = support::record_stretch(recorder, body, 2);
  const output::Instrument instrument = support::some_conditions(body).instruments[0];
  const auto read =
      read_with_meshio(scratch, scratch / "run/instruments_000002.vtu", {"points", "kinds", "id", "node", "force"});
  PointArray points(3, 3), forces(3, 3);
  points << instrument.place.transpose(), x.row(4), x.row(9);
  forces << instrument.forces.row(0) + instrument.forces.row(1), instrument.forces;
  EXPECT_EQ(read.at("points"), bytes_of(points));
  EXPECT_EQ(read.at("kinds"), "vertex line");
  EXPECT_EQ(read.at("id"), bytes_of(std::vector<std::int32_t>{1, 1, 1}));
  EXPECT_EQ(read.at("node"), bytes_of(std::vector<std::int32_t>{-1, 4, 9}));
  EXPECT_EQ(read.at("force"), bytes_of(forces));

  // nothing is held: a file without points
  recorder.record({.step = 3, .time = 0.03}, x, support::some_velocities(body));
  EXPECT_TRUE(output::read_instruments(scratch / "run/instruments_000003.vtu").empty());
  const std::vector<output::Instrument> back = output::read_instruments(scratch / "run/instruments_000002.vtu");
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].nodes, instrument.nodes);
  EXPECT_EQ(back[0].forces, instrument.forces);
  EXPECT_EQ(back[0].place, instrument.place);
}

TEST(InstrumentFile, HasTheSurfaceOfTheTool) {
  const Scratch scratch;
  Body body = support::yielding_block();
  std::vector<output::Instrument> instruments(2, support::some_conditions(body).instruments[0]);
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
  Body body = support::yielding_block();
  output::Instrument instrument = support::some_conditions(body).instruments[0];
  output::write_instruments(scratch / "good.vtu", {&instrument, 1}, body.mesh().positions());
  const std::string good = content(scratch / "good.vtu");
  const auto refusal = [&](const std::string& text) -> std::string {
    support::put(scratch / "bad.vtu", text);
    try {
      output::read_instruments(scratch / "bad.vtu");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(good), "");
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_NE(refusal(replaced("Name=\"node\"", "Name=\"nodo\"")).find("holds no array 'node' of points"),
            std::string::npos);
  // -1, 4, 9: the tool becomes a node
  const std::string numbers("\xff\xff\xff\xff\x04\0\0\0\x09\0\0\0", 12), stray("\x02\0\0\0\x04\0\0\0\x09\0\0\0", 12);
  EXPECT_NE(refusal(replaced(numbers, stray)).find("point 0 is neither a tool, nor held"), std::string::npos);
  EXPECT_NE(refusal(good.substr(0, good.size() / 2)), "");
}

}  // namespace
}  // namespace hexaplast
