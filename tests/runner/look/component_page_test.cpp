// SPDX-License-Identifier: LGPL-2.1-or-later
// docs/components.md is what the program prints, and every example on it runs.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "support/command.hpp"
#include "support/example_scene.hpp"

namespace {

using namespace hexaplast::support;

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

TEST_F(Command, TheComponentPageIsWhatTheProgramPrints) {
  const Outcome printed = succeeds("list --markdown");
  EXPECT_TRUE(printed.out == content(kPage)) << "run: hexaplast list --markdown > docs/components.md";
}

TEST_F(Command, EveryExampleOfTheComponentPageRunsWithoutComplaint) {
  const Json list = Json::parse(hexaplast("list --json").out);
  std::map<std::string, std::string> category_of;
  std::set<std::string> wanted;
  for (const Json& component : list["components"]) {
    category_of[component["name"]] = component["category"];
    if (!component["has_effect"]) continue;
    wanted.insert(component["name"]);
  }
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

TEST_F(Command, TheComponentPageNamesEveryAttributeWithItsComponent) {
  const std::string page = content(kPage);
  for (const Json& component : Json::parse(hexaplast("list --json").out)["components"]) {
    if (!component["has_effect"]) continue;
    const std::string name = component["name"];
    const std::size_t begin = page.find("\n### " + name + "\n");
    ASSERT_NE(begin, page.npos) << name;
    const std::string section = page.substr(begin, page.find("\n```xml", begin) - begin);
    for (const Json& attribute : component["attributes"]) {
      if (attribute["access"] == "ignored") continue;
      EXPECT_TRUE(has(section, "`" + std::string(attribute["name"]) + "`")) << name << attribute["name"];
    }
  }
}

TEST_F(Command, ListPrintsOneComponent) {
  const Outcome text = succeeds("list BoxROI");
  for (const char* part :
       {"BoxROI: ", "box: groups of six numbers [m]; default 0 0 0 1 1 1", "indices: whole numbers; computed"})
    EXPECT_TRUE(has(text.out, part));

  const Json json = Json::parse(hexaplast("list HexahedronElastoplasticFEMForceField --json").out);
  EXPECT_EQ(json["category"], "ForceField");
  const auto attribute = [&](const std::string& name) {
    return *std::find_if(json["attributes"].begin(), json["attributes"].end(),
                         [&](const Json& each) { return each["name"] == name; });
  };
  EXPECT_EQ(attribute("poissonRatio")["range"], Json::parse(R"({"least": 0, "below": 0.5})"));
  EXPECT_EQ(attribute("youngModulus")["unit"], "Pa");
  EXPECT_EQ(attribute("yieldNorm")["words"], Json::parse(R"(["vonMises", "frobenius", "spectral"])"));
}

TEST_F(Command, ListRefusesWhatIsNoComponent) {
  expect_refused({{"list BoxRO", 2, "hexaplast: error: no component 'BoxRO'\n  hint: did you mean 'BoxROI'?\n"},
                  {"list roi", 2, "no component 'roi'\n  hint: there are BoxROI, MeshROI, PlaneROI, SphereROI\n"},
                  {"list e", 2, "hexaplast: error: no component 'e'\n"},
                  {"list BoxROI --markdown", 2, "error: "},
                  {"list --plugin Absent", 6, "Absent"}});
}

}  // namespace
