// SPDX-License-Identifier: LGPL-2.1-or-later
// The SOFA plugin's own files over the stand-in for SOFA's headers (sofa_standin/README.md): they compile, and do the
// right thing at each of SOFA's calls. plugin/sofa/tests has the tests in SOFA itself.
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/init.h>
#include <gtest/gtest.h>
#include <sofa/component/topology/container/dynamic/HexahedronSetTopologyModifier.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/core/visual/VisualParams.h>
#include <sofa/linearalgebra/BaseMatrix.h>
#include <sofa/simulation/AnimateBeginEvent.h>
#include <sofa/simulation/AnimateEndEvent.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "attributes/hexaplast.hpp"
#include "attributes/shapes.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

extern "C" {
void initExternalModule();
const char* getModuleName();
const char* getModuleLicense();
void registerObjects(sofa::core::ObjectFactory* factory);
}

namespace hexaplast::sofa_plugin {

// The solver's file needs SOFA's operations on the vectors of a graph, which the stand-in does not have.
void register_solver(sofa::core::ObjectFactory*) {}

namespace {

namespace fs = std::filesystem;
using sofa::component::topology::container::constant::MeshTopology;
using sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier;
using sofa::core::objectmodel::BaseComponent;
using sofa::core::objectmodel::BaseContext;
using sofa::core::objectmodel::Data;
using sofa::core::objectmodel::New;
using sofa::simulation::AnimateBeginEvent;
using sofa::simulation::AnimateEndEvent;
using sofa::type::vector;
using support::Random;

constexpr double kStep = 0.02;  // [s]

using Attributes = std::vector<std::pair<std::string, std::string>>;

const Attributes kPlastic{{"youngModulus", "7000"},   {"poissonRatio", "0.3"},      {"yieldStress", "100"},
                          {"plasticFlowRate", "2"},   {"rotationYield", "0.01"},    {"rotationFlowRate", "2"},
                          {"hardening", "0.2"},       {"volumeRestitution", "1.5"}, {"averagingSteps", "2"},
                          {"yieldNorm", "frobenius"}, {"averaging", "localGlobal"}};

/// The same by hand.
Material plastic_material() {
  Material m;
  m.young_modulus = 7000;
  m.poisson_ratio = 0.3;
  m.yield_stress = 100;
  m.flow_rate = 2;
  m.rotation_yield = 0.01;
  m.rotation_flow_rate = 2;
  m.hardening = 0.2;
  return m;
}
Settings plastic_settings() {
  Settings s;
  s.volume_restitution = 1.5;
  s.averaging_steps = 2;
  s.yield_norm = YieldNorm::kFrobenius;
  s.averaging = AveragingMethod::kLocalGlobal;
  return s;
}

Attributes with(Attributes attributes, const Attributes& more) {
  attributes.insert(attributes.end(), more.begin(), more.end());
  return attributes;
}

const sofa::core::ObjectFactory& factory() {
  static const sofa::core::ObjectFactory made = [] {
    sofa::core::ObjectFactory filled;
    registerObjects(&filled);
    return filled;
  }();
  return made;
}

std::string said() {
  std::string all;
  for (const auto& message : sofa_standin::messages()) all += message.text + "\n";
  return all;
}

std::string history_of(const Body& body) {
  StateHash hash;
  body.add_to(hash);
  return hash.text();
}

/// Sums what is added, with our own rows and columns behind it.
class DenseMatrix final : public sofa::linearalgebra::BaseMatrix {
 public:
  explicit DenseMatrix(int size) : values(Eigen::MatrixXd::Zero(size, size)) {}
  void add(int row, int column, SReal value) override { values(row, column) += value; }

  Eigen::MatrixXd values;
};

/// 2 x 2 x 3 crooked hexahedra in a node below the root, and the components that a test gives it.
class Adapter : public testing::Test {
 protected:
  Adapter() {
    sofa_standin::messages().clear();
    root.setDt(kStep);
    auto& hexahedra = *cells.d_seqHexahedra.beginEdit();
    for (const Hexahedron& corners : mesh.hexahedra()) {
      auto& hexahedron = hexahedra.emplace_back();
      for (std::size_t a = 0; a < corners.size(); ++a) hexahedron[a] = static_cast<sofa::Index>(corners[a]);
    }
    for (const auto& field : {nodes.writeRestPositions(), nodes.writePositions(), nodes.writeVelocities()}) {
      auto writable = field;
      writable.resize(static_cast<std::size_t>(mesh.num_nodes()));
    }
    view(nodes.writeRestPositions().wref()) = mesh.positions();
    view(nodes.writePositions().wref()) = mesh.positions();
  }

  BaseComponent& make(const std::string& class_name, const Attributes& attributes) {
    BaseComponent& made = tissue.add(factory().entries.at(class_name).make(), "the" + class_name);
    for (const auto& [name, text] : attributes) EXPECT_TRUE(made.findData(name)->read(text)) << name;
    return made;
  }
  GuestForceField& make_field(const std::string& class_name, const Attributes& attributes) {
    auto& field = dynamic_cast<GuestForceField&>(make(class_name, attributes));
    field.init();
    return field;
  }
  HexahedronElastoplasticFEMForceField& make_body(const Attributes& attributes) {
    return dynamic_cast<HexahedronElastoplasticFEMForceField&>(
        make_field("HexahedronElastoplasticFEMForceField", attributes));
  }

  void move_to(const PointArray& x) { view(nodes.writePositions().wref()) = x; }
  template <class Event>
  void tell() {
    Event event(kStep);
    root.for_each([&](BaseComponent& each) {
      if (each.f_listening.getValue()) each.handleEvent(&event);
    });
  }
  /// A step that ends at x.
  void step(const PointArray& x) {
    tell<AnimateBeginEvent>();
    move_to(x);
    tell<AnimateEndEvent>();
    root.setTime(root.getTime() + kStep);
  }

  /// `f` plus the forces at x.
  PointArray force(GuestForceField& field, const PointArray& x, PointArray f) const {
    Data<DataTypes::VecCoord> position;
    Data<DataTypes::VecDeriv> forces, velocity;
    for (auto* data : {&position, &forces, &velocity}) data->beginEdit()->resize(static_cast<std::size_t>(x.rows()));
    view(*position.beginEdit()) = x;
    view(*forces.beginEdit()) = f;
    field.addForce(&params, forces, position, velocity);
    return view(forces.getValue());
  }
  PointArray force(GuestForceField& field, const PointArray& x) const { return force(field, x, zero); }

  PointArray product(GuestForceField& field, const PointArray& dx) const {
    Data<DataTypes::VecDeriv> direction, forces;
    for (auto* data : {&direction, &forces}) data->beginEdit()->resize(static_cast<std::size_t>(dx.rows()));
    view(*direction.beginEdit()) = dx;
    field.addDForce(&params, forces, direction);
    return view(forces.getValue());
  }
  double energy(GuestForceField& field, const PointArray& x) const {
    Data<DataTypes::VecCoord> position;
    position.beginEdit()->resize(static_cast<std::size_t>(x.rows()));
    view(*position.beginEdit()) = x;
    return field.getPotentialEnergy(&params, position);
  }
  static Eigen::VectorXd flat(const PointArray& field) {
    return Eigen::Map<const Eigen::VectorXd>(field.data(), field.size());
  }

  template <class T>
  static const T& value(const BaseComponent& component, const std::string& name) {
    return dynamic_cast<const Data<T>&>(*component.findData(name)).getValue();
  }

  const HexMesh mesh = support::distorted_block({2, 2, 3}, 0.1, 0.1, 11);
  const PointArray zero = PointArray::Zero(mesh.num_nodes(), 3);
  Random random{12};
  const PointArray deformed = mesh.positions() + random.field(mesh.num_nodes(), 0.015);
  const PointArray stretched = mesh.positions() * Eigen::Vector3d(0.9, 0.95, 1.3).asDiagonal();
  sofa::core::MechanicalParams params;

  BaseContext root;
  BaseContext& tissue = root.add_child("tissue");
  MeshTopology& cells = tissue.add(New<MeshTopology>::make(), "cells");
  MechanicalState& nodes = tissue.add(New<MechanicalState>::make(), "nodes");
};

TEST(SofaPlugin, RegistersEveryComponentWithTheHelpOfTheTable) {
  std::set<std::string> names;
  for (const auto& [name, entry] : factory().entries) names.insert(name);
  EXPECT_EQ(names, (std::set<std::string>{"HexahedronElastoplasticFEMForceField", "TangentialForceField",
                                          "GraspForceField", "TubeGridTopology", "SheetGridTopology",
                                          "SpherePatchGridTopology", "FinalStateExporter", "RunSettings"}));
  for (const attributes::Description* each :
       {&attributes::kHexahedronElastoplasticFEMForceField, &attributes::kTangentialForceField,
        &attributes::kGraspForceField, &attributes::kTubeGridTopology, &attributes::kSheetGridTopology,
        &attributes::kSpherePatchGridTopology, &attributes::kRunSettings}) {
    const auto& entry = factory().entries.at(std::string(each->class_name));
    EXPECT_EQ(entry.help, each->help);
    EXPECT_EQ(entry.template_name, each->category == "ForceField" ? "Vec3d" : "") << each->class_name;
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

TEST(SofaPlugin, HasADataWithTheDefaultForEveryAttributeOfTheTable) {
  int num_defaults = 0;
  for (const attributes::Description* each :
       {&attributes::kHexahedronElastoplasticFEMForceField, &attributes::kTangentialForceField,
        &attributes::kGraspForceField, &attributes::kTubeGridTopology, &attributes::kSheetGridTopology,
        &attributes::kSpherePatchGridTopology, &attributes::kRunSettings}) {
    const auto component = factory().entries.at(std::string(each->class_name)).make();
    for (const attributes::Attribute& attribute : each->attributes) {
      if (attribute.type == attributes::Type::kLink) continue;
      const auto* data = component->findData(std::string(attribute.name));
      ASSERT_TRUE(data) << each->class_name << "." << attribute.name;
      EXPECT_FALSE(data->isSet()) << "a default is not given";
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

TEST_F(Adapter, OnlyTheEndOfAStepFlowsAndOnce) {
  auto& field = make_body(kPlastic);
  Body expected(mesh, {plastic_material()}, plastic_settings());
  const std::string virgin = history_of(expected);
  sofa::core::visual::VisualParams vparams;
  sofa::core::ExecParams eparams;
  params.setKFactor(1);

  const auto evaluate = [&] {
    for (const PointArray& x : {deformed, stretched}) {
      force(field, x);
      product(field, deformed);
      energy(field, x);
      DenseMatrix K(3 * mesh.num_nodes());
      unsigned int offset = 0;
      field.addKToMatrix(&K, 1, offset);
      sofa::core::behavior::StiffnessMatrix built;
      field.buildStiffnessMatrix(&built);
      field.draw(&vparams);
      field.computeBBox(&eparams);
    }
  };

  PointArray x = mesh.positions();
  for (int i = 1; i <= 5; ++i) {
    evaluate();
    tell<AnimateBeginEvent>();
    evaluate();
    x = mesh.positions() + 0.2 * i * (stretched - mesh.positions()) + random.field(mesh.num_nodes(), 0.003);
    move_to(x);
    evaluate();
    ASSERT_EQ(history_of(*field.guest()->body()), history_of(expected)) << "before the end of step " << i;
    tell<AnimateEndEvent>();
    expected.flow(x, kStep);
    ASSERT_EQ(history_of(*field.guest()->body()), history_of(expected)) << "after the end of step " << i;
  }
  EXPECT_NE(history_of(expected), virgin) << "something flowed";

  field.reset();
  EXPECT_EQ(history_of(*field.guest()->body()), virgin);
  EXPECT_EQ(said(), "");
}

TEST_F(Adapter, AddsTheForcesAndTheEnergyOfTheBody) {
  auto& field = make_body(kPlastic);
  Body body(mesh, {plastic_material()}, plastic_settings());
  PointArray expected = PointArray::Ones(mesh.num_nodes(), 3);
  body.linearize(deformed);
  body.add_force(expected);
  EXPECT_EQ(force(field, deformed, PointArray::Ones(mesh.num_nodes(), 3)), expected);
  EXPECT_EQ(energy(field, stretched), body.energy(stretched));
  EXPECT_GT(body.energy(stretched), 0);
}

TEST_F(Adapter, ScalesTheProductByTheFactorsOfTheHost) {
  auto& field = make_body(with(kPlastic, {{"rayleighStiffness", "0.1"}}));
  force(field, deformed);
  Body body(mesh, {plastic_material()}, plastic_settings());
  body.linearize(deformed);
  params.setKFactor(-0.02);
  params.setBFactor(-0.5);
  PointArray expected = zero;
  body.add_stiffness_product(-0.02 - 0.5 * 0.1, stretched, expected);
  EXPECT_EQ(product(field, stretched), expected);
}

TEST_F(Adapter, FillsBothKindsOfMatrixWithTheProduct) {
  auto& field = make_body(kPlastic);
  force(field, deformed);
  params.setKFactor(1);
  const PointArray dx = random.field(mesh.num_nodes(), 0.01);
  const Eigen::VectorXd expected = flat(product(field, dx));

  const int size = 3 * mesh.num_nodes();
  DenseMatrix K(size + 6);
  unsigned int offset = 6;
  field.addKToMatrix(&K, 2, offset);
  EXPECT_TRUE(
      support::agrees((K.values.bottomRightCorner(size, size) * flat(dx)).eval(), (2 * expected).eval(), 1e-12));
  EXPECT_TRUE(K.values.topRows(6).isZero(0) && K.values.leftCols(6).isZero(0)) << "rows of others";

  sofa::core::behavior::StiffnessMatrix built;
  field.buildStiffnessMatrix(&built);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(size);
  for (const auto& [at, entry] : built.entries) sum[at.first] += entry * flat(dx)[at.second];
  EXPECT_TRUE(support::agrees(sum, expected, 1e-12));
}

TEST_F(Adapter, ShowsThePlasticStateWhenItIsRead) {
  auto& field = make_body(kPlastic);
  EXPECT_EQ(value<vector<SReal>>(field, "plasticStrain"), vector<SReal>(mesh.num_elements(), 0));
  const auto& data = *field.findData("plasticStrain");
  EXPECT_TRUE(data.isReadOnly());
  EXPECT_EQ(data.getGroup(), "Outputs");
  EXPECT_EQ(data.getHelp().find("Accumulated plastic strain of each hexahedron"), 0u) << data.getHelp();

  const int counter = data.getCounter();
  step(stretched);
  EXPECT_EQ(data.getCounter(), counter) << "computed though nobody reads it";
  const ElementFields fields = field.guest()->body()->fields(stretched);
  const auto& strain = value<vector<SReal>>(field, "plasticStrain");
  ASSERT_EQ(strain.size(), fields.plastic_strain.size());
  for (std::size_t e = 0; e < strain.size(); ++e) EXPECT_EQ(strain[e], fields.plastic_strain[e]);
  EXPECT_GT(strain[0], 0);
  EXPECT_GT(data.getCounter(), counter);
  EXPECT_EQ(PointArray(view(value<DataTypes::VecCoord>(field, "materialPositions"))),
            field.guest()->body()->history().material);
  EXPECT_TRUE(value<vector<sofa::Index>>(field, "removed").empty());
  field.reset();
  EXPECT_EQ(value<vector<SReal>>(field, "plasticStrain"), vector<SReal>(mesh.num_elements(), 0));
}

TEST_F(Adapter, RefusesBadValuesAndStopsTheAnimation) {
  const struct {
    Attributes attributes;
    std::string name, value;
  } cases[] = {
      {{{"yieldStress", "-1"}}, "HexahedronElastoplasticFEMForceField.yieldStress", "-1"},
      {{{"poissonRatio", "0.3 0.5"}}, "HexahedronElastoplasticFEMForceField.poissonRatio", "0.5"},
      {{{"averaging", "best"}}, "HexahedronElastoplasticFEMForceField.averaging", "best"},
      {{{"youngModulus", "1 2 3"}}, "youngModulus", "3"},
  };
  for (const auto& each : cases) {
    sofa_standin::messages().clear();
    root.setAnimate(true);
    auto& field = dynamic_cast<GuestForceField&>(make("HexahedronElastoplasticFEMForceField", each.attributes));
    field.setDefinitionSourceFileName("liver.scn");
    field.setDefinitionSourceFilePos(7);
    field.init();
    EXPECT_TRUE(field.isComponentStateInvalid()) << each.name;
    EXPECT_FALSE(root.getAnimate()) << each.name;
    for (const std::string& part : {std::string("liver.scn:7: error"), each.name, each.value})
      EXPECT_NE(said().find(part), std::string::npos) << part << " is missing in: " << said();
    EXPECT_EQ(force(field, deformed), zero) << "an invalid component has no part in the scene";
    tell<AnimateEndEvent>();
  }
}

TEST_F(Adapter, PassesWarningsOnAndWorks) {
  auto& field = make_body(with(kPlastic, {{"plasticFlowRate", "4"}}));
  step(stretched);
  ASSERT_EQ(sofa_standin::messages().size(), 1u) << said();
  EXPECT_EQ(sofa_standin::messages()[0].severity, sofa_standin::Severity::kWarning);
  EXPECT_NE(said().find("plasticFlowRate = 4"), std::string::npos) << said();
  EXPECT_FALSE(field.isComponentStateInvalid());
  EXPECT_TRUE(root.getAnimate());
}

TEST_F(Adapter, RefusesAPlaceWithoutStateOrTopology) {
  BaseContext elsewhere;
  const auto lonely = [&] {
    return std::dynamic_pointer_cast<GuestForceField>(
        factory().entries.at("HexahedronElastoplasticFEMForceField").make());
  };
  auto& without_topology = elsewhere.add(lonely(), "body");
  without_topology.init();
  EXPECT_TRUE(without_topology.isComponentStateInvalid());
  EXPECT_NE(said().find("needs a topology"), std::string::npos) << said();

  elsewhere.add(New<MeshTopology>::make(), "cells");
  auto& without_state = elsewhere.add(lonely(), "body");
  without_state.init();
  EXPECT_TRUE(without_state.isComponentStateInvalid());
  EXPECT_NE(said().find("needs a MechanicalObject"), std::string::npos) << said();
}

TEST_F(Adapter, StopsWhereTheStepIsLostAndKeepsTheHistory) {
  auto& field = make_body(kPlastic);
  step(stretched);
  const std::string before = history_of(*field.guest()->body());
  PointArray lost = stretched;
  lost(4, 1) = std::numeric_limits<double>::quiet_NaN();
  step(lost);
  EXPECT_TRUE(field.isComponentStateInvalid());
  EXPECT_FALSE(root.getAnimate());
  EXPECT_NE(said(), "");
  EXPECT_EQ(history_of(*field.guest()->body()), before);
  step(stretched);
  EXPECT_EQ(history_of(*field.guest()->body()), before) << "an invalid component flows no more";
}

TEST_F(Adapter, TakesANewMaterialByReinitOrWithTheNextStep) {
  auto& field = make_body(kPlastic);
  step(stretched);
  const std::string flowed = history_of(*field.guest()->body());
  const PointArray f = force(field, deformed);

  field.findData("youngModulus")->read("21000");
  EXPECT_EQ(force(field, deformed), f) << "nothing changes within a step";
  field.reinit();
  EXPECT_TRUE(support::agrees(force(field, deformed), (3 * f).eval(), 1e-12));
  EXPECT_EQ(history_of(*field.guest()->body()), flowed);

  field.findData("youngModulus")->read("7000");
  tell<AnimateBeginEvent>();
  EXPECT_EQ(force(field, deformed), f);

  EXPECT_EQ(said(), "");
  field.findData("gradient")->read("vertex");
  field.reinit();
  EXPECT_TRUE(field.isComponentStateInvalid());
  EXPECT_NE(said().find("may change during a run"), std::string::npos) << said();

  field.findData("gradient")->read("blended");
  field.reinit();
  EXPECT_FALSE(field.isComponentStateInvalid()) << "it works again once the value is taken back";
}

TEST_F(Adapter, DrawsTheSurfaceInColoursOfPlasticStrain) {
  auto& field = make_body(kPlastic);
  const sofa::type::RGBAColor blue{0, 0, 1, 1}, red{1, 0, 0, 1};
  const std::size_t num_corners = 4 * mesh.boundary_faces().size();

  sofa::core::visual::VisualParams virgin;
  field.draw(&virgin);
  ASSERT_EQ(virgin.tool.quads.size(), 1u);
  EXPECT_EQ(virgin.tool.quads[0].corners.size(), num_corners);
  EXPECT_EQ(virgin.tool.quads[0].colours, std::vector<sofa::type::RGBAColor>(num_corners, blue));
  EXPECT_TRUE(virgin.tool.lines.empty());
  EXPECT_EQ(virgin.tool.open_states, 0) << "leaves the tool as it was";

  // the upper half alone
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 0.15) x(n, 2) += 0.5 * (x(n, 2) - 0.15);
  step(x);
  dynamic_cast<Data<bool>&>(*field.findData("drawMaterialShape")).setValue(true);
  sofa::core::visual::VisualParams plastic;
  field.draw(&plastic);
  const auto& drawn = plastic.tool.quads.at(0);
  ASSERT_EQ(drawn.colours.size(), drawn.corners.size());
  std::set<float> shades;
  for (const auto& colour : drawn.colours) shades.insert(colour.r);
  EXPECT_GT(std::count(drawn.colours.begin(), drawn.colours.end(), red), 0) << "the most strained";
  EXPECT_LT(*shades.begin(), 0.5f) << "the least strained";
  EXPECT_GT(shades.size(), 2u);
  const auto faces = mesh.boundary_faces();
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i) EXPECT_EQ(drawn.corners[k][i], x(faces[0][k], i));
  ASSERT_EQ(plastic.tool.lines.size(), 1u);
  EXPECT_EQ(plastic.tool.lines[0].ends.size(), 2 * num_corners);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(plastic.tool.lines[0].ends[0][i], field.guest()->body()->history().material(faces[0][0], i));

  sofa::core::visual::VisualParams hidden;
  hidden.flags.show_force_fields = false;
  field.draw(&hidden);
  EXPECT_TRUE(hidden.tool.quads.empty());
}

TEST_F(Adapter, BoundsTheBody) {
  auto& field = make_body(kPlastic);
  move_to(stretched);
  sofa::core::ExecParams eparams;
  field.computeBBox(&eparams);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(field.f_bbox.getValue().least[i], stretched.col(i).minCoeff());
    EXPECT_EQ(field.f_bbox.getValue().most[i], stretched.col(i).maxCoeff());
  }
}

TEST_F(Adapter, LosesTheHexahedraThatTheHostRemoves) {
  auto& modifier = tissue.add(New<HexahedronSetTopologyModifier>::make(), "modifier");
  modifier.removeIsolated.setValue(false);
  auto& field = make_body(kPlastic);
  modifier.removeHexahedra({3});
  EXPECT_EQ(field.guest()->body()->history().removed, std::vector<int>{3});
  modifier.removeHexahedra({0, 3});  // the last one has taken the place of number 3
  const std::vector<unsigned char> alive{0, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0};
  EXPECT_EQ(field.guest()->body()->history().alive, alive);
  step(mesh.positions());
  EXPECT_EQ(value<vector<sofa::Index>>(field, "removed").size(), 3u);
  field.reset();
  EXPECT_EQ(field.guest()->body()->history().alive, alive) << "the topology stays torn";
  EXPECT_FALSE(field.isComponentStateInvalid()) << said();
}

TEST_F(Adapter, TearsTheTopologyOfTheHost) {
  auto& modifier = tissue.add(New<HexahedronSetTopologyModifier>::make(), "modifier");
  modifier.removeIsolated.setValue(false);
  auto& field = make_body(with(kPlastic, {{"fractureStretch", "1.001"}}));
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n)
    if (x(n, 2) > 0.25) x(n, 2) += 0.1;  // the upper slice alone
  for (int i = 0; i < 10; ++i) step(x);
  const std::vector<int>& removed = field.guest()->body()->history().removed;
  ASSERT_FALSE(removed.empty());
  ASSERT_LT(removed.size(), 12u);
  EXPECT_EQ(cells.getNbHexahedra(), 12u - removed.size());
  std::set<Hexahedron> left, expected;
  for (const auto& hexahedron : cells.getHexahedra()) {
    Hexahedron corners;
    for (std::size_t a = 0; a < corners.size(); ++a) corners[a] = static_cast<int>(hexahedron[a]);
    left.insert(corners);
  }
  for (int e = 0; e < mesh.num_elements(); ++e)
    if (field.guest()->body()->history().alive[e]) expected.insert(mesh.hexahedra()[e]);
  EXPECT_EQ(left, expected);
}

TEST_F(Adapter, LeavesATopologyWholeThatWouldLoseNodes) {
  auto& modifier = tissue.add(New<HexahedronSetTopologyModifier>::make(), "modifier");
  auto& field = make_body(with(kPlastic, {{"fractureStretch", "1.001"}}));
  for (int i = 0; i < 10; ++i) step(stretched);
  EXPECT_FALSE(field.guest()->body()->history().removed.empty());
  EXPECT_EQ(cells.getNbHexahedra(), 12u);
  EXPECT_NE(said().find("removeIsolated must be false"), std::string::npos) << said();
  EXPECT_FALSE(field.isComponentStateInvalid());

  modifier.announce(cells, sofa::core::topology::TopologyChange(sofa::core::topology::POINTSREMOVED));
  EXPECT_TRUE(field.isComponentStateInvalid()) << "numbers of nodes are lost";
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
      EXPECT_EQ(json["material_positions"][n][i].get<double>(), field.guest()->body()->history().material(n, i));
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

}  // namespace
}  // namespace hexaplast::sofa_plugin
