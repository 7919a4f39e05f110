// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Height of each room in the order of the data flow: what a room uses lies below it, or in it. Rooms of equal height
/// are siblings and do not use one another.
const std::map<std::string, int> kHeight{
    {"base", 0},
    {"mesh", 1},
    {"material", 1},
    {"layout", 2},
    {"geometry", 2},
    {"formats", 3},
    {"kinematics", 3},
    {"element", 4},
    {"state", 5},
    {"elastic", 6},
    {"solve", 6},
    {"plastic", 6},
    {"body", 7},
    {"contact", 7},
    {"inspect", 8},
    {"element_values", 8},
    {"model_check", 8},
    {"moving_body", 8},
    {"attributes", 9},
    {"parts", 10},
    {"scene", 10},
    {"components", 11},
    {"picture", 11},
    {"record", 12},
    {"page", 13},
    {"view", 14},
    {"runner", 15},
    {"sofa", 15},
    {"python", 15},
    // below benchmarks/
    {"baselines", 8},
    {"bench", 9},
    {"kernels", 15},
    {"instructions", 15},
    {"figures", 15},
    {"calculix", 15},
};

/// Room that a path below a folder of sources belongs to: its first folder, or the file of that name.
std::optional<std::string> room_of(const fs::path& path) {
  if (path.empty()) return std::nullopt;
  const std::string first = path.begin()->stem().string();
  if (first == "body_state") return "body";
  if (kHeight.count(first)) return first;
  return std::nullopt;
}

/// Room that an include refers to, in quotes or angle brackets.
std::optional<std::string> room_of_include(const std::string& text) {
  for (const std::string root : {"hexaplast/plugin/", "hexaplast/", "plugin/"}) {
    if (text.starts_with(root)) return room_of(fs::path(text.substr(root.size())));
  }
  return text.find('/') == text.npos ? std::nullopt : room_of(fs::path(text));  // else a file next to the including one
}

struct SourceFile {
  fs::path path;
  std::string room;
  std::vector<std::string> lines;
};

/// All files of C++ but the tests.
std::vector<SourceFile> sources() {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  std::vector<SourceFile> files;
  for (const char* folder : {"include/hexaplast", "src", "formats", "plugin", "python", "benchmarks"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (extension != ".hpp" && extension != ".cpp" && extension != ".h" && extension != ".inl") continue;
      const fs::path below = fs::relative(entry.path(), root / folder);
      const auto room = room_of(kHeight.count(folder) ? folder / below : below);
      EXPECT_TRUE(room) << entry.path() << " belongs to no room: name it in this test, at its height";
      SourceFile& file = files.emplace_back(SourceFile{entry.path(), room.value_or(""), {}});
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) file.lines.push_back(line);
    }
  }
  return files;
}

bool may_use(const std::string& from, const std::string& to) { return from == to || kHeight.at(to) < kHeight.at(from); }

TEST(Layering, IncludesPointDown) {
  const std::regex include("^\\s*#include\\s+[\"<]([^\">]+)[\">].*");
  int num_includes = 0;
  for (const SourceFile& file : sources()) {
    std::smatch match;
    for (const std::string& line : file.lines) {
      if (!std::regex_match(line, match, include)) continue;
      const auto to = room_of_include(match[1]);
      if (!to) continue;
      ++num_includes;
      EXPECT_TRUE(may_use(file.room, *to))
          << file.path << ": " << file.room << " includes " << *to << ", which does not lie below it";
    }
  }
  EXPECT_GT(num_includes, 1000) << "the search has lost its object";
}

// A class that is only announced is used all the same.
TEST(Layering, ForwardDeclarationsPointDown) {
  const std::regex definition("^(?:class|struct) (\\w+)(?: final)?(?: :.*| \\{.*|)$");
  const std::regex declaration("^(?:class|struct) (\\w+);.*");
  const std::vector<SourceFile> files = sources();
  std::map<std::string, std::set<std::string>> rooms_of;  // in which a class of that name is defined
  std::smatch match;
  for (const SourceFile& file : files)
    for (const std::string& line : file.lines)
      if (std::regex_match(line, match, definition)) rooms_of[match[1]].insert(file.room);

  int num_declarations = 0;
  for (const SourceFile& file : files)
    for (const std::string& line : file.lines) {
      if (!std::regex_match(line, match, declaration)) continue;
      const auto rooms = rooms_of.find(match[1]);
      if (rooms == rooms_of.end()) continue;  // a class of a library
      ++num_declarations;
      EXPECT_TRUE(std::ranges::any_of(rooms->second, [&](const std::string& to) { return may_use(file.room, to); }))
          << file.path << ": " << file.room << " announces " << match[1] << ", which is not of a room below it";
    }
  EXPECT_GT(num_declarations, 3) << "the search has lost its object";
}

// A host does not run in the other one: SOFA's components are made from parts.
TEST(Layering, SofasComponentsNeedNoScene) {
  const std::regex include("^\\s*#include\\s+[\"<](?:scene|components)/.*");
  int num_files = 0;
  for (const SourceFile& file : sources()) {
    if (file.path.string().find("/plugin/sofa/src/") == std::string::npos) continue;
    ++num_files;
    for (const std::string& line : file.lines)
      EXPECT_FALSE(std::regex_match(line, include)) << file.path << ": " << line;
  }
  EXPECT_GT(num_files, 10) << "the search has lost its object";
}

TEST(Layering, OnlyItsPluginKnowsSofa) {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  const std::regex name("sofa::|sofa_plugin|<sofa/|<Hexaplast/|sofa_standin");
  int num_files = 0, num_of_plugin = 0;
  for (const char* folder : {"include", "src", "formats", "plugin", "benchmarks"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file()) continue;
      const bool is_plugin = fs::relative(entry.path(), root).string().starts_with("plugin/sofa/");
      std::ifstream file(entry.path());
      const std::string text((std::istreambuf_iterator<char>(file)), {});
      if (is_plugin) {
        num_of_plugin += std::regex_search(text, name);
        EXPECT_EQ(text.find("sofa_standin"), std::string::npos) << entry.path() << " includes what is no SOFA";
      } else {
        ++num_files;
        EXPECT_FALSE(std::regex_search(text, name)) << entry.path() << " names SOFA";
      }
    }
  }
  EXPECT_GT(num_files, 100) << "the search has lost its object";
  EXPECT_GT(num_of_plugin, 10) << "the names have changed";

  std::ifstream file(root / "tests/CMakeLists.txt");
  const std::string tests((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(tests.find("sofa_standin"), std::string::npos);
  EXPECT_EQ(tests.find("install("), std::string::npos) << "what stands in for SOFA never ships";
}

}  // namespace
