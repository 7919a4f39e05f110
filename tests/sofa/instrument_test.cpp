// SPDX-License-Identifier: LGPL-2.1-or-later
// InstrumentContactForceField over the stand-in: contacts of a step, the product, what a step lets go of, errors.
// plugin/sofa/tests compares whole motions with the embedded host, in SOFA.
#include <Hexaplast/InstrumentContactForceField.h>
#include <sofa/core/BaseMapping.h>
#include <sofa/core/behavior/OdeSolver.h>
#include <sofa/core/visual/VisualParams.h>

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
  contact.d_active.setValue(false);
  tell<AnimateBeginEvent>();
  EXPECT_FALSE(contact.isInMatrix());
  EXPECT_TRUE(force(contact, mesh.positions()).isZero(0));
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

/// [m^3] within triangles whose front is outside, about any point within.
double enclosed(const std::vector<sofa::type::Vec3>& corners) {
  double volume = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    volume += vec3(corners[i]).dot(vec3(corners[i + 1]).cross(vec3(corners[i + 2]))) / 6;
  return volume;
}

TEST_F(InstrumentAdapter, DrawsItsShapeWhereItIs) {
  integrate();
  make_body({});
  const double z = mesh.positions().col(2).maxCoeff() + 0.2;
  const auto drawn = [&](const Attributes& shape) {
    // a quarter of a turn about y leads z to x
    const Contact& contact =
        make_contact(with(shape, {{"keyTimes", "0 1"},
                                  {"positions", "0 0 " + std::to_string(z) + " 0 0 9"},
                                  {"orientations", "0 0.70710678118654752 0 0.70710678118654752 0 0 0 1"}}));
    EXPECT_TRUE(is_valid(contact)) << said();
    sofa::core::visual::VisualParams params_of_drawing;
    const_cast<Contact&>(contact).draw(&params_of_drawing);
    EXPECT_EQ(params_of_drawing.tool.open_states, 0) << "leaves the tool as it was";
    return params_of_drawing.tool;
  };
  const auto corners_of = [&](const Attributes& shape) {
    const auto tool = drawn(shape);
    EXPECT_EQ(tool.triangles.size(), 1u);
    EXPECT_TRUE(tool.points.empty()) << "nothing touches";
    return tool.triangles.at(0).corners;
  };
  const Vec3 centre(0, 0, std::stod(std::to_string(z)));
  const auto greatest_x = [](const std::vector<sofa::type::Vec3>& corners) {
    double greatest = 0;
    for (const auto& corner : corners) greatest = std::max(greatest, std::abs(corner[0]));
    return greatest;
  };
  const double circle = M_PI * 0.02 * 0.02, ball = circle * 0.02 * 4 / 3;  // polyhedra of 32 sides lie within
  const auto sphere = corners_of({{"shape", "sphere"}, {"radius", "0.02"}});
  for (const auto& corner : sphere) EXPECT_NEAR((vec3(corner) - centre).norm(), 0.02, 1e-12);
  EXPECT_NEAR(enclosed(sphere), ball, 0.02 * ball);
  const auto capsule = corners_of({{"shape", "capsule"}, {"radius", "0.02"}, {"length", "0.1"}});
  EXPECT_NEAR(greatest_x(capsule), 0.07, 1e-12) << "it is turned";
  EXPECT_NEAR(enclosed(capsule), ball + 0.1 * circle, 0.02 * ball + 0.001 * circle);
  const auto cylinder = corners_of({{"shape", "cylinder"}, {"radius", "0.02"}, {"length", "0.1"}});
  EXPECT_NEAR(greatest_x(cylinder), 0.05, 1e-12);
  EXPECT_NEAR(enclosed(cylinder), 0.1 * circle, 0.001 * circle);
  const auto box = corners_of({{"shape", "box"}, {"size", "0.1 0.2 0.3"}});
  EXPECT_NEAR(enclosed(box), 0.1 * 0.2 * 0.3, 1e-15);
  EXPECT_NEAR(greatest_x(box), 0.15, 1e-12);
  const auto surface = corners_of({{"shape", "surface"},
                                   {"surfacePositions", "0 0 0 0.1 0 0 0 0.1 0 0 0 0.1"},
                                   {"surfaceTriangles", "0 2 1 0 1 3 1 2 3 0 3 2"}});
  EXPECT_NEAR(enclosed(surface), 1e-3 / 6, 1e-15);
}

// Data count from the next step on: until then, and where they are refused, the instrument is the one before.
TEST_F(InstrumentAdapter, DrawsTheShapeThatItHasUntilDataAreAccepted) {
  integrate();
  make_body({});
  Contact& contact = make_contact(with(box(), {}));
  const auto num_corners = [&] {
    sofa::core::visual::VisualParams shown;
    contact.draw(&shown);
    return shown.tool.triangles.at(0).corners.size();
  };
  EXPECT_EQ(num_corners(), 36u);
  for (const char* shape : {"capsule", "cube"}) {
    contact.findData("shape")->read(shape);
    EXPECT_EQ(num_corners(), 36u) << shape;
  }
}

TEST_F(InstrumentAdapter, IsMadeByReinitAfterWhatWasRefused) {
  integrate();
  make_body({});
  Contact& contact = make_contact(with(box(), {{"friction", "-1"}, {"shape", "cube"}, {"rayleighStiffness", "1"}}));
  for (const char* attribute : {"friction", "shape", "rayleighStiffness"})
    EXPECT_NE(said().find("InstrumentContactForceField." + std::string(attribute) + ": "), std::string::npos) << said();
  contact.reset();
  EXPECT_FALSE(is_valid(contact));
  contact.findData("friction")->read("0");
  contact.findData("shape")->read("box");
  contact.findData("rayleighStiffness")->read("0");
  contact.reinit();
  EXPECT_TRUE(is_valid(contact)) << said();
  tell<AnimateBeginEvent>();
  EXPECT_TRUE(contact.isInMatrix());
}

TEST_F(InstrumentAdapter, DrawsWhereItTouchesAndTheForces) {
  integrate();
  make_body({});
  Contact& contact = make_contact(with(box(), {{"contactStiffness", "1e6"}}));
  const auto draw = [&](bool forces, bool visuals) {
    sofa::core::visual::VisualParams shown;
    shown.flags.show_force_fields = forces;
    shown.flags.show_visual_models = visuals;
    contact.draw(&shown);
    return shown.tool;
  };
  tell<AnimateBeginEvent>();
  tell<AnimateEndEvent>();
  const auto tool = draw(true, false);
  ASSERT_EQ(tool.lines.size(), 1u);
  EXPECT_EQ(tool.triangles.size(), 1u) << "the box";
  ASSERT_EQ(tool.lines[0].ends.size(), 2u * contact.d_touching.getValue());
  ASSERT_EQ(tool.points.size(), 1u) << "all stick";
  EXPECT_EQ(tool.points[0].ends.size(), tool.lines[0].ends.size() / 2);
  dynamic_cast<Data<SReal>&>(*contact.findData("drawForceScale")).setValue(0.5);
  Vec3 sum = Vec3::Zero();
  const auto to_scale = draw(true, false);
  for (std::size_t i = 0; i < to_scale.lines.at(0).ends.size(); i += 2)
    sum += vec3(to_scale.lines[0].ends[i + 1]) - vec3(to_scale.lines[0].ends[i]);
  EXPECT_NEAR((sum + 0.5 * vec3(contact.d_force.getValue())).norm(), 0, 1e-9 * sum.norm());

  EXPECT_TRUE(draw(false, true).lines.empty());
  EXPECT_EQ(draw(false, true).triangles.size(), 1u);
  EXPECT_TRUE(draw(false, false).triangles.empty());
  dynamic_cast<Data<bool>&>(*contact.findData("drawInstrument")).setValue(false);
  EXPECT_TRUE(draw(true, true).triangles.empty());
  EXPECT_EQ(draw(true, true).lines.size(), 1u);

  sofa::core::ExecParams eparams;
  dynamic_cast<Data<bool>&>(*contact.findData("drawInstrument")).setValue(true);
  contact.computeBBox(&eparams);
  EXPECT_GT(contact.f_bbox.getValue().max[2], mesh.positions().col(2).maxCoeff() + 0.04);
}

// Of a body that hears of the step, and takes its Data, after the instrument.
TEST_F(InstrumentAdapter, TheDefaultStiffnessFollowsABodyBehindIt) {
  integrate();
  auto& contact = dynamic_cast<Contact&>(make("InstrumentContactForceField", box()));
  Elastoplastic& body = make_body({{"youngModulus", "5000"}});
  contact.init();
  contact.bwdInit();
  tell<AnimateBeginEvent>();
  const PointArray before = force(contact, mesh.positions());
  ASSERT_TRUE(body.findData("youngModulus")->read("50000"));
  tell<AnimateBeginEvent>();
  EXPECT_TRUE(support::agrees(force(contact, mesh.positions()), PointArray(10 * before), 1e-12));
}

TEST_F(InstrumentAdapter, LetsGoOfWhatWouldPullUntilItIsSettled) {
  integrate();
  make_body({});
  Contact& contact = make_contact(box());
  EXPECT_NE(said().find("deep in the body, which is pushed out"), std::string::npos) << said();
  sofa_standin::messages().clear();
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
  contact.acceptStep();
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
  refuses("embeddedTriangles: 7 must lie in [0, 3)",
          {{"embeddedPositions", "0 0 0 1 0 0 0 1 0"}, {"embeddedTriangles", "0 1 7"}});
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
  sofa_standin::messages().clear();
  tell<AnimateBeginEvent>();
  EXPECT_EQ(said(), "") << "it does not begin anew";
  EXPECT_EQ(contact.instrument()->contact().num_touching(), touching) << said();
  tell<AnimateEndEvent>();
  EXPECT_TRUE(is_valid(contact)) << said();
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
