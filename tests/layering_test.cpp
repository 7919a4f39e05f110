// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <string>

namespace {

namespace fs = std::filesystem;

/// Height of each module in the order of the data flow: an include may only point down, or stay in its own module.
/// Modules of equal height are siblings and do not include one another.
const std::map<std::string, int> kHeight{
    {"base", 0},
    {"mesh", 1},
    {"material", 1},
    {"layout", 2},
    {"geometry", 2},
    {"kinematics", 3},
    {"state", 4},
    {"elastic", 5},
    {"solve", 5},
    {"plastic", 5},
    {"body", 6},
    {"inspect", 7},
    {"survey", 7},
    {"moving_body", 7},
    {"formats", 3},
    {"attributes", 8},
    {"scene", 9},
    {"components", 10},
    {"picture", 10},
    {"record", 11},
    {"page", 12},
    {"view", 13},
    {"runner", 14},
    {"sofa", 14},
    // below benchmarks/
    {"baselines", 7},
    {"bench", 8},
    {"kernels", 14},
    {"instructions", 14},
    {"figures", 14},
    {"calculix", 14},
};

/// Module that a path below include/hexaplast, src, formats, plugin or benchmarks belongs to: its first folder, or body
/// for the file of that name.
std::optional<std::string> module_of(const fs::path& path) {
  if (path.empty()) return std::nullopt;
  const std::string first = path.begin()->stem().string();
  if (kHeight.count(first)) return first;
  return std::nullopt;
}

/// Module that the text between the quotes of an include refers to.
std::optional<std::string> module_of_include(const std::string& text) {
  for (const char* root : {"hexaplast/", "plugin/"}) {
    if (text.rfind(root, 0) == 0) return module_of(fs::path(text.substr(std::string(root).size())));
  }
  return module_of(fs::path(text));
}

TEST(Layering, IncludesPointDown) {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  const std::regex include("^\\s*#include\\s+\"([^\"]+)\".*");
  int num_includes = 0;

  for (const char* folder : {"include/hexaplast", "src", "formats", "plugin", "benchmarks"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (extension != ".hpp" && extension != ".cpp" && extension != ".h") continue;
      const fs::path below = fs::relative(entry.path(), root / folder);
      const auto from = module_of(kHeight.count(folder) ? folder / below : below);
      ASSERT_TRUE(from) << entry.path() << " belongs to no module: name it in this test, at its height";

      std::ifstream file(entry.path());
      std::smatch match;
      for (std::string line; std::getline(file, line);) {
        if (!std::regex_match(line, match, include)) continue;
        const auto to = module_of_include(match[1]);
        if (!to) continue;  // a file next to the including one
        ++num_includes;
        EXPECT_TRUE(*from == *to || kHeight.at(*to) < kHeight.at(*from))
            << entry.path() << ": " << *from << " includes " << *to << ", which does not lie below it";
      }
    }
  }
  EXPECT_GT(num_includes, 50) << "the search has lost its object";
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
