// SPDX-License-Identifier: LGPL-2.1-or-later
// The bits of the shipped scenes: the same for any number of threads, and the same as ever on each instruction set.
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/simd.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "record/recorder.hpp"
#include "support/scene.hpp"

namespace hexaplast {
namespace {

using namespace support;

using Json = nlohmann::ordered_json;

enum class Comes { kElastic, kToYield, kToTear };

/// A scene, and steps enough for everything that it is about to have begun.
struct PinnedScene {
  const char* name;
  int num_steps;
  Comes comes = Comes::kToYield;
};

void PrintTo(const PinnedScene& scene, std::ostream* out) { *out << scene.name; }

constexpr PinnedScene kScenes[] = {
    {"bar_stretch_high", 25},
    {"bar_stretch_medium", 25},
    {"bar_stretch_low", 40},
    {"bar_stretch_face", 40},
    {"bar_twist_high", 25},
    {"bar_twist_medium", 25},
    {"bar_twist_low", 40},
    {"cantilever_static", 2, Comes::kElastic},
    {"fatty_tissue", 25},
    {"fold", 40},
    {"forceps_fat", 60},
    {"ligament", 100},
    {"liver_cage", 30},
    {"liver_cut", 60, Comes::kElastic},
    {"liver_tumour", 40},
    {"notch", 150, Comes::kToTear},
    {"peritoneum_tear", 32},
    {"pressed_ring", 30},
    {"probe_liver", 50},
    {"sheet_cut", 100},
    {"slope", 110, Comes::kElastic},
    {"springback", 20},
    {"two_organs", 110, Comes::kElastic},
    {"vessel_mobilise", 80, Comes::kToTear},
};

const std::string kTable = HEXAPLAST_TEST_DATA "/state_hashes.json";

constexpr const char* kHowToPin =
    "\nA change of the results, or of the compiler or the C library, moves the last bits. If that is what happened and "
    "is "
    "meant, scripts/pin_state_hashes writes the table anew; say in the commit why.";

Json read_table() {
  std::ifstream file(kTable);
  return file ? Json::parse(file) : Json::object();
}

/// Where the results have changed, rows of instruction sets that this machine lacks hold no longer: null says so.
void pin(Json& row, const std::vector<std::string>& here, const std::string& target, const std::string& hash) {
  if (row.contains(target) && row[target] != hash)
    for (auto& [other, value] : row.items())
      if (std::ranges::find(here, other) == here.end()) value = nullptr;
  row[target] = hash;
}

void compare(const Json& row, const std::string& target, const std::string& hash) {
  ASSERT_TRUE(row.contains(target)) << target << kHowToPin;
  if (row[target].is_null())  // a skip in part, which scripts/check_skips sees
    std::cout << "skipped: " << hash << " on " << target
              << " is compared with nothing: the results have changed since it was last pinned, on a machine without "
                 "this instruction set; scripts/pin_state_hashes writes it down\n";
  else
    EXPECT_EQ(hash, row[target].get<std::string>()) << target << kHowToPin;
}

std::string hash_after(const PinnedScene& pinned, int threads) {
  set_num_threads(threads);
  scene::Scene scene =
      scene::read_scene(std::string(HEXAPLAST_SOURCE_DIR "/scenes/") + pinned.name + ".scn", factory(), plugins());
  scene.init();
  for (int step = 0; step < pinned.num_steps; ++step) scene.step();
  scene::MechanicalState& state = *scene::independent_states(scene.root()).front();
  const Body* body = nullptr;
  for (const scene::ForceField* field : scene.root().all<scene::ForceField>())
    if (field->body()) body = field->body();
  EXPECT_EQ(pinned.comes != Comes::kElastic, body->dissipated_energy() > 0);
  const bool tears_faces = body->settings().fracture == Fracture::kFace && !body->opened().empty();
  EXPECT_EQ(pinned.comes == Comes::kToTear, !body->removed().empty() || tears_faces);
  return output::state_hash(pinned.num_steps, state.positions(), state.velocities(), body);
}

class StateHashOf : public testing::TestWithParam<PinnedScene> {
 protected:
  ~StateHashOf() override {
    set_simd_target("");
    set_num_threads(1);
  }
};

TEST_P(StateHashOf, IsTheSameForAnyThreadsAndAsEver) {
  Json table = read_table();
  const bool pins = std::getenv("HEXAPLAST_PIN_STATE_HASHES") != nullptr;
  const char* given = std::getenv("HEXAPLAST_HASH_REPEATS");
  const int repeats = given ? std::atoi(given) : 1;
  const std::vector<std::string> here = simd_targets();  // before one of them is chosen
  for (const std::string& target : here) {
    set_simd_target(target);
    // threads know nothing of instruction sets: of the others one is enough
    std::vector<int> thread_counts;
    if (target == here.front()) thread_counts = given ? std::vector{1, 2, 3, 4, 7, 16} : std::vector{3};
    const std::string hash = hash_after(GetParam(), 1);
    for (int repeat = 0; repeat < repeats; ++repeat)
      for (const int threads : thread_counts)
        EXPECT_EQ(hash_after(GetParam(), threads), hash) << threads << " threads, " << target << ", repeat " << repeat;
    Json& row = table[GetParam().name];
    if (pins)
      pin(row, here, target, hash);
    else
      compare(row, target, hash);
  }
  if (pins) std::ofstream(kTable) << table.dump(2) << '\n';
}

TEST(StateHashes, ArePinnedOfEveryShippedScene) {
  std::set<std::string> pinned, shipped;
  for (const PinnedScene& scene : kScenes) pinned.insert(scene.name);
  for (const auto& file : std::filesystem::directory_iterator(HEXAPLAST_SOURCE_DIR "/scenes"))
    if (file.path().extension() == ".scn") shipped.insert(file.path().stem().string());
  EXPECT_EQ(pinned, shipped);
}

INSTANTIATE_TEST_SUITE_P(Scenes, StateHashOf, testing::ValuesIn(kScenes),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace hexaplast
