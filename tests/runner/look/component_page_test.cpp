// SPDX-License-Identifier: LGPL-2.1-or-later
// docs/components.md is what the program prints, and every example on it runs; the manual page and the completion
// against what --help says of every subcommand.
#include "support/command.hpp"
#include "support/example_scene.hpp"

namespace {

using namespace hexaplast::support;

const std::string kLook = std::string(HEXAPLAST_SOURCE_DIR) + "/plugin/runner/look/";
const std::string kPage = std::string(HEXAPLAST_SOURCE_DIR) + "/docs/components.md";

std::vector<std::string> xml_blocks(const std::string& page) {
  std::vector<std::string> blocks;
  const std::string opening = "```xml\n", closing = "\n```\n";
  for (std::size_t at = page.find(opening); at != page.npos; at = page.find(opening, at)) {
    at += opening.size();
    blocks.push_back(page.substr(at, page.find(closing, at) - at));
  }
  return blocks;
}

class ComponentPage : public Command {
 protected:
  /// Of the components that have an effect, by their names, as `hexaplast list` prints them.
  std::map<std::string, std::string> categories() {
    std::map<std::string, std::string> category_of;
    std::istringstream lines(hexaplast("list").out);
    std::string category;
    for (std::string line; std::getline(lines, line) && line != "Without effect";) {
      if (line.starts_with("  "))
        category_of[line.substr(2, line.find(' ', 2) - 2)] = category;
      else
        category = line;
    }
    return category_of;
  }
};

TEST_F(Command, TheComponentPageIsWhatTheProgramPrints) {
  const Outcome printed = succeeds("list --markdown");
  EXPECT_TRUE(printed.out == content(kPage)) << "run: hexaplast list --markdown > docs/components.md";
}

TEST_F(ComponentPage, EveryExampleOfTheComponentPageRunsWithoutComplaint) {
  const std::map<std::string, std::string> category_of = categories();
  std::set<std::string> wanted;
  for (const auto& [name, category] : category_of) wanted.insert(name);
  ASSERT_GE(wanted.size(), 20u);

  // what the examples of mesh loaders load: a cube of 0.1 m
  write("block.msh", content(HEXAPLAST_TEST_DATA "/meshes/block.msh"));
  write("block.vtk", content(HEXAPLAST_TEST_DATA "/meshes/block.vtk"));
  write("skin.stl", content(HEXAPLAST_TEST_DATA "/meshes/organ_binary.stl"));
  write("skin.obj", content(HEXAPLAST_TEST_DATA "/meshes/surface.obj"));
  write("organ.obj", content(HEXAPLAST_TEST_DATA "/meshes/organ.obj"));

  const std::vector<std::string> blocks = xml_blocks(hexaplast("list --markdown").out);
  ASSERT_EQ(blocks.size(), wanted.size() + 1);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::string scene = i == 0 ? blocks[0] : pasted(blocks[0], blocks[i], category_of);
    write("example.scn", scene);
    const Outcome outcome = succeeds("run example.scn --steps 2");
    EXPECT_EQ(outcome.err, "") << scene;
    for (const std::string& class_name : classes_in(blocks[i])) wanted.erase(class_name);
  }
  EXPECT_TRUE(wanted.empty()) << *wanted.begin() << " is in no example";
}

TEST_F(Command, ListPrintsOneComponent) {
  const Outcome text = succeeds("list BoxROI");
  for (const char* part :
       {"BoxROI: ", "box: groups of six numbers [m]; default 0 0 0 1 1 1", "indices: whole numbers; computed"})
    EXPECT_TRUE(has(text.out, part));
  const Outcome body = succeeds("list HexahedronElastoplasticFEMForceField");
  for (const char* part :
       {"poissonRatio: numbers, must lie in [0, 0.5); default 0.45", "youngModulus: numbers [Pa], must be > 0",
        "yieldNorm: one word of vonMises frobenius spectral; default vonMises"})
    EXPECT_TRUE(has(body.out, part)) << body.out;
}

TEST_F(Command, ListRefusesWhatIsNoComponent) {
  expect_refused({{"list BoxRO", 2, "hexaplast: error: no component 'BoxRO'\n  hint: did you mean 'BoxROI'?\n"},
                  {"list roi", 2, "no component 'roi'\n  hint: there are BoxROI, MeshROI, PlaneROI, SphereROI\n"},
                  {"list e", 2, "hexaplast: error: no component 'e'\n"},
                  {"list BoxROI --markdown", 2, "error: "},
                  {"list --plugin Absent", 6, "Absent"}});
}

class CommandPage : public Command {
 protected:
  std::string help(const std::string& path) { return hexaplast(path + " --help").out; }

  /// First words of the lines of a section of the help text.
  static std::set<std::string> entries(const std::string& help, const std::string& section) {
    std::set<std::string> found;
    const std::size_t begin = help.find(section + ":\n");
    if (begin == std::string::npos) return found;
    std::istringstream lines(help.substr(begin + section.size() + 2));
    for (std::string line; std::getline(lines, line) && !line.empty();) {
      std::smatch match;
      if (!std::regex_search(line, match, std::regex("^  ([^ ]+)"))) continue;
      std::istringstream names(match[1].str());
      for (std::string name; std::getline(names, name, ',');) found.insert(name);
    }
    return found;
  }

  /// Whether the help is that of a program in Python, which knows its options by itself.
  static bool is_of_program(const std::string& help) { return help.starts_with("usage: "); }

  /// Calls visit(path, help) for the command and every subcommand, however deep.
  template <class Visit>
  int for_each_command(const std::string& path, const Visit& visit) {
    const std::string text = help(path);
    visit(path, text);
    int count = 1;
    for (const std::string& name : entries(text, "Subcommands"))
      count += for_each_command(path.empty() ? name : path + " " + name, visit);
    return count;
  }

  /// What bash offers after these words, the last one unfinished.
  std::set<std::string> completed(const std::string& words) {
    const std::string bin = fs::path(HEXAPLAST_COMMAND).parent_path().string();
    write("ask.sh", "PATH=" + bin + ":$PATH; source '" + kLook + "completion.bash'\nCOMP_WORDS=(hexaplast " + words +
                        ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_hexaplast\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    const auto asked = shell("bash ask.sh");
    EXPECT_EQ(asked.code, 0) << asked.err;
    EXPECT_EQ(asked.err, "") << words;
    std::set<std::string> offered;
    std::istringstream lines(asked.out);
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) offered.insert(line);
    return offered;
  }
};

TEST_F(CommandPage, IsTheHelpOfEverySubcommand) {
  const Outcome printed = shell("bash '" + kLook + "man_page' '" HEXAPLAST_COMMAND "' 1.2.3");
  EXPECT_EQ(printed.code, 0) << printed.err;
  const std::string page = std::regex_replace(printed.out, std::regex(R"(\\-)"), "-");
  ASSERT_EQ(page.find(".TH HEXAPLAST 1"), 0u);
  const int count = for_each_command("", [&](const std::string& path, const std::string& text) {
    const std::string head = ".SH \"hexaplast" + (path.empty() ? "" : " " + path) + "\"\n.nf\n";
    const std::string help = text.substr(0, text.find_last_not_of('\n') + 1);
    // a program in Python breaks its lines as the terminal is wide
    EXPECT_TRUE(has(page, head + (is_of_program(text) ? "usage: " : help + "\n.fi\n"))) << path;
  });
  EXPECT_GT(count, 14) << "the walk has lost its object";
}

TEST_F(CommandPage, TellsOfAProgramThatLacksAPackageAndFailsWithAnyOther) {
  for (const int code : {5, 1}) {
    write("fake", "#!/bin/sh\nif [ \"$1\" = sweep ]; then echo 'needs numpy' >&2; exit " + std::to_string(code) +
                      "; fi\nprintf 'Subcommands:\\n  sweep  many runs\\n'\n");
    const Outcome printed = shell("chmod +x fake && bash '" + kLook + "man_page' ./fake 1.2.3");
    EXPECT_EQ(printed.code == 0, code == 5) << printed.err;
    EXPECT_EQ(has(printed.out, ".SH \"hexaplast sweep\"\n.nf\nneeds numpy\n.fi\n"), code == 5) << printed.out;
  }
}

// They are written by hand.
TEST_F(CommandPage, SynopsesOfTheDocumentationHaveEveryOption) {
  for (const auto& [command, page, beginning] : {std::tuple("run", "commands.md", "\nhexaplast run SCENE ["),
                                                 {"resume", "checkpoints.md", "\nhexaplast resume DIR ["}}) {
    const std::string text = content(std::string(HEXAPLAST_SOURCE_DIR) + "/docs/" + page);
    const std::size_t begin = text.find(beginning);
    ASSERT_NE(begin, std::string::npos) << page;
    const std::string synopsis = text.substr(begin, text.find("```", begin) - begin);
    for (const std::string& option : entries(help(command), "Options"))
      if (option != "-h" && option != "--help") {
        EXPECT_TRUE(std::regex_search(synopsis, std::regex("\\[" + option + "[ \\]]"))) << page << ": " << option;
      }
  }
}

TEST_F(CommandPage, CompletesEveryOptionOfEverySubcommand) {
  for_each_command("", [&](const std::string& path, const std::string& text) {
    std::set<std::string> expected = entries(text, is_of_program(text) ? "options" : "Options");
    if (is_of_program(text)) expected.insert("--help");  // behind a space there
    EXPECT_EQ(completed(path + " -"), expected) << path;
    EXPECT_EQ(completed(path + " ''"), entries(text, "Subcommands")) << path;
  });
  EXPECT_EQ(completed("ru"), (std::set<std::string>{"run"}));
  EXPECT_EQ(completed("run bar.scn --qu"), (std::set<std::string>{"--quiet"}));
}

}  // namespace
