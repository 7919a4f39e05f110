// SPDX-License-Identifier: LGPL-2.1-or-later
// TissueContactForceField over the stand-in: contacts of a step between two states, products and matrices, errors.
// plugin/sofa/tests compares whole motions with the embedded host, in SOFA.
#include <Hexaplast/TissueContactForceField.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/core/behavior/OdeSolver.h>

#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

using Contact = TissueContactForceField<Vec3Types>;
using DataVec = Data<DataTypes::VecDeriv>;

class EulerImplicitSolver : public sofa::core::behavior::OdeSolver {
 public:
  SOFA_CLASS(EulerImplicitSolver, sofa::core::behavior::OdeSolver);
  Data<SReal> stiffness{initData(&stiffness, 0.03, "rayleighStiffness", "Damping proportional to the stiffness.")};
};

/// The block of Adapter, and below the same node one that lies on it, a hundredth within.
class TissueAdapter : public Adapter {
 protected:
  TissueAdapter() {
    make_body({});
    *other_cells.d_seqHexahedra.beginEdit() = cells.d_seqHexahedra.getValue();
    PointArray above = mesh.positions();
    above.col(2).array() += mesh.positions().col(2).maxCoeff() - 0.01;
    above.col(0).array() += 0.013;
    for (auto field : {other_nodes.writeRestPositions(), other_nodes.writePositions(), other_nodes.writeVelocities()})
      field.resize(static_cast<std::size_t>(mesh.num_nodes()));
    view(other_nodes.writeRestPositions().wref()) = above;
    view(other_nodes.writePositions().wref()) = above;
    upper_body.init();
  }
  void integrate(BaseContext& node) { node.add(New<EulerImplicitSolver>::make(), "euler"); }
  Contact& make_contact(const Attributes& attributes) {
    auto& contact = dynamic_cast<Contact&>(make("TissueContactForceField", attributes));
    contact.mstate1.set(&nodes);
    contact.mstate2.set(&other_nodes);
    contact.init();
    contact.bwdInit();
    return contact;
  }
  static DataVec& filled(DataVec& data, const PointArray& with) {
    data.beginEdit()->resize(static_cast<std::size_t>(with.rows()));
    view(*data.beginEdit()) = with;
    return data;
  }
  OfTwo<PointArray> force(Contact& contact, const PointArray& x1, const PointArray& x2) const {
    DataVec f1, f2, first, second, v;
    filled(v, zero);
    contact.addForce(&params, filled(f1, zero), filled(f2, zero), filled(first, x1), filled(second, x2), v, v);
    return {PointArray(view(f1.getValue())), PointArray(view(f2.getValue()))};
  }
  static bool is_valid(const Contact& contact) {
    return contact.d_componentState.getValue() == sofa::core::objectmodel::ComponentState::Valid;
  }

  BaseContext& upper = tissue.add_child("upper");
  MeshTopology& other_cells = upper.add(New<MeshTopology>::make(), "cells");
  MechanicalState& other_nodes = upper.add(New<MechanicalState>::make(), "nodes");
  BaseComponent& upper_body = upper.add(factory().entries.at("HexahedronElastoplasticFEMForceField").make(), "body");
};

TEST_F(TissueAdapter, PressesBothBodiesAndShowsIt) {
  integrate(tissue);
  Contact& contact = make_contact({{"contactStiffness", "1e6"}});
  ASSERT_TRUE(is_valid(contact)) << said();
  EXPECT_FALSE(contact.isInMatrix()) << "contacts belong to a step";
  tell<AnimateBeginEvent>();
  ASSERT_TRUE(contact.isInMatrix());
  const PointArray x2 = view(other_nodes.readPositions().ref());
  const auto f = force(contact, mesh.positions(), x2);
  EXPECT_LT(f.first.col(2).sum(), 0) << "the upper one pushes down";
  const double size = f.first.cwiseAbs().sum();
  EXPECT_LE((f.first.colwise().sum() + f.second.colwise().sum()).norm(), 1e-12 * size);
  tell<AnimateEndEvent>();
  EXPECT_NEAR(contact.d_force.getValue()[2], f.first.col(2).sum(), 1e-12 * size);
  EXPECT_GT(contact.d_depth.getValue(), 0.001);
  EXPECT_GT(contact.d_touching.getValue(), 0);
  contact.reset();
  EXPECT_EQ(contact.d_touching.getValue(), 0);
  contact.d_active.setValue(false);
  tell<AnimateBeginEvent>();
  EXPECT_FALSE(contact.isInMatrix());
}

// In every form in which SOFA may ask for it, without what the integrator adds.
TEST_F(TissueAdapter, ProductsAndMatricesAreTheChangeOfTheForce) {
  integrate(tissue);
  Contact& contact = make_contact({{"friction", "0.3"}});
  tell<AnimateBeginEvent>();
  EXPECT_EQ(contact.rayleighStiffness.getValue(), -0.03);
  const double h = kStep;
  params.setBFactor(-h);
  params.setKFactor(-h * (h + 0.03));
  const PointArray x2 = view(other_nodes.readPositions().ref());
  const PointArray dx1 = random.field(mesh.num_nodes(), 0.001), dx2 = random.field(mesh.num_nodes(), 0.001);
  const auto before = force(contact, mesh.positions(), x2),
             after = force(contact, mesh.positions() + dx1, PointArray(x2 + dx2));
  DataVec df1, df2, first, second;
  contact.addDForce(&params, filled(df1, zero), filled(df2, zero), filled(first, dx1), filled(second, dx2));
  EXPECT_TRUE(
      support::agrees(PointArray(view(df1.getValue())), PointArray(-h * h * (after.first - before.first)), 1e-9));
  EXPECT_TRUE(
      support::agrees(PointArray(view(df2.getValue())), PointArray(-h * h * (after.second - before.second)), 1e-9));

  // the stand-in puts the blocks of all pairs of states into one matrix
  sofa::core::behavior::StiffnessMatrix matrix;
  contact.buildStiffnessMatrix(&matrix);
  PointArray sum = PointArray::Zero(mesh.num_nodes(), 3);
  for (const auto& [place, value] : matrix.entries)
    sum(place.first / 3, place.first % 3) += value * dx1(place.second / 3, place.second % 3);
  const auto moved = force(contact, mesh.positions() + dx1, PointArray(x2 + dx1));
  const PointArray expected = moved.first - before.first + moved.second - before.second;
  EXPECT_TRUE(support::agrees(sum, expected, 1e-9));
}

// Of a body that hears of the step, and takes its Data, after the contact.
TEST_F(TissueAdapter, TheDefaultStiffnessFollowsABodyBehindIt) {
  integrate(tissue);
  Contact& contact = make_contact({});
  const PointArray x2 = view(other_nodes.readPositions().ref());
  tell<AnimateBeginEvent>();
  const auto before = force(contact, mesh.positions(), x2);
  ASSERT_TRUE(upper_body.findData("youngModulus")
                  ->read(std::to_string(value<vector<SReal>>(upper_body, "youngModulus").at(0) / 10)));
  tell<AnimateBeginEvent>();
  const auto after = force(contact, mesh.positions(), x2);
  EXPECT_TRUE(support::agrees(after.first, PointArray(before.first / 10), 1e-12));
  EXPECT_TRUE(support::agrees(after.second, PointArray(before.second / 10), 1e-12));
}

TEST_F(TissueAdapter, WarnsOfAPairThatTouchesTwice) {
  integrate(tissue);
  make_contact({});
  sofa_standin::messages().clear();
  make_contact({});
  EXPECT_NE(said().find("is between the same bodies"), std::string::npos) << said();
}

TEST_F(TissueAdapter, LetsGoOfWhatWouldPullUntilItIsSettled) {
  integrate(tissue);
  Contact& contact = make_contact({});
  EXPECT_NE(said().find("deep in each other"), std::string::npos) << said();
  sofa_standin::messages().clear();
  tell<AnimateBeginEvent>();
  ASSERT_TRUE(contact.isOneSided());
  const PointArray x2 = view(other_nodes.readPositions().ref());
  PointArray away = x2;
  away.col(2).array() += 0.05;
  EXPECT_FALSE(contact.release({mesh.positions(), x2}, {zero, zero})) << "nothing pulls";
  const auto num_terms = [&] { return contact.tissues()->contact().terms().terms.size(); };
  const std::size_t before = num_terms();
  EXPECT_TRUE(contact.release({mesh.positions(), away}, {zero, zero}));
  EXPECT_LT(num_terms(), before / 2);
  contact.acceptStep();
  EXPECT_FALSE(contact.isOneSided());
  EXPECT_EQ(said(), "");
  tell<AnimateBeginEvent>();
  tell<AnimateEndEvent>();
  EXPECT_NE(said().find("not a MultigridCGLinearSolver"), std::string::npos) << said();
}

TEST_F(TissueAdapter, IsMadeByReinitAfterWhatWasRefused) {
  integrate(tissue);
  Contact& contact = make_contact({{"friction", "-1"}, {"maxSubdivision", "0"}});
  for (const char* attribute : {"friction", "maxSubdivision"})
    EXPECT_NE(said().find("TissueContactForceField." + std::string(attribute) + ": "), std::string::npos) << said();
  contact.reset();
  EXPECT_FALSE(is_valid(contact));
  contact.findData("friction")->read("0");
  contact.findData("maxSubdivision")->read("8");
  contact.reinit();
  EXPECT_TRUE(is_valid(contact)) << said();
  tell<AnimateBeginEvent>();
  ASSERT_TRUE(contact.isInMatrix());
  contact.findData("active")->read("false");
  tell<AnimateBeginEvent>();
  EXPECT_FALSE(contact.isInMatrix()) << "from the next step on";
  EXPECT_FALSE(contact.d_active.getValue());
}

TEST_F(TissueAdapter, FollowsABodyThatIsMadeAnew) {
  integrate(tissue);
  Contact& contact = make_contact({});
  tell<AnimateBeginEvent>();
  const int touching = contact.tissues()->contact().num_touching();
  ASSERT_GT(touching, 0);
  upper.get<HexahedronElastoplasticFEMForceField<Vec3Types>>(BaseContext::Local)->init();
  tell<AnimateBeginEvent>();
  EXPECT_EQ(contact.tissues()->contact().num_touching(), touching) << said();
  EXPECT_TRUE(is_valid(contact)) << said();
}

TEST_F(TissueAdapter, RefusesWhatCannotTouch) {
  const auto refuses = [&](const std::string& reason, const Attributes& attributes) {
    sofa_standin::messages().clear();
    EXPECT_FALSE(is_valid(make_contact(attributes))) << reason;
    EXPECT_NE(said().find(reason), std::string::npos) << said();
  };
  refuses("needs an EulerImplicitSolver", {});
  integrate(tissue);
  refuses("friction: -1", {{"friction", "-1"}});
  refuses("contactDistance", {{"contactDistance", "1"}});
  refuses("rayleighStiffness: = 0.1", {{"rayleighStiffness", "0.1"}});
  EXPECT_TRUE(is_valid(make_contact({}))) << said();
  integrate(upper);
  refuses("object2: leads to", {});
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
