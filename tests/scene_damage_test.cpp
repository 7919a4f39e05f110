// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
namespace fs = std::filesystem;

std::map<std::string, std::string> shipped_scenes() {
  std::map<std::string, std::string> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(HEXAPLAST_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".scn") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    scenes[entry.path().filename().string()].assign(std::istreambuf_iterator<char>(file), {});
  }
  return scenes;
}

// A damaged scene loads, or is refused by one of the three ways that the command reports; anything else ends the test.
void expect_clean(const std::string& text, bool initialise) {
  try {
    scene::Scene scene = support::read(text);
    if (initialise) scene.init();
  } catch (const scene::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("test.scn"), std::string::npos) << error.what();
  } catch (const scene::PluginError& error) {
    EXPECT_NE(std::string(error.what()).find("RequiredPlugin"), std::string::npos) << error.what();
  }
}

TEST(DamagedScene, EveryTruncationOfTheShippedScenesIsRefusedOrLoads) {
  for (const auto& [name, text] : shipped_scenes())
    for (std::size_t length = 0; length < text.size(); ++length) expect_clean(text.substr(0, length), false);
}

TEST(DamagedScene, TwoThousandMutationsOfTheShippedScenesAreRefusedOrLoad) {
  std::mt19937 random(20240607);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  // half the changes put something that means something
  const std::string characters = "<>/\"'=&;@.-+0123456789eE \n\tnxX_!";

  const auto scenes = shipped_scenes();
  ASSERT_FALSE(scenes.empty());
  for (int i = 0; i < 2000; ++i) {
    std::string text = std::next(scenes.begin(), static_cast<long>(below(scenes.size())))->second;
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const char value = below(2) ? characters[below(characters.size())] : static_cast<char>(below(256));
      const std::size_t at = below(text.size());
      switch (below(3)) {
        case 0:
          text[at] = value;
          break;
        case 1:
          text.insert(at, 1, value);
          break;
        default:
          text.erase(at, 1 + below(20));
      }
    }
    expect_clean(text, true);
  }
}

}  // namespace
