// SPDX-License-Identifier: LGPL-2.1-or-later
// The files of a run: what is written can be read back by others, and survives what goes wrong.
#include <spawn.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <tinyxml2.h>

#include <csignal>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "hexaplast/base/error.hpp"
#include "output/axis.hpp"
#include "output/instruments_vtu.hpp"
#include "output/surface_vtu.hpp"
#include "output_support.hpp"

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using output::OutputError;
using output::Recorder;
using output::RunPlan;
using output::WholeFile;
using support::content;
using support::rows_of;
using support::Scratch;

constexpr const char* kHeader =
    "step,time,kinetic_energy,elastic_energy,dissipated_energy,world_volume_ratio,material_volume_ratio,"
    "plastic_elongation,plastic_twist_deg,end_displacement,yielded,inverted,removed,solver_iterations,residual,step_ms,"
    "world_elongation,world_twist_deg";

RunPlan plan(long steps, int every) {
  return {.title = "test",
          .num_steps = steps,
          .dt = 0.01,
          .output_every = every,
          .num_frames = 0,
          .force = false,
          .loaded_nodes = {}};
}

/// The arrays of a .vtu file as meshio, an independent reader, sees them.
std::map<std::string, std::string> read_with_meshio(const Scratch& scratch, const fs::path& file,
                                                    std::vector<std::string> names) {
  const std::string dump = (scratch / "dump").string();
  std::vector<std::string> words{"/usr/bin/python3", HEXAPLAST_TEST_DATA "/output/dump_vtu.py", file.string(), dump};
  words.insert(words.end(), names.begin(), names.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  pid_t child = 0;
  int status = -1;
  if (::posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) return {};
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << "meshio cannot read " << file;

  std::map<std::string, std::string> arrays;
  std::ifstream in(dump, std::ios::binary);
  std::string name;
  for (std::size_t bytes = 0; in >> name >> bytes;) {
    in.get();
    arrays[name].resize(bytes);
    in.read(arrays[name].data(), static_cast<std::streamsize>(bytes));
  }
  return arrays;
}

template <class Numbers>
std::string bytes_of(const Numbers& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), sizeof(numbers.data()[0]) * numbers.size()};
}

/// Files that a .pvd file names, and their times; every one must be there.
std::vector<std::pair<double, fs::path>> series_in(const fs::path& directory, const std::string& name = "mesh.pvd") {
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.LoadFile((directory / name).c_str()), tinyxml2::XML_SUCCESS);
  std::vector<std::pair<double, fs::path>> found;
  const tinyxml2::XMLElement* entry =
      document.RootElement()->FirstChildElement("Collection")->FirstChildElement("DataSet");
  for (; entry; entry = entry->NextSiblingElement("DataSet")) {
    found.emplace_back(entry->DoubleAttribute("timestep"), directory / entry->Attribute("file"));
    EXPECT_TRUE(content(found.back().second).ends_with("</VTKFile>\n")) << found.back().second;
  }
  return found;
}

std::vector<std::string> names_in(const fs::path& directory) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory))
    names.push_back(entry.path().lexically_relative(directory).string());
  std::ranges::sort(names);
  return names;
}

TEST(WholeFile, ReplacesFilesAloneAndFollowsLinks) {
  const Scratch scratch;
  const std::filesystem::path pipe = scratch / "pipe", file = scratch / "file", link = scratch / "link";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(WholeFile{pipe}, OutputError);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_THROW(WholeFile{scratch / "."}, OutputError);

  std::ofstream(file) << "before";
  std::filesystem::create_symlink(file, link);
  WholeFile out(link);
  out.write("after");
  EXPECT_EQ(content(file), "before");
  out.commit();
  EXPECT_EQ(content(file), "after");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST(HistoryTable, HasOneRowPerStepWithTheBodysNumbersToTheLastBit) {
  const Scratch scratch;
  Body body = support::yielding_block();
  RunPlan run = plan(6, 100);
  run.loaded_nodes = {3, 17};
  Recorder recorder(scratch / "run", body, run);
  const PointArray x = support::record_stretch(recorder, body, 6);

  std::string header;
  const auto rows =
      rows_of(scratch / "run/history.csv", header);  // complete before finish(): a killed run keeps its rows
  EXPECT_EQ(header, kHeader);
  ASSERT_EQ(rows.size(), 7u);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(rows[k].size(), 18u);
    EXPECT_EQ(rows[k][0], static_cast<double>(k));
  }

  const PointArray& X = body.mesh().positions();
  const std::vector<double>& last = rows.back();
  const output::Summary summary = output::summarise(body, x);
  EXPECT_EQ(last[1], 6 * 0.01);
  EXPECT_EQ(last[2], 0.1 / 3);
  EXPECT_EQ(last[3], body.energy(x));
  EXPECT_EQ(last[4], body.history().dissipated_energy);
  EXPECT_EQ(last[5], body.volume(x) / body.original_volume());
  EXPECT_EQ(last[6], body.volume(body.history().material) / body.original_volume());
  EXPECT_EQ(last[7], summary.plastic_elongation);
  EXPECT_EQ(last[8], summary.plastic_twist_deg);
  EXPECT_EQ(last[9], ((x.row(3) - X.row(3)).norm() + (x.row(17) - X.row(17)).norm()) / 2);
  EXPECT_GT(last[10], 0);
  EXPECT_EQ(last[12], 0);
  EXPECT_EQ(last[13], 7);
  EXPECT_EQ(last[14], 1e-6 / 3);
  EXPECT_EQ(last[15], 0.125);
  EXPECT_EQ(last[16], summary.world_elongation);
  EXPECT_EQ(last[17], summary.world_twist_deg);
}

TEST(MeshFile, ComesBackBitForBitInAnIndependentReader) {
  const Scratch scratch;
  Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(5, 5));
  const PointArray x = support::record_stretch(recorder, body, 5);
  const auto read = read_with_meshio(
      scratch, scratch / "run/mesh_000005.vtu",
      {"points", "cells", "displacement", "material_position", "velocity", "stress_norm", "plastic_strain",
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
  EXPECT_EQ(read.at("material_position"), bytes_of(body.history().material));
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
  const std::size_t removed = body.history().removed.size();
  ASSERT_GT(removed, 0u);
  ASSERT_LT(removed, 12u);
  recorder.record({.step = 1, .time = 0.01, .flow = report}, x, support::some_velocities(body));

  // the layers below and above are left, in two pieces; what is left keeps its number
  std::vector<Hexahedron> left;
  std::vector<std::int32_t> ids, parts;
  for (int e = 0; e < 12; ++e) {
    if (!body.history().alive[e]) continue;
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
  std::string header;
  EXPECT_EQ(rows_of(scratch / "run/history.csv", header).back()[12], static_cast<double>(removed));
}

/// Bars of hexahedra that do not touch, each stretched to its own share in every step: they break one after another.
TEST(RemovedTable, SaysInWhichStepEachHexahedronWent) {
  const Scratch scratch;
  constexpr int kBars = 2000;
  const PointArray one = support::block({1, 1, 1}, 0.1).positions();
  PointArray X(8 * kBars, 3);
  std::vector<Hexahedron> hexahedra;
  for (int e = 0; e < kBars; ++e) {
    X.middleRows(8 * e, 8) = one.rowwise() + Eigen::RowVector3d(e, 0, 0);
    hexahedra.push_back(support::block({1, 1, 1}, 0.1).hexahedra()[0]);
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
    recorder.record({.step = step, .time = step / 100.0, .flow = report}, x, support::some_velocities(body));
    if (step < 3) {
      EXPECT_EQ(content(scratch / "run/removed.csv"), "step,time,hexahedron\n1,0.01,7\n1,0.01,1203\n");
    }
  }
  EXPECT_EQ(content(scratch / "run/removed.csv"), expected);  // complete before finish(): a killed run keeps its rows
  recorder.finish();

  // with nothing left, all that is written are numbers still
  EXPECT_EQ(body.history().removed.size(), std::size_t(kBars));
  std::string header;
  const std::vector<double> last = rows_of(scratch / "run/history.csv", header).back();
  ASSERT_EQ(last.size(), 18u);
  for (const double value : last) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(last[6], 0);
  EXPECT_EQ(last[12], kBars);
  EXPECT_EQ(content(scratch / "run/history.csv").find("nan"), std::string::npos);
  EXPECT_EQ(output::summarise(body, x).num_pieces, 0);
}

TEST(TimeSeries, NamesTheFirstTheRegularAndTheLastState) {
  const Scratch scratch;
  Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(10, 4));
  support::record_stretch(recorder, body, 10);
  recorder.finish();
  std::vector<std::string> expected{"history.csv",     "mesh.pvd",        "mesh_000000.vtu", "mesh_000004.vtu",
                                    "mesh_000008.vtu", "mesh_000010.vtu", "plot.svg",        "removed.csv"};
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

/// Two skins in the block of 2 x 3 x 5 hexahedra: a quad and a triangle, and a triangle that reaches out of it.
std::vector<output::Skin> two_skins() {
  std::vector<output::Skin> skins(2);
  skins[0].points.resize(5, 3);
  skins[0].points << .02, .03, .05, .02, .27, .05, .17, .27, .31, .17, .03, .31, .1, .1, .47;
  skins[0].quads = {{0, 1, 2, 3}};
  skins[0].triangles = {{3, 2, 4}};
  skins[1].points.resize(3, 3);
  skins[1].points << .11, .12, .21, .11, .19, .55, .3, .12, .3;
  skins[1].triangles = {{0, 1, 2}};
  return skins;
}

TEST(Companions, AreSeriesOfTheSameTimes) {
  const Scratch scratch;
  Body body = support::yielding_block();
  RunPlan run = plan(10, 4);
  run.staging.skins = two_skins();
  run.has_instruments = true;
  Recorder recorder(scratch / "run", body, run);
  support::record_stretch(recorder, body, 10);
  recorder.finish();
  const auto meshes = series_in(scratch / "run");
  for (const std::string kind : {"surface", "instruments"}) {
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
  const std::vector<output::Skin> skins = two_skins();
  run.staging.skins = skins;
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
  X << skins[0].points, skins[1].points;
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
  const std::vector<output::Skin> back = output::read_skins(scratch / "run/surface_000000.vtu");
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_LT((back[s].points - skins[s].points).cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_EQ(back[s].triangles, skins[s].triangles);
    EXPECT_EQ(back[s].quads, skins[s].quads);
  }
}

TEST(SurfaceFile, LosesFacesWithTheirHexahedra) {
  const Scratch scratch;
  const HexMesh mesh = support::distorted_block({2, 3, 5}, 0.1, 0.12, 11);
  const std::vector<output::Skin> skins = two_skins();
  const output::CarriedSkins carried(mesh, skins);
  const std::vector<double> strains(mesh.num_nodes(), 0.1);
  std::vector<unsigned char> alive(mesh.num_elements(), 1);
  const Embedding embedding(mesh.positions(), mesh.hexahedra(), skins[0].points);
  alive[embedding.hexahedron_of(4)] = 0;  // only the triangle of the first skin has this corner
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
  EXPECT_NE(refusal(replaced(numbers, stray)).find("point 0 is neither a tool nor held"), std::string::npos);
  EXPECT_NE(refusal(good.substr(0, good.size() / 2)), "");
}

TEST(FinalState, ComesBackWithAllItsBits) {
  const Scratch scratch;
  Body body = support::yielding_block();
  PointArray x = support::stretched(body, 0.2);
  const PointArray v = support::some_velocities(body);
  body.linearize(x);
  body.flow(x, 0.01);
  output::write_final(scratch / "final.json", 42, 0.1 + 0.2, x, v, body);

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
  expect_points("material_positions", body.history().material);
  const ElementHistory second = body.history().element(1);
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

TEST(FinalState, ThatCannotBeWrittenLeavesTheEarlierFile) {
  const Scratch scratch;
  const Body body = support::yielding_block();
  const PointArray x = body.mesh().positions();
  EXPECT_THROW(output::write_final(scratch / "nowhere/final.json", 0, 0, x, x, body), OutputError);
  fs::create_directory(scratch / "taken.json");
  EXPECT_THROW(output::write_final(scratch / "taken.json", 0, 0, x, x, body), OutputError);
  EXPECT_FALSE(fs::exists(scratch / "taken.json.part"));
}

TEST(StateHash, FeelsEveryPartOfTheState) {
  Body body = support::yielding_block();
  const PointArray x = support::stretched(body, 0.2), v = support::some_velocities(body);
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
  const Body body(support::block({2, 1, 4}, 0.1), {Material{}});
  const Mat3 A = Vec3(0.9, 0.8, 1.5).asDiagonal();
  const PointArray x = support::mapped(body.mesh().positions(), A);
  const output::Summary summary = output::summarise(body, x);
  EXPECT_NEAR(summary.world_elongation, 0.5, 1e-12);
  EXPECT_NEAR(summary.world_volume_ratio, 0.9 * 0.8 * 1.5, 1e-12);
  EXPECT_NEAR(summary.world_twist_deg, 0, 1e-9);
  EXPECT_NEAR(summary.plastic_elongation, 0, 1e-14);
  EXPECT_NEAR(summary.material_volume_ratio, 1, 1e-14);
  EXPECT_NEAR(summary.worst_element_volume_error, 0, 1e-14);
  EXPECT_NEAR(summary.largest_strain, 0.5, 1e-12);
  const Vec3 centre = gather(x, body.mesh().hexahedra()[summary.largest_strain_element]).colwise().mean().transpose();
  EXPECT_EQ(summary.largest_strain_place, centre);
}

TEST(PlotFile, IsWellFormedXmlWhateverTheTitle) {
  const Scratch scratch;
  Body body = support::yielding_block();
  RunPlan run = plan(6, 100);
  run.title = "pull & <hold> \"50 %\" \x01 {}";
  Recorder recorder(scratch / "run", body, run);
  support::record_stretch(recorder, body, 6);
  recorder.finish();
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.LoadFile((scratch / "run/plot.svg").c_str()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
  EXPECT_STREQ(document.RootElement()->Name(), "svg");
  const tinyxml2::XMLElement* title = document.RootElement()->FirstChildElement("text");
  ASSERT_TRUE(title);
  EXPECT_STREQ(title->GetText(), "pull & <hold> \"50 %\"  {}");
}

TEST(PlotFile, StaysSmallForLongRuns) {
  const Scratch scratch;
  const Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(5000, 100000));
  const PointArray x = body.mesh().positions();
  for (long step = 0; step <= 5000; ++step) recorder.record({.step = step, .time = 0.01 * step}, x, x);
  recorder.finish();
  EXPECT_LT(fs::file_size(scratch / "run/plot.svg"), 250000u);
  EXPECT_NE(content(scratch / "run/plot.svg").find(">50<"), std::string::npos);  // the axis reaches the last time
}

TEST(Ticks, AreRoundAndInside) {
  const output::Ticks within = output::ticks_within(0, 0.4078, 5);
  ASSERT_EQ(within.values.size(), 5u);
  EXPECT_EQ(within.label(within.values[3]), "0.3");
  EXPECT_EQ(within.label(within.values[0]), "0");
  const output::Ticks around = output::ticks_around(-0.031, 0.17, 5);
  EXPECT_NEAR(around.least, -0.05, 1e-15);
  EXPECT_NEAR(around.most, 0.2, 1e-15);
  EXPECT_EQ(around.label(around.values.back()), "0.20");
  EXPECT_EQ(output::ticks_within(0, 3e-7, 3).label(2e-7), "2e-07");
}

TEST(Directory, ThatCannotBeMadeIsRefused) {
  const Scratch scratch;
  const Body body = support::yielding_block();
  support::put(scratch / "file", "mine");
  EXPECT_THROW(Recorder(scratch / "file", body, plan(1, 1)), OutputError);
  EXPECT_THROW(Recorder(scratch / "file/below", body, plan(1, 1)), OutputError);
  EXPECT_THROW(Recorder("/proc/hexaplast", body, plan(1, 1)), OutputError);  // not writable even for root
  EXPECT_EQ(content(scratch / "file"), "mine");
}

TEST(Directory, OfAnEarlierRunIsLeftAloneUnlessForced) {
  const Scratch scratch;
  Body body = support::yielding_block();
  fs::create_directories(scratch / "run/frames");
  for (const char* name :
       {"history.csv", "removed.csv", "mesh.pvd", "mesh_000300.vtu", "mesh_000300.vtu.part", "surface.pvd",
        "surface_000300.vtu", "instruments.pvd", "instruments_000300.vtu", "frames/frame_000300.png", "plot.svg",
        "manifest.json", "report.html", "notes.txt", "mesh_fine.vtu", "frames/mine.png"})
    support::put(scratch / "run" / name, "earlier");
  const std::vector<std::string> before = names_in(scratch / "run");

  EXPECT_THROW(Recorder(scratch / "run", body, plan(2, 1)), OutputError);
  EXPECT_EQ(names_in(scratch / "run"), before);
  EXPECT_EQ(content(scratch / "run/history.csv"), "earlier");

  RunPlan run = plan(2, 2);
  run.force = true;
  Recorder recorder(scratch / "run", body, run);
  support::record_stretch(recorder, body, 2);
  recorder.finish();
  const std::vector<std::string> after{"frames",          "frames/mine.png", "history.csv",   "mesh.pvd",
                                       "mesh_000000.vtu", "mesh_000002.vtu", "mesh_fine.vtu", "notes.txt",
                                       "plot.svg",        "removed.csv"};
  EXPECT_EQ(names_in(scratch / "run"), after);
  EXPECT_EQ(content(scratch / "run/notes.txt"), "earlier");
}

TEST(Directory, WithSomethingElseInAFilesPlaceIsRefusedEvenIfForced) {
  const Scratch scratch;
  const Body body = support::yielding_block();
  fs::create_directories(scratch / "run/history.csv");
  support::put(scratch / "run/mesh.pvd", "earlier");
  RunPlan run = plan(1, 1);
  run.force = true;
  EXPECT_THROW(Recorder(scratch / "run", body, run), OutputError);
  EXPECT_EQ(content(scratch / "run/mesh.pvd"), "earlier");
}

/// Files cannot grow beyond a size, as on a full disk; writing fails instead of ending the program.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit lower{.rlim_cur = bytes, .rlim_max = limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &lower);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit limit_{};
  void (*handler_)(int) = nullptr;
};

TEST(FullDisk, IsReportedAtTheNextOutputAndWhatTheSeriesNamesStaysReadable) {
  const Scratch scratch;
  Body body = support::yielding_block();
  Recorder recorder(scratch / "run", body, plan(10, 1));
  PointArray x = support::record_stretch(recorder, body, 2);
  {
    const FullDisk full(5000);
    try {
      recorder.record({.step = 3, .time = 0.03}, x, x);
      FAIL() << "no error";
    } catch (const OutputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::strerror(EFBIG)), std::string::npos) << error.what();
    }
  }
  const auto series = series_in(scratch / "run");
  ASSERT_EQ(series.size(), 3u);
  EXPECT_EQ(read_with_meshio(scratch, series.back().second, {"points"}).at("points"), bytes_of(x));
  for (const std::string& name : names_in(scratch / "run")) EXPECT_FALSE(name.ends_with(".part")) << name;
}

}  // namespace
}  // namespace hexaplast
