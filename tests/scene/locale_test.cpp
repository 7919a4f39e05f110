// SPDX-License-Identifier: LGPL-2.1-or-later
// Hosts take their users' locale; what is read and written here does not.
#include <cstdio>

#include "record/recorder.hpp"
#include "support/german_locale.hpp"
#include "support/output.hpp"
#include "support/scene.hpp"

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using support::content;
using support::GermanLocale;
using support::Scratch;

/// Everything that a run of a scene writes, by file names.
std::map<std::string, std::string> written_by_a_run(const fs::path& directory) {
  fs::create_directories(directory);
  const std::string scene_text =
      "<Node name='root' gravity='0 0 -9.81' dt='0.0125'><DefaultAnimationLoop/>"
      "<EulerImplicitSolver rayleighMass='0.1'/><CGLinearSolver iterations='30' tolerance='1e-9'/>"
      "<RegularGridTopology n='3 3 12' max='0.05 0.05 1.25'/><MechanicalObject name='nodes'/>"
      "<DiagonalMass massDensity='1234.5'/>"
      "<HexahedronElastoplasticFEMForceField youngModulus='5000.5' yieldStress='100.25' plasticFlowRate='4'/>"
      "<FixedProjectiveConstraint indices='0 1 2 3 4 5 6 7 8'/></Node>";
  scene::Scene scene = support::read_and_init(scene_text);
  scene::MechanicalState& state = *scene::independent_states(scene.root()).front();
  const Body& body = *scene.root().all<scene::ForceField>().front()->body();
  output::Recorder recorder(directory / "out", body,
                            {.title = "pulled",
                             .num_steps = 4,
                             .dt = 0.0125,
                             .output_every = 2,
                             .num_frames = 0,
                             .force = false,
                             .loaded_nodes = {100, 101}});
  recorder.record({}, state.positions(), state.velocities());
  for (long step = 1; step <= 4; ++step) {
    const SolveReport report = scene.step();
    recorder.record({.step = 1000 * step,
                     .time = 0.0125 * static_cast<double>(step),
                     .kinetic_energy = 1234.5,
                     .solver_iterations = report.iterations,
                     .residual = report.residual,
                     .step_ms = 1234.5},
                    state.positions(), state.velocities());
  }
  recorder.finish();
  output::write_final(directory / "out" / "final.json", 4000, 0.05, state.positions(), state.velocities(), body);

  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory))
    if (entry.is_regular_file()) files[entry.path().lexically_relative(directory).string()] = content(entry.path());
  return files;
}

TEST(Locale, OfTheHostChangesNoByteOfWhatARunWrites) {
  const Scratch scratch;
  const auto expected = written_by_a_run(scratch / "plain");
  ASSERT_GE(expected.size(), 4u);
  EXPECT_NE(expected.at("out/history.csv").find("1234.5"), std::string::npos);
  EXPECT_NE(expected.at("out/history.csv").find("\n4000,0.05,"), std::string::npos);

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
