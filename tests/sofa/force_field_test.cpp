// SPDX-License-Identifier: LGPL-2.1-or-later
// The body as a force field of SOFA: what it does at each call.
#include <sofa/component/topology/container/grid/SparseGridTopology.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/core/visual/VisualParams.h>

#include <algorithm>
#include <limits>

#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

TEST_F(Adapter, OnlyTheEndOfAStepFlowsAndOnce) {
  auto& field = make_body(kPlastic);
  Body expected(mesh, {plastic_material()}, plastic_settings());
  const std::string initial = history_of(expected);
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
    ASSERT_EQ(history_of(*field.body()), history_of(expected)) << "before the end of step " << i;
    tell<AnimateEndEvent>();
    expected.flow(x, kStep);
    ASSERT_EQ(history_of(*field.body()), history_of(expected)) << "after the end of step " << i;
  }
  EXPECT_NE(history_of(expected), initial) << "something flowed";

  field.reset();
  EXPECT_EQ(history_of(*field.body()), initial);
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
  const ElementFields fields = field.body()->fields(stretched);
  const auto& strain = value<vector<SReal>>(field, "plasticStrain");
  ASSERT_EQ(strain.size(), fields.plastic_strain.size());
  for (std::size_t e = 0; e < strain.size(); ++e) EXPECT_EQ(strain[e], fields.plastic_strain[e]);
  EXPECT_GT(strain[0], 0);
  EXPECT_GT(data.getCounter(), counter);
  EXPECT_EQ(PointArray(view(value<DataTypes::VecCoord>(field, "plasticRestPositions"))),
            field.body()->plastic_rest_positions());
  EXPECT_EQ(field.findData("materialPositions"), field.findData("plasticRestPositions")) << "the older name";
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
      {{{"rayleighStiffness", "-1"}}, "HexahedronElastoplasticFEMForceField.rayleighStiffness", "-1"},
      {{{"youngModulus", "1 2 3"}}, "youngModulus", "3"},
  };
  for (const auto& each : cases) {
    sofa_standin::messages().clear();
    root.setAnimate(true);
    auto& field = dynamic_cast<Field&>(make("HexahedronElastoplasticFEMForceField", each.attributes));
    field.setInstanciationSourceFileName("liver.scn");
    field.setInstanciationSourceFilePos(7);
    field.init();
    EXPECT_TRUE(field.isComponentStateInvalid()) << each.name;
    EXPECT_FALSE(root.getAnimate()) << each.name;
    for (const std::string& part : {std::string("liver.scn:7: error"), each.name, each.value})
      EXPECT_NE(said().find(part), std::string::npos) << part << " is missing in: " << said();
    EXPECT_EQ(force(field, deformed), zero) << "an invalid component has no part in the scene";
    tell<AnimateEndEvent>();

    // who starts the animation again is told so again; what steps one that is stopped must not come to an end as if all
    // were well
    root.setAnimate(true);
    sofa_standin::messages().clear();
    tell<AnimateBeginEvent>();
    EXPECT_FALSE(root.getAnimate());
    EXPECT_NE(said().find("is invalid"), std::string::npos) << said();
    EXPECT_THROW(tell<AnimateBeginEvent>(), std::runtime_error);
    field.d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
    field.f_listening.setValue(false);  // the next case has a field of its own
  }
}

TEST_F(Adapter, NamesAllThatIsWrongAtOnce) {
  make_body({{"poissonRatio", "0.7"},
             {"yieldNorm", "vonMiss"},
             {"averagingSteps", "0"},
             {"youngModulus", "1 2"},
             {"rayleighStiffness", "-1"}});
  std::vector<std::string> errors;
  const std::string before = tissue.getPathName() + "/theHexahedronElastoplasticFEMForceField: error: ";
  for (const auto& message : sofa_standin::messages()) {
    ASSERT_TRUE(message.text.starts_with(before)) << message.text;
    errors.push_back(message.text.substr(before.size()));
  }
  std::ranges::sort(errors);
  EXPECT_EQ(errors, (std::vector<std::string>{
                        "HexahedronElastoplasticFEMForceField.averagingSteps: 0 must lie in [1, 1000]",
                        "HexahedronElastoplasticFEMForceField.poissonRatio: 0.7 must lie in [0, 0.5)",
                        "HexahedronElastoplasticFEMForceField.rayleighStiffness: -1 must be >= 0",
                        "HexahedronElastoplasticFEMForceField.yieldNorm: 'vonMiss' must be vonMises, frobenius or "
                        "spectral (did you mean 'vonMises'?)",
                        "HexahedronElastoplasticFEMForceField.youngModulus: 2 values given, must be one or 12 (one per "
                        "hexahedron)"}));
}

// SOFA itself would go on with the word before.
TEST_F(Adapter, AWordThatIsRefusedStaysSoUntilAnotherIsGiven) {
  auto& field = make_body(with(kPlastic, {{"yieldNorm", "frobenus"}}));
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(field.isComponentStateInvalid());
    EXPECT_NE(said().find("did you mean 'frobenius'?"), std::string::npos) << said();
    sofa_standin::messages().clear();
    field.reinit();
  }
  auto& words = dynamic_cast<Data<sofa::helper::OptionsGroup>&>(*field.findData("yieldNorm"));
  words.beginEdit()->setSelectedItem("frobenius");
  words.endEdit();
  field.reinit();
  EXPECT_FALSE(field.isComponentStateInvalid()) << said();
  EXPECT_EQ(field.body()->settings(), plastic_settings());

  sofa_standin::messages().clear();
  field.findData("yieldNorm")->read("best");
  tell<AnimateBeginEvent>();
  EXPECT_TRUE(field.isComponentStateInvalid());
  field.findData("yieldNorm")->read("frobenius");
  field.reset();
  EXPECT_TRUE(field.isComponentStateInvalid()) << "reset reads no Data";
  field.reinit();
  EXPECT_FALSE(field.isComponentStateInvalid()) << said();
}

TEST_F(Adapter, BodiesOfOneNodeDoNotKnowEachOther) {
  auto& soft = make_body(kPlastic);
  auto& stiff = make_body({{"youngModulus", "30000"}, {"poissonRatio", "0.2"}});
  EXPECT_EQ(force(stiff, deformed, force(soft, deformed)), force(soft, deformed, force(stiff, deformed)));
  const PointArray alone = force(stiff, deformed);
  step(stretched);
  EXPECT_NE(soft.body()->plastic_rest_positions(), mesh.positions());
  EXPECT_EQ(stiff.body()->plastic_rest_positions(), mesh.positions());
  EXPECT_EQ(force(stiff, deformed), alone);
  EXPECT_GT(value<vector<SReal>>(soft, "plasticStrain")[0], 0);
  EXPECT_EQ(value<vector<SReal>>(stiff, "plasticStrain")[0], 0);
  soft.findData("youngModulus")->read("-1");
  tell<AnimateBeginEvent>();
  EXPECT_TRUE(soft.isComponentStateInvalid());
  EXPECT_FALSE(stiff.isComponentStateInvalid());
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
    return std::dynamic_pointer_cast<Field>(factory().entries.at("HexahedronElastoplasticFEMForceField").make());
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
  const std::string before = history_of(*field.body());
  PointArray lost = stretched;
  lost(4, 1) = std::numeric_limits<double>::quiet_NaN();
  step(lost);
  EXPECT_TRUE(field.isComponentStateInvalid());
  EXPECT_FALSE(root.getAnimate());
  EXPECT_NE(said(), "");
  EXPECT_EQ(history_of(*field.body()), before);
  EXPECT_THROW(step(stretched), std::runtime_error);  // runSofa -g batch steps on whatever setAnimate says
  root.setAnimate(true);
  step(stretched);
  EXPECT_FALSE(root.getAnimate());
  EXPECT_EQ(history_of(*field.body()), before) << "an invalid component flows no more";

  field.reset();
  EXPECT_FALSE(field.isComponentStateInvalid()) << "the step that was lost is forgotten";
  EXPECT_EQ(history_of(*field.body()), history_of(Body(mesh, {plastic_material()}, plastic_settings())));
  step(stretched);
  EXPECT_EQ(history_of(*field.body()), before);
}

TEST_F(Adapter, TakesANewMaterialByReinitOrWithTheNextStep) {
  auto& field = make_body(kPlastic);
  step(stretched);
  const std::string flowed = history_of(*field.body());
  const PointArray f = force(field, deformed);

  field.findData("youngModulus")->read("21000");
  EXPECT_EQ(force(field, deformed), f) << "nothing changes within a step";
  field.reinit();
  EXPECT_TRUE(support::agrees(force(field, deformed), (3 * f).eval(), 1e-12));
  EXPECT_EQ(history_of(*field.body()), flowed);

  field.findData("youngModulus")->read("7000");
  tell<AnimateBeginEvent>();
  EXPECT_EQ(force(field, deformed), f);

  EXPECT_EQ(said(), "");
  field.findData("gradient")->read("vertex");
  field.reinit();
  EXPECT_TRUE(field.isComponentStateInvalid());
  EXPECT_NE(said().find("ForceField.bending: cannot change during a run"), std::string::npos) << said();

  field.findData("gradient")->read("assumedCorner");
  field.reinit();
  EXPECT_FALSE(field.isComponentStateInvalid()) << "it works again once the value is taken back";
}

TEST_F(Adapter, HalfFullHexahedraOfASparseGridCarryHalf) {
  auto& grid =
      tissue.add_child("cage").add(New<sofa::component::topology::container::grid::SparseGridTopology>::make(), "grid");
  *grid.d_seqHexahedra.beginEdit() = cells.d_seqHexahedra.getValue();
  grid.fill.assign(mesh.num_elements(), 1);
  grid.fill[5] = 0.5f;
  auto& field = dynamic_cast<Elastoplastic&>(
      make("HexahedronElastoplasticFEMForceField", {{"youngModulus", "7000"}, {"yieldStress", "100"}}));
  field.l_topology.set(&grid);
  field.init();
  ASSERT_FALSE(field.isComponentStateInvalid()) << said();
  const auto& materials = field.body()->materials();
  ASSERT_EQ(materials.size(), grid.fill.size());
  EXPECT_EQ(materials[4].young_modulus, 7000);
  EXPECT_EQ(materials[5].young_modulus, 3500);
  EXPECT_EQ(materials[5].yield_stress, 50);
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
