// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes that ship with the program, run as a user runs them: permanent shape, volume and tears in their bands, twice
// the same.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>

#include "hexaplast/geometry/sections.hpp"
#include "hexaplast/geometry/shapes.hpp"
#include "support/compare.hpp"
#include "support/golden.hpp"
#include "support/shapes.hpp"

extern char** environ;

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using support::Json;

struct SceneCase {
  const char* name;
  bool is_stretched;
  double expected;  ///< permanent elongation [-] or twist [degrees]
};

void PrintTo(const SceneCase& scene, std::ostream* out) { *out << scene.name; }

/// Runs the command with these arguments and waits; returns its exit code, -1 if it did not exit.
int run_command(std::vector<std::string> words) {
  words.insert(words.begin(), HEXAPLAST_COMMAND);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) return -1;
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The columns of a CSV file by name.
std::map<std::string, std::vector<double>> read_csv(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> columns;
  std::string line, cell;
  std::getline(file, line);
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    for (const std::string& name : names) {
      std::getline(cells, cell, ',');
      columns[name].push_back(std::stod(cell));
    }
  }
  return columns;
}

Json read_json(const fs::path& path) {
  std::ifstream file(path);
  return Json::parse(file);
}

/// What a scene leaves behind.
struct SceneOutcome {
  Json final;                                          ///< the final state
  std::map<std::string, std::vector<double>> history;  ///< columns of history.csv
};

/// Runs a scene with one thread and with two, which must end alike.
void run_twice(const std::string& name, SceneOutcome& outcome) {
  const std::string scene = std::string(HEXAPLAST_SOURCE_DIR) + "/scenes/" + name + ".scn";
  const fs::path folder = fs::temp_directory_path() / ("hexaplast_" + name + std::to_string(getpid()));
  const fs::path out = folder / "out", first = folder / "first.json", second = folder / "second.json";
  fs::create_directories(folder);
  ASSERT_EQ(run_command({"run", scene, "--quiet", "--strict", "--threads", "1", "--frames", "0", "--out", out,
                         "--final", first}),
            0);
  ASSERT_EQ(run_command({"run", scene, "--quiet", "--strict", "--threads", "2", "--final", second}), 0);

  outcome = {read_json(first), read_csv(out / "history.csv")};
  EXPECT_EQ(outcome.final["state_hash"], read_json(second)["state_hash"]);
  fs::remove_all(folder);
}

class ShippedScene : public testing::TestWithParam<SceneCase> {};

TEST_P(ShippedScene, EndsInItsBandsAndTwiceInTheSameState) {
  SceneOutcome outcome;
  ASSERT_NO_FATAL_FAILURE(run_twice(GetParam().name, outcome));
  auto& [final, history] = outcome;
  EXPECT_NEAR(final["time"], 5, 1e-9);

  const HexMesh mesh = regular_grid({3, 3, 10}, Vec3(-0.15, -0.15, -0.5), Vec3(0.15, 0.15, 0.5));
  const EndSections ends = end_sections(mesh);
  const PointArray plastic_rest = support::matrix(final["material_positions"]);
  ASSERT_EQ(plastic_rest.rows(), mesh.num_nodes());
  const double permanent = GetParam().is_stretched ? elongation(ends, plastic_rest)
                                                   : std::abs(twist(mesh, ends, plastic_rest)) * 180 / std::numbers::pi;
  EXPECT_NEAR(permanent, GetParam().expected, 0.02 * GetParam().expected);

  // halves are alike: the same distance from the clamp, and opposite angles
  for (int slice = 0; slice < 5; ++slice) {
    const std::vector<int> lower = support::nodes_at(mesh, 2, -0.5 + slice * 0.1),
                           upper = support::nodes_at(mesh, 2, 0.5 - slice * 0.1);
    double height = 0;
    for (std::size_t k = 0; k < lower.size(); ++k)
      height += (plastic_rest(lower[k], 2) + plastic_rest(upper[k], 2)) / lower.size();
    EXPECT_NEAR(height, 0, 1e-9) << "slice " << slice;
    EXPECT_NEAR(section_angle(mesh, lower, 2, plastic_rest) + section_angle(mesh, upper, 2, plastic_rest), 0,
                1e-6 * std::numbers::pi / 180);
  }

  ASSERT_EQ(history["time"].size(), 501u);  // the beginning, then every step
  const std::vector<double>& volume_ratio = history["material_volume_ratio"];
  for (const double ratio : volume_ratio) EXPECT_NEAR(ratio, 1, 0.01);
  EXPECT_NEAR(volume_ratio.back(), 1, 1e-4) << "three seconds after release";
  EXPECT_EQ(history["inverted"].back(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Bars, ShippedScene,
    testing::Values(SceneCase{"bar_stretch_high", true, 0.6795}, SceneCase{"bar_stretch_medium", true, 0.2301},
                    SceneCase{"bar_stretch_low", true, 0.0307}, SceneCase{"bar_twist_high", false, 110.5},
                    SceneCase{"bar_twist_medium", false, 29.2}, SceneCase{"bar_twist_low", false, 4.5}),
    [](const auto& test) { return std::string(test.param.name); });

/// What a torn scene leaves, after it ran twice, on one thread and on two, to the same state.
struct TornScene {
  explicit TornScene(const std::string& name) {
    const fs::path folder = fs::temp_directory_path() / ("hexaplast_" + name + std::to_string(getpid()));
    fs::create_directories(folder);
    const std::string scene = std::string(HEXAPLAST_SOURCE_DIR) + "/scenes/" + name + ".scn";
    const fs::path out = folder / "out", first = folder / "first.json", second = folder / "second.json";
    EXPECT_EQ(run_command({"run", scene, "--quiet", "--strict", "--threads", "1", "--frames", "0", "--out", out,
                           "--final", first}),
              0);
    EXPECT_EQ(run_command({"run", scene, "--quiet", "--strict", "--threads", "2", "--final", second}), 0);
    const Json final = read_json(first);
    EXPECT_EQ(final["state_hash"], read_json(second)["state_hash"]);

    plastic_rest = support::matrix(final["material_positions"]);
    for (const Json& ratio : final["volume_ratio"]) alive.push_back(ratio.get<double>() > 0);  // 0: removed
    auto history = read_csv(out / "history.csv");
    removed = history["removed"].back();
    EXPECT_EQ(removed, std::count(alive.begin(), alive.end(), 0));
    EXPECT_NEAR(history["material_volume_ratio"].back(), 1, 0.01);
    EXPECT_EQ(history["inverted"].back(), 0);
    fs::remove_all(folder);
  }

  PointArray plastic_rest;           ///< [m]
  std::vector<unsigned char> alive;  ///< per hexahedron
  double removed = 0;                ///< hexahedra
};

TEST(TornScene, PeritoneumIsLeftWithAHoleAndAPieceInTheForceps) {
  const TornScene torn("peritoneum_tear");
  const HexMesh mesh = regular_grid({36, 1, 28}, Vec3(-0.06, -0.0005, -0.048), Vec3(0.06, 0.0005, 0.048));
  ASSERT_EQ(torn.plastic_rest.rows(), mesh.num_nodes());
  EXPECT_GE(torn.removed, 20);
  EXPECT_LE(torn.removed, 50);

  const ConnectedParts parts = connected_parts(mesh, torn.alive);
  const auto node = [](int i, int k) { return i + 37 * 2 * k; };  // on the lower side
  EXPECT_GE(parts.count, 2);
  const int held = parts.part_of_node[node(13, 14)];  // where the forceps closed
  EXPECT_GE(held, 0);
  EXPECT_NE(held, parts.part_of_node[node(0, 0)]);

  // the strip behind the hole, from the border on, in the row through the forceps
  const double stretch =
      (torn.plastic_rest.row(node(7, 14)) - torn.plastic_rest.row(node(0, 14))).norm() / (7 * 0.12 / 36);
  EXPECT_GT(stretch, 1.05);
  EXPECT_LT(stretch, 1.25);
}

TEST(TornScene, VesselIsFreeAndLeavesStretchedStumps) {
  const TornScene torn("vessel_mobilise");
  const HexMesh lattice = tube({4, 16, 42}, 0.0025, 0.0105, arc(0.126, 0, 43));
  ASSERT_EQ(torn.plastic_rest.rows(), lattice.num_nodes());
  std::vector<Hexahedron> hexahedra;
  std::vector<int> layer_of;  // 0: the wall; 1 to 3: the strands, outward
  for (int e = 0; e < lattice.num_elements(); ++e) {
    const int layer = e % 4, around = e / 4 % 16, ring = e / 64;
    const bool strand = (around == 11 || around == 12) && (ring % 6 == 2 || ring % 6 == 3);
    if (layer > 0 && !strand) continue;
    hexahedra.push_back(lattice.hexahedra()[e]);
    layer_of.push_back(layer);
  }
  const HexMesh mesh(lattice.positions(), hexahedra);
  ASSERT_EQ(torn.alive.size(), hexahedra.size());
  EXPECT_GE(torn.removed, 28);  // at least one layer of four in each of seven strands
  EXPECT_LE(torn.removed, 56);  // at most two
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    EXPECT_TRUE(torn.alive[e] || layer_of[e] > 0) << "hexahedron " << e << " of the wall";

  // nothing that lies on the bed hangs together with the vessel
  const ConnectedParts parts = connected_parts(mesh, torn.alive);
  const int vessel = parts.part_of_node[mesh.hexahedra().front().front()];
  EXPECT_GE(vessel, 0);
  std::vector<double> stretches;  // of the stumps on the bed, outward
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    if (layer_of[e] != 3 || !torn.alive[e]) continue;
    for (const int node : hexahedra[e]) EXPECT_NE(parts.part_of_node[node], vessel) << "node " << node;
    const auto thickness = [&](const PointArray& x) {
      Vec3 sum = Vec3::Zero();
      const ElementPoints at = gather(x, hexahedra[e]);
      for (int a = 0; a < kCorners; ++a) sum += 0.25 * kCornerSign[a][0] * at.row(a).transpose();
      return sum.norm();
    };
    stretches.push_back(thickness(torn.plastic_rest) / thickness(mesh.positions()));
  }
  ASSERT_FALSE(stretches.empty());
  for (const double stretch : stretches) EXPECT_LT(stretch, 1.4);
  EXPECT_GT(std::accumulate(stretches.begin(), stretches.end(), 0.0) / stretches.size(), 1.03);
}

/// The volume of an organ's material throughout a run and at its end; nothing turned inside out.
void expect_kept_volume(std::map<std::string, std::vector<double>>& history) {
  for (const double ratio : history["material_volume_ratio"]) EXPECT_NEAR(ratio, 1, 0.01);
  EXPECT_NEAR(history["material_volume_ratio"].back(), 1, 2e-3);
  EXPECT_EQ(history["inverted"].back(), 0);
}

// The grasper goes 26 mm up. The fat keeps nearly half of it; the wall is drawn 5 mm along and comes back to about
// 2: it does not flow itself, but the fat around it has.
TEST(FattyTissue, KeepsABumpOnAWallThatDoesNotFlow) {
  SceneOutcome outcome;
  ASSERT_NO_FATAL_FAILURE(run_twice("fatty_tissue", outcome));
  auto& [final, history] = outcome;

  PointArray arch(9, 3);
  for (int k = 0; k < 9; ++k) {
    const double x = -0.06 + 0.015 * k;
    arch.row(k) << x, 0.025 * (1 - x * x / 0.0036), 0;
  }
  const HexMesh mesh = tube({3, 20, 36}, 0.004, 0.013, curve_through(arch, 37));
  const PointArray current = support::matrix(final["positions"]),
                   plastic_rest = support::matrix(final["material_positions"]);
  ASSERT_EQ(current.rows(), mesh.num_nodes());

  const double top = mesh.positions().col(1).maxCoeff();
  EXPECT_NEAR(top, 0.038, 1e-4);
  EXPECT_NEAR(current.col(1).maxCoeff() - top, 0.014, 0.0015);
  EXPECT_NEAR(plastic_rest.col(1).maxCoeff() - top, 0.014, 0.0015);

  // of every four nodes outward, the first lies on the inside of the wall, the second one on its outside
  for (int n = 0; n < mesh.num_nodes(); n += 4)
    for (const int node : {n, n + 1})
      ASSERT_LT((current.row(node) - mesh.positions().row(node)).norm(), 5e-3) << "node " << node;
  for (int e = 0; e < mesh.num_elements(); e += 3)
    ASSERT_EQ(final["yield_stress"][e], 1e9) << "hexahedron " << e << " of the wall has flowed";

  EXPECT_EQ(history["yielded"].back(), 0);
  expect_kept_volume(history);
}

// The forceps go 40 mm out. The lobe keeps about half of it.
TEST(LiverCage, KeepsItsLobeDrawnOut) {
  SceneOutcome outcome;
  ASSERT_NO_FATAL_FAILURE(run_twice("liver_cage", outcome));
  auto& [final, history] = outcome;

  const PointArray current = support::matrix(final["positions"]),
                   plastic_rest = support::matrix(final["material_positions"]);
  const double rest = 1.02 * 0.110;  // of the surface, and the hundredth of its length by which its grid is wider
  EXPECT_NEAR(current.col(0).maxCoeff() - rest, 0.019, 0.002);
  EXPECT_NEAR(plastic_rest.col(0).maxCoeff() - rest, 0.019, 0.002);

  EXPECT_EQ(history["yielded"].back(), 0);
  expect_kept_volume(history);
}

}  // namespace
}  // namespace hexaplast
