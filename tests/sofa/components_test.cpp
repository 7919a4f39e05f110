// SPDX-License-Identifier: LGPL-2.1-or-later
// The components of the SOFA plugin beside the body, and what SOFA learns of them when it loads it.
#include <Hexaplast/AttributeChange.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "attributes/contact.hpp"
#include "attributes/hexaplast.hpp"
#include "attributes/shapes.hpp"
#include "attributes/words.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/material/rows.hpp"
#include "support/sofa_adapter.hpp"

extern "C" {
void initExternalModule();
const char* getModuleName();
const char* getModuleLicense();
}

namespace hexaplast::sofa_plugin::test {
namespace {

namespace fs = std::filesystem;

TEST(SofaPlugin, RegistersEveryComponentWithTheHelpOfTheTable) {
  std::set<std::string> names;
  for (const auto& [name, entry] : factory().entries) names.insert(name);
  EXPECT_EQ(names,
            (std::set<std::string>{"HexahedronElastoplasticFEMForceField", "TangentialForceField", "GraspForceField",
                                   "InstrumentContactForceField", "TissueContactForceField", "TubeGridTopology",
                                   "SheetGridTopology", "SpherePatchGridTopology", "MultigridCGLinearSolver",
                                   "FinalStateExporter", "Probe", "RunSettings", "AttributeChange", "MaterialRegion"}));
  for (const attributes::Description* each :
       {&attributes::kHexahedronElastoplasticFEMForceField, &attributes::kTangentialForceField,
        &attributes::kGraspForceField, &attributes::kInstrumentContactInSofa, &attributes::kTissueContactForceField,
        &attributes::kTubeGridTopology, &attributes::kSheetGridTopology, &attributes::kSpherePatchGridTopology,
        &attributes::kMultigridCGLinearSolver, &attributes::kProbe, &attributes::kRunSettings,
        &attributes::kAttributeChange, &attributes::kMaterialRegion}) {
    const auto& entry = factory().entries.at(std::string(each->class_name));
    EXPECT_EQ(entry.help, each->help);
    EXPECT_EQ(entry.template_name, each->category.ends_with("ForceField") ? "Vec3d" : "") << each->class_name;
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
  if (given)
    setenv("OMP_NUM_THREADS", before.c_str(), 1);
  else
    unsetenv("OMP_NUM_THREADS");
  set_num_threads(threads);
}

TEST(SofaPlugin, HasADataWithTheDefaultAndTheAliasesOfEveryAttributeOfTheTable) {
  const std::set<std::string_view> of_sofa{"rayleighStiffness", "position", "hexahedra", "quads", "edges"};
  int num_defaults = 0;
  for (const attributes::Description* each :
       {&attributes::kHexahedronElastoplasticFEMForceField, &attributes::kTangentialForceField,
        &attributes::kGraspForceField, &attributes::kInstrumentContactInSofa, &attributes::kTissueContactForceField,
        &attributes::kTubeGridTopology, &attributes::kSheetGridTopology, &attributes::kSpherePatchGridTopology,
        &attributes::kMultigridCGLinearSolver, &attributes::kProbe, &attributes::kRunSettings,
        &attributes::kAttributeChange, &attributes::kMaterialRegion}) {
    const auto component = factory().entries.at(std::string(each->class_name)).make();
    for (const attributes::Attribute& attribute : each->attributes) {
      if (attribute.type == attributes::Type::kLink) continue;
      const auto* data = component->findData(std::string(attribute.name));
      ASSERT_TRUE(data) << each->class_name << "." << attribute.name;
      EXPECT_FALSE(data->isSet()) << "a default is not given";
      if (!of_sofa.contains(attribute.name)) {
        const bool is_output = attribute.access == attributes::Access::kOutput;
        EXPECT_EQ(data->isReadOnly(), is_output) << attribute.name;
        EXPECT_EQ(data->getGroup() == "Outputs", is_output) << attribute.name;
        EXPECT_TRUE(data->getHelp().starts_with(attribute.help)) << attribute.name << ": " << data->getHelp();
        EXPECT_NE(data->getHelp().find(attribute.unit), std::string::npos) << attribute.name;
        for (const std::string_view alias : attributes::split_words(attribute.aliases))
          EXPECT_EQ(component->findData(std::string(alias)), data) << each->class_name << "." << alias;
      }
      std::istringstream expected{std::string(attribute.initial)}, found(data->getValueString());
      for (std::string word, other; expected >> word; ++num_defaults) {
        ASSERT_TRUE(found >> other) << each->class_name << "." << attribute.name;
        if (attribute.type == attributes::Type::kWord || attribute.type == attributes::Type::kBool)
          EXPECT_EQ(other, word) << attribute.name;
        else
          EXPECT_EQ(std::stod(other), std::stod(word)) << attribute.name;
      }
    }
  }
  EXPECT_GT(num_defaults, 40);
}

TEST(SofaPlugin, GroupsTheDataOfABodyAsTheRowsAre) {
  const auto check = [&](const std::string& class_name, const auto& rows) {
    const auto made = factory().entries.at(class_name).make();
    for (const auto& row : rows) EXPECT_EQ(made->findData(std::string(row.name))->getGroup(), row.group) << row.name;
  };
  check("HexahedronElastoplasticFEMForceField", material_rows());
  check("HexahedronElastoplasticFEMForceField", settings_rows());
  check("MaterialRegion", material_rows());
  const auto group_of = [&](const std::string& class_name, const std::string& name) {
    return factory().entries.at(class_name).make()->findData(name)->getGroup();
  };
  EXPECT_EQ(group_of("GraspForceField", "keyTimes"), "Path");
  EXPECT_EQ(group_of("GraspForceField", "maxForce"), "Grip");
  EXPECT_EQ(group_of("InstrumentContactForceField", "radius"), "Instrument");
  EXPECT_EQ(group_of("TissueContactForceField", "friction"), "Contact");
  EXPECT_EQ(group_of("SheetGridTopology", "thickness"), "Shape");
  const auto body = factory().entries.at("HexahedronElastoplasticFEMForceField").make();
  EXPECT_EQ(body->findData("drawMaterialShape"), body->findData("drawPlasticRestShape"));
}

TEST_F(Adapter, TangentialForcesTurnAboutTheAxis) {
  auto& field =
      make_field("TangentialForceField",
                 {{"indices", "4"}, {"axis", "0 0 2"}, {"centre", "0.01 0.02 0"}, {"times", "0"}, {"forces", "3"}});
  tell<AnimateBeginEvent>();
  const double across = deformed(4, 0) - 0.01, along = deformed(4, 1) - 0.02, reach = std::hypot(across, along);
  PointArray expected = zero;
  expected.row(4) << -3 * along / reach, 3 * across / reach, 0;
  EXPECT_TRUE(support::agrees(force(field, deformed), expected, 1e-14));
  EXPECT_EQ(energy(field, deformed), 0);
  EXPECT_NE(said().find("no potential energy"), std::string::npos) << said();
}

TEST_F(Adapter, TheInstrumentShowsWhatItHolds) {
  const double reach = (mesh.positions().row(0) - mesh.positions().row(1)).norm() / 2;
  std::ostringstream place;
  place.precision(17);
  place << mesh.positions().row(0);
  auto& field =
      make_field("GraspForceField", {{"keyTimes", "0"}, {"positions", place.str()}, {"radius", std::to_string(reach)}});
  EXPECT_TRUE(value<vector<sofa::Index>>(field, "grasped").empty());
  step(mesh.positions());
  EXPECT_EQ(value<vector<sofa::Index>>(field, "grasped"), vector<sofa::Index>{0}) << said();
  PointArray pulled = mesh.positions();
  pulled.row(0) += Eigen::RowVector3d(0.002, 0, 0);  // against a spring of 1000 N/m
  EXPECT_NEAR(energy(field, pulled), 1000 * 0.002 * 0.002 / 2, 1e-12);
}

// A dashpot of 7 N s/m on the one node that is held: df/dv = -7 there, in every form in which SOFA may ask for it.
TEST_F(Adapter, TheDashpotsOfTheInstrumentAreImplicit) {
  const double reach = (mesh.positions().row(0) - mesh.positions().row(1)).norm() / 2;
  std::ostringstream place;
  place.precision(17);
  place << mesh.positions().row(0);
  auto& field = make_field("GraspForceField", {{"keyTimes", "0"},
                                               {"positions", place.str()},
                                               {"radius", std::to_string(reach)},
                                               {"stiffness", "1000"},
                                               {"damping", "7"}});
  step(mesh.positions());
  force(field, mesh.positions());
  const PointArray dx = random.field(mesh.num_nodes(), 1);
  params.setKFactor(-0.001);
  params.setBFactor(-0.02);
  PointArray expected = zero;
  expected.row(0) = (0.001 * 1000 + 0.02 * 7) * dx.row(0);
  EXPECT_TRUE(support::agrees(product(field, dx), expected, 1e-14));

  DenseMatrix B(3 * mesh.num_nodes());
  unsigned int offset = 0;
  field.addBToMatrix(&B, 2, offset);
  sofa::core::behavior::DampingMatrix built;
  field.buildDampingMatrix(&built);
  for (int row = 0; row < B.values.rows(); ++row)
    for (int column = 0; column < B.values.cols(); ++column) {
      const double damping = row == column && row < 3 ? -7 : 0;
      EXPECT_EQ(B.values(row, column), 2 * damping);
      const auto entry = built.entries.find({row, column});
      EXPECT_EQ(entry == built.entries.end() ? 0 : entry->second, damping);
    }
}

TEST_F(Adapter, TopologiesHandTheirGridToTheHost) {
  auto& sheet = dynamic_cast<MeshTopology&>(
      make("SheetGridTopology", {{"cells", "2 3 1"}, {"size", "0.2 0.6"}, {"thickness", "0.01"}}));
  sheet.init();
  EXPECT_EQ(sheet.getNbHexahedra(), 6u);
  const auto x = view(sheet.d_seqPoints.getValue());
  ASSERT_EQ(x.rows(), 3 * 4 * 2);
  const Vec3 size = x.colwise().maxCoeff() - x.colwise().minCoeff();
  EXPECT_TRUE(support::agrees(size, Vec3(0.2, 0.6, 0.01), 1e-14));
  for (const auto& hexahedron : sheet.getHexahedra())
    for (const sofa::Index node : hexahedron) EXPECT_LT(node, 24u);

  BaseComponent& nothing = make("SheetGridTopology", {{"cells", "0 3 1"}});
  nothing.init();
  EXPECT_TRUE(nothing.isComponentStateInvalid());
  EXPECT_NE(said().find("SheetGridTopology.cells"), std::string::npos) << said();
}

TEST_F(Adapter, EveryComponentNamesAllThatIsWrongAtOnce) {
  const struct {
    std::string class_name;
    Attributes attributes;
  } cases[] = {
      {"GraspForceField",
       {{"keyTimes", "1 0"}, {"positions", "0 0 0 1 0 0"}, {"stiffness", "-1"}, {"rayleighStiffness", "-2"}}},
      {"TangentialForceField", {{"indices", "99"}, {"groupSize", "0"}, {"axis", "0 0 0"}}},
      {"TubeGridTopology", {{"cells", "0 3 1"}, {"length", "-1"}, {"bend", "9000"}}},
      {"SheetGridTopology", {{"cells", "1 1"}, {"size", "1"}, {"thickness", "0"}}},
      {"SpherePatchGridTopology", {{"cells", "-1 1 1"}, {"angle", "180"}}},
      {"MultigridCGLinearSolver", {{"preconditioner", "multigird"}, {"tolerance", "0"}, {"iterations", "0"}}},
  };
  for (const auto& each : cases) {
    sofa_standin::messages().clear();
    BaseComponent& component = make(each.class_name, each.attributes);
    component.init();
    EXPECT_TRUE(component.isComponentStateInvalid());
    for (const auto& [name, text] : each.attributes) {
      if (name == "positions") continue;
      EXPECT_NE(said().find(": error: " + each.class_name + "." + name + ": "), std::string::npos)
          << name << " is missing in " << said();
    }
  }
  EXPECT_NE(said().find("'multigird' must be auto, multigrid or diagonal (did you mean 'multigrid'?)"),
            std::string::npos)
      << said();
}

TEST_F(Adapter, TheExporterWritesTheStateAfterItsStep) {
  const fs::path file = fs::path(testing::TempDir()) / ("sofa_adapter_final_" + std::to_string(getpid()) + ".json");
  fs::remove(file);
  auto& field = make_body(kPlastic);
  make("FinalStateExporter", {{"filename", file.string()}, {"exportAtStep", "2"}}).init();
  step(deformed);
  EXPECT_FALSE(fs::exists(file));
  step(stretched);
  ASSERT_TRUE(fs::exists(file)) << said();
  const auto json = nlohmann::json::parse(std::ifstream(file));
  fs::remove(file);
  for (int n = 0; n < mesh.num_nodes(); ++n)
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(json["positions"][n][i].get<double>(), stretched(n, i));
      EXPECT_EQ(json["material_positions"][n][i].get<double>(), field.body()->plastic_rest_positions()(n, i));
    }

  BaseComponent& nameless = make("FinalStateExporter", {{"exportAtStep", "2"}});
  nameless.init();
  EXPECT_TRUE(nameless.isComponentStateInvalid());
}

TEST_F(Adapter, SettingsOfARunAreThereForScripts) {
  BaseComponent& settings = make("RunSettings", {{"steps", "300"}});
  EXPECT_EQ(value<int>(settings, "steps"), 300);
  EXPECT_EQ(value<int>(settings, "outputEvery"), 25);
}

class AttributeChangeAdapter : public Adapter {};

TEST_F(AttributeChangeAdapter, ChangesADataBeforeTheStepOfItsTime) {
  auto& settings = make("RunSettings", {{"steps", "3"}});
  auto& change = dynamic_cast<AttributeChange&>(make("AttributeChange", {{"attribute", "steps"}, {"values", "5; ;7"}}));
  change.d_keyTimes.setValue({1.5 * kStep, 3 * kStep, 3.5 * kStep});
  change.l_component.set(&settings);
  change.bwdInit();
  ASSERT_FALSE(change.isComponentStateInvalid());
  const auto* steps = settings.findData("steps");
  const auto expect = [&](const std::string& value, bool is_set) {
    tell<AnimateBeginEvent>();
    EXPECT_EQ(steps->getValueString(), value) << root.getTime();
    EXPECT_EQ(steps->isSet(), is_set) << root.getTime();
    root.setTime(root.getTime() + kStep);
  };
  expect("3", true);
  expect("3", true);
  expect("5", true);
  const int counter = steps->getCounter();
  root.setTime(3.2 * kStep);
  expect("3", false);
  EXPECT_NE(steps->getCounter(), counter) << "who looks at it sees that it has changed";
  expect("7", true);
  change.reset();
  EXPECT_EQ(steps->getValueString(), "3");
}

// SOFA writes six digits, and forgets only that a value was given.
TEST_F(AttributeChangeAdapter, PutsBackAllDigitsAndTheDefault) {
  auto& grasp = make("GraspForceField", {});
  auto* stiffness = dynamic_cast<Data<SReal>*>(grasp.findData("stiffness"));
  ASSERT_TRUE(stiffness);
  const double initial = stiffness->getValue();
  auto& change =
      dynamic_cast<AttributeChange&>(make("AttributeChange", {{"attribute", "stiffness"}, {"values", "7;"}}));
  change.d_keyTimes.setValue({0, kStep});
  change.l_component.set(&grasp);
  const double given = 123.456789012345;
  stiffness->setValue(given);
  change.bwdInit();
  tell<AnimateBeginEvent>();
  EXPECT_EQ(stiffness->getValue(), 7);
  root.setTime(kStep);
  tell<AnimateBeginEvent>();
  EXPECT_EQ(stiffness->getValue(), initial);
  EXPECT_FALSE(stiffness->isSet());
  change.reset();
  EXPECT_EQ(stiffness->getValue(), given);
  EXPECT_TRUE(stiffness->isSet());
}

TEST_F(AttributeChangeAdapter, TakesThePlaceOfALink) {
  auto& grasp = make("GraspForceField", {});
  auto* stiffness = dynamic_cast<Data<SReal>*>(grasp.findData("stiffness"));
  Data<SReal> source;
  source.setValue(300);
  stiffness->setParent(&source);
  auto& change = dynamic_cast<AttributeChange&>(make("AttributeChange", {{"attribute", "stiffness"}, {"values", "7"}}));
  change.d_keyTimes.setValue({0});
  change.l_component.set(&grasp);
  change.bwdInit();
  EXPECT_EQ(stiffness->getValue(), 300);
  tell<AnimateBeginEvent>();
  source.setValue(400);
  EXPECT_EQ(stiffness->getValue(), 7);
  change.reset();
  EXPECT_EQ(stiffness->getValue(), 400);
}

TEST_F(AttributeChangeAdapter, RefusesADataThatIsNotThere) {
  auto& settings = make("RunSettings", {});
  auto& change = dynamic_cast<AttributeChange&>(make("AttributeChange", {{"attribute", "stepps"}, {"values", "5"}}));
  change.l_component.set(&settings);
  change.bwdInit();
  EXPECT_TRUE(change.isComponentStateInvalid());
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
