// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <regex>
#include <string>

#include "support/files.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
namespace fs = std::filesystem;

std::map<std::string, std::string> shipped_scenes() {
  std::map<std::string, std::string> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(HEXAPLAST_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".scn") continue;
    scenes[entry.path().filename().string()] = support::content(entry.path());
  }
  return scenes;
}

// A damaged scene loads, or is refused by one of the three ways that the command reports; anything else ends the test.
void expect_clean(const std::string& text) {
  try {
    scene::Scene scene = support::read(text);
    scene.init();
  } catch (const scene::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("test.scn"), std::string::npos) << error.what();
  } catch (const scene::PluginError& error) {
    EXPECT_NE(std::string(error.what()).find("RequiredPlugin"), std::string::npos) << error.what();
  }
}

// A scene is one element: whatever is cut off, its end is missing, which is said once and of a line that is there.
TEST(DamagedScene, EveryTruncationOfTheShippedScenesIsRefused) {
  for (const auto& [name, text] : shipped_scenes()) {
    const std::size_t end = text.rfind("</Node>") + 7;  // what may be missing behind it does not matter
    for (std::size_t length = 0; length < end; ++length) {
      try {
        support::read(text.substr(0, length));
        ADD_FAILURE() << name << " is read though it is cut after " << length << " characters";
      } catch (const scene::SceneError& error) {
        const std::string said = error.what();
        int line = 0;
        EXPECT_EQ(std::sscanf(said.c_str(), "test.scn:%d: error: ", &line), 1) << said;
        EXPECT_TRUE(line >= 1 && line <= 1 + std::ranges::count(text.begin(), text.begin() + length, '\n')) << said;
        EXPECT_EQ(said.find('\n'), said.npos) << said;
      }
    }
  }
}

// How many mutations of each scene: enough for a build by default, as many as HEXAPLAST_MUTATIONS says for a long run.
int num_mutations() {
  const char* given = std::getenv("HEXAPLAST_MUTATIONS");
  return given ? std::atoi(given) : 250;
}

TEST(DamagedScene, MutationsOfTheShippedScenesAreRefusedOrLoad) {
  // half the changes put something that means something
  const std::string characters = "<>/\"'=&;@.-+0123456789eE \n\tnxX_!";

  const auto scenes = shipped_scenes();
  ASSERT_FALSE(scenes.empty());
  std::mt19937 random(20240607);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  for (const auto& [name, whole] : scenes) {
    for (int i = 0; i < num_mutations(); ++i) {
      std::string text = whole;
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
      expect_clean(text);
    }
  }
}

/// Where a pattern's group stands in the scene outside comments: begin and length.
std::vector<std::pair<std::size_t, std::size_t>> places_of(const std::string& scene, const char* pattern) {
  std::string visible = scene;
  for (std::size_t at = visible.find("<!--"); at != visible.npos; at = visible.find("<!--", at))
    for (const std::size_t end = visible.find("-->", at) + 3; at < end; ++at) visible[at] = ' ';
  std::vector<std::pair<std::size_t, std::size_t>> places;
  const std::regex expression(pattern);
  for (std::sregex_iterator match(visible.begin(), visible.end(), expression), end; match != end; ++match)
    places.emplace_back(match->position(1), match->length(1));
  return places;
}

// A misspelt name must not be passed over: the scene would run as something else.
TEST(MisspeltScene, NoNameOfAComponentAttributeOrTargetIsPassedOver) {
  int num_names = 0;
  const auto expect_refusal = [&](const std::string& scene, std::size_t at, const std::string& misspelt,
                                  std::size_t length, const std::string& refusal) {
    std::string text = scene;
    text.replace(at, length, misspelt);
    const std::string errors = support::errors_of(text);
    EXPECT_NE(errors.find(refusal), errors.npos) << misspelt << ": " << errors;
    ++num_names;
  };
  for (const auto& [name, scene] : shipped_scenes()) {
    SCOPED_TRACE(name);
    for (const auto& [at, length] : places_of(scene, "<([A-Z]\\w+)(?=[^>]*/>)")) {
      const std::string word = scene.substr(at, length);
      const std::string misspelt = word.substr(0, 2) + word.substr(3);
      expect_refusal(scene, at, misspelt, length,
                     misspelt + ": unknown component\n  hint: did you mean '" + word + "'?");
    }
    for (const auto& [at, length] : places_of(scene, "\\s([a-z]\\w+)=\"")) {
      if (scene.compare(at, 8, "version=") == 0 || scene.compare(at, 9, "encoding=") == 0) continue;
      const std::string word = scene.substr(at, length);
      if (word == "removeIsolated") continue;  // of bookkeeping in SOFA, which may have any attribute
      expect_refusal(scene, at, word + "x", length, word + "x: unknown attribute");
    }
    for (const auto& [at, length] : places_of(scene, "\"@(\\w+)")) {
      const std::string word = scene.substr(at, length);
      expect_refusal(scene, at, word + "x", length, "holds no '" + word + "x'\n  hint: did you mean '" + word + "'?");
    }
  }
  EXPECT_GT(num_names, 300);
}

}  // namespace
