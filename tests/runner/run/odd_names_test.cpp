// SPDX-License-Identifier: LGPL-2.1-or-later
// Names of files are names, whatever stands in them: no shell, no format string, no pattern.
#include <algorithm>
#include <map>
#include <regex>

#include "support/bar_scene.hpp"
#include "support/command.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::kPulledBar;
using hexaplast::support::Outcome;

const std::string kOdd = "it's \"100 %s\" $(touch hit) `touch hit` \xc3\xbc;|&*?[a]\\n";

std::string quoted(const std::string& text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return all + "'";
}

/// The files below a directory, by their names; of history.csv what does not tell the time that a step took, and of
/// viewer.json what is not the name of the scene.
std::map<std::string, std::string> files_in(const fs::path& directory) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory)) {
    const fs::path name = entry.path().lexically_relative(directory);
    if (name.extension() == ".vtu" || name.extension() == ".pvd" || name.extension() == ".json")
      files[name.string()] = content(entry.path());
    else if (entry.is_regular_file())
      files[name.string()] = "";
  }
  files.erase("manifest.json");  // names of files, and times
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
  const Outcome run = succeeds("run " + scene + " --frames 0 --out " + out + " --checkpoint every=3");

  const auto plain = files_in(directory_ / "plain"), odd = files_in(directory_ / kOdd / ("out" + kOdd));
  EXPECT_GE(plain.size(), 8u);
  for (const auto& [name, bytes] : plain) {
    ASSERT_TRUE(odd.contains(name)) << name;
    EXPECT_TRUE(odd.at(name) == bytes) << name;
  }
  EXPECT_EQ(plain.size(), odd.size());

  succeeds("resume " + out + " --steps 8 --quiet");
  succeeds("compare plain " + out + " --out " + quoted(kOdd + ".html"));
  EXPECT_EQ(hexaplast("run " + quoted("no " + kOdd)).code, 5);
  EXPECT_FALSE(fs::exists(directory_ / "hit"));
  EXPECT_FALSE(fs::exists(directory_ / kOdd / "hit"));
}

}  // namespace
