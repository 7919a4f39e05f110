// SPDX-License-Identifier: LGPL-2.1-or-later
// Names of files are names, whatever stands in them: no shell, no format string, no pattern.
#include <algorithm>
#include <map>
#include <regex>

#include "support/bar_scene.hpp"
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

const std::string kOdd = "it's \"100 %s\" $(touch hit) `touch hit` \xc3\xbc;|&*?[a]\\n";

/// The files of a run; of viewer.json what is not the name of the scene, and of others than states their names.
std::map<std::string, std::string> states_in(const fs::path& run) {
  auto files = files_in(run);
  files.erase("manifest.json");  // names of files, and times
  for (auto& [name, bytes] : files)
    if (!name.ends_with(".vtu") && !name.ends_with(".pvd") && name != "viewer.json") bytes.clear();
  std::string& viewer = files.at("viewer.json");
  viewer = std::regex_replace(viewer, std::regex(R"("title":"(\\.|[^"\\])*",)"), "");
  return files;
}

TEST_F(Command, TakesBlanksQuotesAndSignsOfTheShellInNamesAsTheyAre) {
  fs::create_directory(directory_ / kOdd);
  write("bar.scn", kPulledBar);
  write(kOdd + "/" + kOdd + ".scn", kPulledBar);
  succeeds("run bar.scn --frames 0 --out plain --checkpoint every=3");
  const std::string scene = quoted(kOdd + "/" + kOdd + ".scn"), out = quoted(kOdd + "/out" + kOdd);
  succeeds("run " + scene + " --frames 0 --out " + out + " --checkpoint every=3");

  const auto plain = states_in(directory_ / "plain"), odd = states_in(directory_ / kOdd / ("out" + kOdd));
  EXPECT_GE(plain.size(), 8u);
  for (const auto& [name, bytes] : plain) {
    ASSERT_TRUE(odd.contains(name)) << name;
    EXPECT_TRUE(odd.at(name) == bytes) << name;
  }
  EXPECT_EQ(plain.size(), odd.size());

  succeeds("resume " + out + " --steps 8 --quiet");
  succeeds("compare plain " + out + " --out " + quoted(kOdd + ".html"));
  EXPECT_EQ(hexaplast("run " + quoted("no " + kOdd)).code, 5);
  EXPECT_FALSE(is_there("hit"));
  EXPECT_FALSE(fs::exists(directory_ / kOdd / "hit"));
}

}  // namespace
