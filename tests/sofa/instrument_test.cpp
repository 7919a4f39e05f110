// SPDX-License-Identifier: LGPL-2.1-or-later
// InstrumentContactForceField over the stand-in: contacts of a step, the product, what a step lets go of, errors.
// plugin/sofa/tests compares whole motions with the embedded host, in SOFA.
#include <Hexaplast/InstrumentContactForceField.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/OdeSolver.h>

#include <cmath>

#include "support/sofa_adapter.hpp"

namespace hexaplast::sofa_plugin::test {
namespace {

using Contact = InstrumentContactForceField<Vec3Types>;

class EulerImplicitSolver : public sofa::core::behavior::OdeSolver {
 public:
  SOFA_CLASS(EulerImplicitSolver, sofa::core::behavior::OdeSolver);

  Data<SReal> stiffness{initData(&stiffness, 0.03, "rayleighStiffness", "Damping proportional to the stiffness.")};
  Data<bool> trapezoidal{initData(&trapezoidal, false, "trapezoidalScheme", "Forces in the middle.")};
};
class StaticSolver final : public sofa::core::behavior::OdeSolver {
 public:
  SOFA_CLASS(StaticSolver, sofa::core::behavior::OdeSolver);
};

class InstrumentAdapter : public Adapter {
 protected:
  /// A box whose bottom lies in the top of the body.
  Attributes box() const {
    std::ostringstream place;
    place.precision(17);
    place << 0.1 << " " << 0.1 << " " << mesh.positions().col(2).maxCoeff() + 0.04;
    return {{"shape", "box"}, {"size", "0.5 0.5 0.1"}, {"keyTimes", "0"}, {"positions", place.str()}};
  }
  Contact& make_contact(const Attributes& attributes) {
    auto& contact = dynamic_cast<Contact&>(make("InstrumentContactForceField", attributes));
    contact.init();
    contact.bwdInit();
    return contact;
  }
  EulerImplicitSolver& integrate() { return tissue.add(New<EulerImplicitSolver>::make(), "euler"); }
  static bool is_valid(const Contact& contact) {
    return contact.d_componentState.getValue() == sofa::core::objectmodel::ComponentState::Valid;
  }
};

TEST_F(InstrumentAdapter, PressesAgainstTheSurfaceAndShowsIt) {
  integrate();
  make_body({});
  Contact& contact = make_contact(with(box(), {{"contactStiffness", "1e6"}}));
  ASSERT_TRUE(is_valid(contact)) << said();
  EXPECT_TRUE(force(contact, mesh.positions()).isZero(0)) << "contacts belong to a step";
  tell<AnimateBeginEvent>();
  ASSERT_TRUE(contact.isInMatrix());
  const PointArray f = force(contact, mesh.positions());
  EXPECT_LT(f.col(2).sum(), 0) << "it pushes down";
  tell<AnimateEndEvent>();
  EXPECT_NEAR(contact.d_force.getValue()[2], -f.col(2).sum(), 1e-12 * std::abs(f.col(2).sum()));
  EXPECT_NEAR(contact.d_depth.getValue(), 0.01, 1e-12);
  EXPECT_GT(contact.d_touching.getValue(), 0);
  EXPECT_EQ(contact.d_slipping.getValue(), 0);
  contact.reset();
  EXPECT_EQ(contact.d_touching.getValue(), 0);
}

// df/dx = -k A n n^T in every form in which SOFA may ask for it, without what the integrator adds.
TEST_F(InstrumentAdapter, TakesBackTheRayleighStiffnessOfTheIntegrator) {
  auto& integrator = integrate();
  make_body({});
  Contact& contact = make_contact(box());
  tell<AnimateBeginEvent>();
  EXPECT_EQ(contact.rayleighStiffness.getValue(), -0.03);
  const double h = kStep;
  params.setBFactor(-h);
  params.setKFactor(-h * (h + 0.03));
  const PointArray dx = random.field(mesh.num_nodes(), 0.001);
  const PointArray change = force(contact, mesh.positions() + dx) - force(contact, mesh.positions());
  EXPECT_TRUE(support::agrees(product(contact, dx), PointArray(-h * h * change), 1e-9));

  integrator.stiffness.setValue(0.01);
  tell<AnimateBeginEvent>();
  EXPECT_EQ(contact.rayleighStiffness.getValue(), -0.01) << "Data may change";
}

TEST_F(InstrumentAdapter, LetsGoOfWhatWouldPullUntilItIsSettled) {
  integrate();
  make_body({});
  Contact& contact = make_contact(box());
  EXPECT_FALSE(contact.isOneSided());
  tell<AnimateBeginEvent>();
  ASSERT_TRUE(contact.isOneSided());
  EXPECT_FALSE(contact.release(mesh.positions(), zero)) << "nothing pulls";
  PointArray away = mesh.positions();
  away.col(2).array() -= 0.02;
  EXPECT_TRUE(contact.release(away, zero));
  EXPECT_FALSE(contact.isInMatrix());
  tell<AnimateBeginEvent>();
  ASSERT_TRUE(contact.isOneSided());
  contact.settle();
  EXPECT_FALSE(contact.isOneSided());
  EXPECT_EQ(said(), "");
  tell<AnimateEndEvent>();
  tell<AnimateBeginEvent>();
  tell<AnimateEndEvent>();
  EXPECT_NE(said().find("not a MultigridCGLinearSolver"), std::string::npos) << said();
}

TEST_F(InstrumentAdapter, RefusesWhatItCannotTouchOrFollow) {
  const auto refuses = [&](const std::string& reason, const Attributes& attributes) {
    sofa_standin::messages().clear();
    const bool valid = is_valid(make_contact(with(box(), attributes)));
    EXPECT_FALSE(valid) << reason;
    EXPECT_NE(said().find(reason), std::string::npos) << said();
  };
  refuses("no body on its state", {});
  make_body({});
  refuses("needs an EulerImplicitSolver", {});
  auto& integrator = integrate();
  refuses("radius: is not given", {{"shape", "sphere"}});
  refuses("shape: 'cube' must be", {{"shape", "cube"}});
  refuses("friction: -1", {{"friction", "-1"}});
  refuses("rayleighStiffness: = 0.1", {{"rayleighStiffness", "0.1"}});
  refuses("surfaceTriangles",
          {{"shape", "surface"}, {"surfacePositions", "0 0 0 1 0 0 0 1 0"}, {"surfaceTriangles", "0 1 2"}});
  refuses("node 7 must lie in", {{"skinPositions", "0 0 0 1 0 0 0 1 0"}, {"skinTriangles", "0 1 7"}});
  integrator.trapezoidal.setValue(true);
  refuses("trapezoidalScheme", {});
  integrator.trapezoidal.setValue(false);
  sofa_standin::messages().clear();
  EXPECT_TRUE(is_valid(make_contact(box()))) << said();
  tissue.add(New<sofa::core::BaseMapping>::make(), "mapping");
  refuses("follows another one", {});
}

TEST_F(InstrumentAdapter, NeedsImplicitEulerAndNoOther) {
  make_body({});
  tissue.add(New<StaticSolver>::make(), "static");
  EXPECT_FALSE(is_valid(make_contact(box())));
  EXPECT_NE(said().find("needs an EulerImplicitSolver"), std::string::npos) << said();
}

// The mesh is lost with its body: the instrument touches the one that is made in its place.
TEST_F(InstrumentAdapter, FollowsABodyThatIsMadeAnewAndHexahedraThatGo) {
  integrate();
  Elastoplastic& body = make_body({});
  Contact& contact = make_contact(box());
  tell<AnimateBeginEvent>();
  const int touching = contact.instrument()->contact().num_touching();
  body.init();
  tell<AnimateBeginEvent>();
  EXPECT_EQ(contact.instrument()->contact().num_touching(), touching) << said();
  tell<AnimateEndEvent>();
  EXPECT_TRUE(is_valid(contact)) << said();
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
