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

/// Height of each module in the order of the data flow: what a module uses lies below it, or in it. Modules of equal
/// height are siblings and do not use one another.
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
    {"backend", 7},
    {"plain", 8},
    {"kernel_backend", 9},
    {"device", 10},
    {"body", 11},
    {"contact", 11},
    {"inspect", 12},
    {"model_check", 12},
    {"moving_body", 12},
    {"attributes", 13},
    {"parts", 14},
    {"scene", 14},
    {"components", 15},
    {"picture", 15},
    {"record", 16},
    {"page", 17},
    {"view", 18},
    {"runner", 19},
    {"sofa", 19},
    {"python", 19},
    // below benchmarks/
    {"baselines", 12},
    {"bench", 13},
    {"kernels", 19},
    {"instructions", 19},
    {"figures", 19},
    {"gpu", 19},
    {"calculix", 19},
};

/// Module that a path below a folder of sources belongs to: its first folder, or the file of that name.
std::optional<std::string> module_of(const fs::path& path) {
  if (path.empty()) return std::nullopt;
  const std::string first = path.begin()->stem().string();
  if (first == "body_state" || first == "released_shape") return "body";
  if (first == "loaded_body") return "moving_body";
  if (kHeight.count(first)) return first;
  return std::nullopt;
}

/// Module that an include refers to, in quotes or angle brackets.
std::optional<std::string> module_of_include(const std::string& text) {
  for (const std::string root : {"hexaplast/plugin/", "hexaplast/", "plugin/"}) {
    if (text.starts_with(root)) return module_of(fs::path(text.substr(root.size())));
  }
  // without a folder: a header of src itself, or else a file next to the including one
  const bool is_of_module = text.find('/') != text.npos || fs::exists(fs::path(HEXAPLAST_SOURCE_DIR) / "src" / text);
  return is_of_module ? module_of(fs::path(text)) : std::nullopt;
}

struct SourceFile {
  fs::path path;
  std::string module;
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
      const auto module = module_of(kHeight.count(folder) ? folder / below : below);
      EXPECT_TRUE(module) << entry.path() << " belongs to no module: name it in this test, at its height";
      SourceFile& file = files.emplace_back(SourceFile{entry.path(), module.value_or(""), {}});
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) file.lines.push_back(line);
    }
  }
  return files;
}

/// The library of output, which knows no components, although these lie lower.
const std::set<std::string> kOutput{"picture", "record", "page"};

bool may_use(const std::string& from, const std::string& to) {
  if (kOutput.count(from) && to == "components") return false;
  return from == to || kHeight.at(to) < kHeight.at(from);
}

std::vector<std::string> includes_of(const fs::path& path) {
  const std::regex include("^\\s*#include\\s+[\"<]([^\">]+)[\">].*");
  std::vector<std::string> included;
  std::ifstream in(path);
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_match(line, match, include)) included.push_back(match[1]);
  return included;
}

TEST(Layering, IncludesPointDown) {
  int num_includes = 0;
  for (const SourceFile& file : sources())
    for (const std::string& text : includes_of(file.path)) {
      const auto to = module_of_include(text);
      if (!to) continue;
      ++num_includes;
      // a host does not run in the other one: SOFA's components are made from parts
      const bool is_other_host =
          (*to == "scene" || *to == "components") && file.path.string().find("/plugin/sofa/src/") != std::string::npos;
      EXPECT_TRUE(may_use(file.module, *to) && !is_other_host)
          << file.path << ": " << file.module << " includes " << *to << ", which it may not use";
    }
  EXPECT_GT(num_includes, 1000) << "the search has lost its object";
}

// A class that is only announced is used all the same.
TEST(Layering, ForwardDeclarationsPointDown) {
  const std::regex definition("^(?:class|struct) (\\w+)(?: final)?(?: :.*| \\{.*|)$");
  const std::regex declaration("^(?:class|struct) (\\w+);.*");
  const std::vector<SourceFile> files = sources();
  std::map<std::string, std::set<std::string>> modules_of;  // in which a class of that name is defined
  std::smatch match;
  for (const SourceFile& file : files)
    for (const std::string& line : file.lines)
      if (std::regex_match(line, match, definition)) modules_of[match[1]].insert(file.module);

  int num_declarations = 0;
  for (const SourceFile& file : files)
    for (const std::string& line : file.lines) {
      if (!std::regex_match(line, match, declaration)) continue;
      const auto modules = modules_of.find(match[1]);
      if (modules == modules_of.end()) continue;  // a class of a library
      ++num_declarations;
      EXPECT_TRUE(std::ranges::any_of(modules->second, [&](const std::string& to) { return may_use(file.module, to); }))
          << file.path << ": " << file.module << " announces " << match[1] << ", which is not of a module below it";
    }
  EXPECT_GT(num_declarations, 3) << "the search has lost its object";
}

/// Whether an include refers to a header that is never installed: of src, or of formats beside its include folder.
bool is_internal(const std::string& text) {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  return fs::exists(root / "src" / text) || (text.starts_with("formats/") && fs::exists(root / text));
}

/// What a program outside this tree can include, by the folder that it is found in.
std::map<fs::path, std::set<fs::path>> installed_headers() {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  const std::set<std::string> kept{"dense_body.hpp"};  // hexaplast_plugin_headers
  std::map<fs::path, std::set<fs::path>> headers;
  const auto add = [&](const fs::path& folder, const fs::path& below) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / below))
      if (entry.path().extension() == ".hpp" && !kept.count(entry.path().filename().string()))
        headers[folder].insert(fs::relative(entry.path(), folder));
  };
  add(root / "include", "hexaplast");
  add(root / "formats/include", "hexaplast");
  for (const char* module : {"attributes", "parts", "scene", "picture", "record", "page"}) add(root / "plugin", module);
  headers[root / "plugin"].insert("components/components.hpp");
  return headers;
}

/// Files of the plugin of SOFA and of the examples, which are built outside this tree.
std::vector<fs::path> outside_files() {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  std::vector<fs::path> files;
  for (const char* folder : {"plugin/sofa/src", "examples", "docs/examples"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".cpp" || extension == ".h" || extension == ".inl" || extension == ".hpp")
        files.push_back(entry.path());
    }
  return files;
}

// What is installed, and what is built against it, needs nothing that is not.
TEST(Layering, InstalledHeadersAndTheirUsersIncludeNoneOfOurOwn) {
  std::vector<fs::path> files = outside_files();
  EXPECT_GT(files.size(), 20u) << "the search has lost its object";
  for (const auto& [folder, headers] : installed_headers())
    for (const fs::path& header : headers) files.push_back(folder / header);
  EXPECT_GT(files.size(), 100u) << "the search has lost its object";
  for (const fs::path& file : files)
    for (const std::string& text : includes_of(file)) {
      const std::string name = fs::path(text).filename().string();
      EXPECT_FALSE(is_internal(text) || name == "dense_body.hpp")
          << file << " includes " << text << ", which is not installed";
    }
}

// include/ is the promise. A header stands there because another promised one, a plugin or an example needs it, or
// because docs/api.md tells people to use it; the rest belongs into src.
TEST(Layering, PublicHeadersHaveUsersOutside) {
  const fs::path root(HEXAPLAST_SOURCE_DIR);
  std::set<std::string> used;
  for (const auto& [folder, headers] : installed_headers())
    for (const fs::path& header : headers)
      for (const std::string& text : includes_of(folder / header)) used.insert(text);
  for (const fs::path& file : outside_files())
    for (const std::string& text : includes_of(file)) used.insert(text);
  std::ifstream page(root / "docs/api.md");
  const std::string api((std::istreambuf_iterator<char>(page)), {});
  for (const auto& [folder, headers] : installed_headers()) {
    if (folder == root / "plugin") continue;
    for (const fs::path& header : headers) {
      const std::string below = fs::relative(header, "hexaplast").string();
      EXPECT_TRUE(used.count(header.string()) || api.find(below) != api.npos)
          << header << " is included by nothing that is installed or built outside this tree, and docs/api.md does not "
          << "name it";
    }
  }
}

}  // namespace
