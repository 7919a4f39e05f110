// SPDX-License-Identifier: LGPL-2.1-or-later
// The plugin of SOFA without SOFA: its components are registered, and have the Data of the attribute table. What they
// do in SOFA is tested there (plugin/sofa/tests).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "attributes/contact.hpp"
#include "attributes/hexaplast.hpp"
#include "attributes/parts.hpp"
#include "attributes/shapes.hpp"
#include "attributes/words.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/material/rows.hpp"
#include "sofa_standin.h"

extern "C" {
void initExternalModule();
const char* getModuleName();
const char* getModuleLicense();
void registerObjects(sofa::core::ObjectFactory* factory);
}

namespace hexaplast::sofa_plugin::test {
namespace {

const std::map<std::string, sofa::core::ObjectFactory::Entry>& components() {
  static const sofa::core::ObjectFactory made = [] {
    sofa::core::ObjectFactory filled;
    registerObjects(&filled);
    return filled;
  }();
  return made.entries;
}
auto make(std::string_view class_name) { return components().at(std::string(class_name)).make(); }

const std::vector<const attributes::Description*> kTables{&attributes::kHexahedronElastoplasticFEMForceField,
                                                          &attributes::kMaterialRegion,
                                                          &attributes::kTangentialForceField,
                                                          &attributes::kGraspForceField,
                                                          &attributes::kInstrumentContactInSofa,
                                                          &attributes::kTissueContactForceField,
                                                          &attributes::kTubeGridTopology,
                                                          &attributes::kSheetGridTopology,
                                                          &attributes::kSpherePatchGridTopology,
                                                          &attributes::kMultigridCGLinearSolver,
                                                          &attributes::kBladeInSofa,
                                                          &attributes::kProbe,
                                                          &attributes::kRunSettings,
                                                          &attributes::kAttributeChange};

TEST(SofaPlugin, RegistersEveryComponentWithTheHelpOfTheTable) {
  std::set<std::string_view> names, expected{"FinalStateExporter"};
  for (const auto& [name, entry] : components()) names.insert(name);
  for (const attributes::Description* table : kTables) {
    expected.insert(table->class_name);
    const auto& entry = components().at(std::string(table->class_name));
    EXPECT_EQ(entry.help, table->help);
    EXPECT_EQ(entry.template_name, table->category.ends_with("ForceField") ? "Vec3d" : "") << table->class_name;
  }
  EXPECT_EQ(names, expected);
}

TEST(SofaPlugin, HasAnExampleOfEveryComponentThatSofasRegressionTestsRun) {
  const std::string folder = HEXAPLAST_SOURCE_DIR "/plugin/sofa/";
  std::ostringstream list;
  list << std::ifstream(folder + "Hexaplast.regression-tests").rdbuf();
  for (const auto& [name, entry] : components()) {
    std::ostringstream scene;
    scene << std::ifstream(folder + "examples/" + name + ".scn").rdbuf();
    EXPECT_NE(scene.str().find("<" + name + " "), std::string::npos) << name;
    EXPECT_NE(list.str().find("\nexamples/" + name + ".scn 50 "), std::string::npos) << name;
  }
}

TEST(SofaPlugin, SaysWhoItIsAndTakesThreadsFromTheEnvironment) {
  EXPECT_STREQ(getModuleName(), "Hexaplast");
  EXPECT_STREQ(getModuleLicense(), "LGPL");
  const char* given = std::getenv("OMP_NUM_THREADS");
  const std::string before = given ? given : "";
  const int threads = num_threads();
  setenv("OMP_NUM_THREADS", std::to_string(threads + 1).c_str(), 1);
  initExternalModule();
  EXPECT_EQ(num_threads(), threads + 1);
  given ? setenv("OMP_NUM_THREADS", before.c_str(), 1) : unsetenv("OMP_NUM_THREADS");
  set_num_threads(threads);
}

TEST(SofaPlugin, HasADataWithTheDefaultOfEveryAttributeOfTheTable) {
  const std::set<std::string_view> of_sofa{"rayleighStiffness", "position", "hexahedra", "quads", "edges"};
  int num_defaults = 0;
  for (const attributes::Description* table : kTables) {
    const auto component = make(table->class_name);
    for (const attributes::Attribute& attribute : table->attributes) {
      if (attribute.type == attributes::Type::kLink) continue;
      SCOPED_TRACE(fmt::format("{}.{}", table->class_name, attribute.name));
      const auto* data = component->findData(std::string(attribute.name));
      ASSERT_TRUE(data);
      EXPECT_FALSE(data->isSet()) << "a default is not given";
      if (!of_sofa.contains(attribute.name)) {
        const bool is_output = attribute.access == attributes::Access::kOutput;
        EXPECT_EQ(data->isReadOnly(), is_output);
        EXPECT_EQ(data->getGroup() == "Outputs", is_output);
        EXPECT_TRUE(data->getHelp().starts_with(attribute.help)) << data->getHelp();
        EXPECT_NE(data->getHelp().find(attribute.unit), std::string::npos);
      }
      std::istringstream expected{std::string(attribute.initial)}, found(data->getValueString());
      for (std::string word, other; expected >> word; ++num_defaults) {
        ASSERT_TRUE(found >> other);
        if (attribute.type == attributes::Type::kWord || attribute.type == attributes::Type::kBool)
          EXPECT_EQ(other, word);
        else
          EXPECT_EQ(std::stod(other), std::stod(word));
      }
    }
  }
  EXPECT_GT(num_defaults, 40);
}

TEST(SofaPlugin, GroupsTheDataOfABodyAsTheRowsAre) {
  const auto check = [](const std::string& class_name, const auto& rows) {
    const auto made = make(class_name);
    for (const auto& row : rows) EXPECT_EQ(made->findData(std::string(row.name))->getGroup(), row.group) << row.name;
  };
  check("HexahedronElastoplasticFEMForceField", material_rows());
  check("HexahedronElastoplasticFEMForceField", settings_rows());
  check("MaterialRegion", material_rows());
  for (const auto& [class_name, data, group] : {std::tuple("GraspForceField", "keyTimes", "Path"),
                                                {"GraspForceField", "maxForce", "Grip"},
                                                {"InstrumentContactForceField", "radius", "Instrument"},
                                                {"TissueContactForceField", "friction", "Contact"},
                                                {"SheetGridTopology", "thickness", "Shape"}})
    EXPECT_EQ(make(class_name)->findData(data)->getGroup(), group) << class_name;
}

// Those that are made from their Data alone.
TEST(SofaPlugin, ItsComponentsNameAllThatIsWrongAtOnce) {
  struct Given {
    std::string data, text, reason;
  };
  const std::map<std::string, std::vector<Given>> cases{
      {"TubeGridTopology", {{"cells", "0 3 1", "0"}, {"length", "-1", "-1"}, {"bend", "9000", "9000"}}},
      {"SheetGridTopology", {{"cells", "1 1", ""}, {"size", "1", ""}, {"thickness", "0", "0 must be > 0"}}},
      {"SpherePatchGridTopology", {{"cells", "-1 1 1", ""}, {"angle", "180", "180"}}},
      {"MultigridCGLinearSolver",
       {{"preconditioner", "multigird", "'multigird' must be auto, multigrid or diagonal (did you mean 'multigrid'?)"},
        {"tolerance", "0", "0"},
        {"iterations", "0", "0"}}}};
  for (const auto& [class_name, given] : cases) {
    sofa_standin::messages().clear();
    const auto component = make(class_name);
    sofa::core::objectmodel::BaseObjectDescription description;
    for (const Given& each : given) description.attributes[each.data] = each.text;
    component->parse(&description);
    component->init();
    EXPECT_EQ(component->d_componentState.getValue(), sofa::core::objectmodel::ComponentState::Invalid);
    std::string said;
    for (const std::string& message : sofa_standin::messages()) said += message + "\n";
    for (const Given& each : given)
      EXPECT_NE(said.find(fmt::format("/{0}: error: {0}.{1}: {2}", class_name, each.data, each.reason)),
                std::string::npos)
          << each.data << " is missing in " << said;
  }
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
