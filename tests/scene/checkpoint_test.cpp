// SPDX-License-Identifier: LGPL-2.1-or-later
// A scene that is put down and taken up again goes on bit for bit, whatever its components keep.
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

void take_up(scene::Scene& scene, const std::vector<std::byte>& bytes) {
  Archive archive{std::span<const std::byte>(bytes)};
  scene.serialize(archive);
  EXPECT_EQ(archive.rest(), 0u);
}

std::string hash_of(scene::Scene& scene) {
  StateHash hash;
  double time = scene.time();
  hash.add(&time, sizeof time);
  for (scene::MechanicalState* state : scene.root().all<scene::MechanicalState>())
    for (const PointArray* field : {&state->positions(), &state->velocities()})
      hash.add(field->data(), static_cast<std::size_t>(field->size()) * sizeof(double));
  for (const scene::ForceField* field : scene.root().all<scene::ForceField>())
    if (field->body()) field->body()->add_to(hash);
  return hash.text();
}

/// Goes on from every one of `moments` to `num_steps`, on another number of threads, and compares with a run that did
/// not stop.
void expect_same_future(const std::string& text, int num_steps, std::initializer_list<int> moments) {
  set_num_threads(1);
  scene::Scene straight = read_and_init(text);
  std::vector<std::vector<std::byte>> checkpoints;
  for (int step = 1; step <= num_steps; ++step) {
    straight.step();
    if (std::ranges::find(moments, step) != moments.end()) checkpoints.push_back(saved(straight));
  }
  set_num_threads(3);
  auto checkpoint = checkpoints.begin();
  for (const int moment : moments) {
    scene::Scene second = read_and_init(text);
    take_up(second, *checkpoint);
    EXPECT_EQ(saved(second), *checkpoint) << "what was read is written again, at step " << moment;
    run(second, num_steps - moment);
    EXPECT_EQ(hash_of(second), hash_of(straight)) << "from step " << moment << " of\n" << text;

    // the one that has gone on: what its components and solvers have worked on since has no part in what comes
    take_up(second, *checkpoint);
    run(second, num_steps - moment);
    EXPECT_EQ(hash_of(second), hash_of(straight)) << "once more, from step " << moment << " of\n" << text;
    ++checkpoint;
  }
  set_num_threads(1);
}

/// A bar of eight hexahedra that hangs on its upper end, in which plastic flow and tears happen within a few steps.
std::string tearing_bar(const std::string& lines, const std::string& solver = "<CGLinearSolver iterations='60'/>",
                        const std::string& ode = "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.01'/>") {
  return "<Node dt='0.02' gravity='0 0 -9.81'><DefaultAnimationLoop/>" + ode + solver +
         "<RegularGridTopology name='grid' n='3 2 5' max='0.2 0.1 0.4'/><MechanicalObject name='nodes'/>"
         "<DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='2e4' "
         "poissonRatio='0.3' yieldStress='500' plasticFlowRate='4' hardening='0.1' fractureStretch='1.02'/>" +
         lines + "</Node>";
}

const std::string kHeld = "<FixedProjectiveConstraint indices='24-29'/>";

const std::string kGripAcross =
    "<GraspForceField name='grasp' radius='0.12' keyTimes='0 0.3' positions='.1 .05 0  .2 .05 -.2' graspTime='0.06' "
    "releaseTime='0.3' stiffness='300' maxForce='12'/>";
const std::string kPoints =
    "<Node name='points'><MechanicalObject name='points' position='.05 .05 .05  .15 .04 .1'/>"
    "<UniformMass totalMass='0.5'/><BarycentricMapping/></Node>";

TEST(SceneCheckpoint, WhateverComponentsKeepGoesOnBitForBit) {
  scene::Scene scene = read_and_init(tearing_bar(kHeld));
  run(scene, 30);
  ASSERT_FALSE(at<scene::ForceField>(scene, "body").body()->removed().empty()) << "the case is to tear";
  expect_same_future(tearing_bar(kHeld), 30, {1, 8, 20});
  std::string mixed = tearing_bar(kHeld, "<MultigridCGLinearSolver/>");
  expect_same_future(mixed.insert(mixed.find("youngModulus"), "precision='mixed' "), 24, {3, 17});

  // warm starts and patterns of solvers
  for (const char* solver : {"<CGLinearSolver iterations='7' warmStart='1'/>", "<SparseLDLSolver/>",
                             "<MultigridCGLinearSolver/>", "<MultigridCGLinearSolver preconditioner='multigrid'/>",
                             "<MultigridCGLinearSolver preconditioner='diagonal'/>"})
    expect_same_future(tearing_bar(kHeld, solver), 24, {3, 17});
  // equilibrium, before it tears: a piece by itself has none
  for (const char* solver : {"<SparseLDLSolver/>", "<CGLinearSolver iterations='9' warmStart='1'/>"})
    expect_same_future(tearing_bar(kHeld, solver, "<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='5'/>"), 3,
                       {1, 2});

  expect_same_future(tearing_bar(kHeld + kGripAcross), 20, {2, 6, 18});
  expect_same_future(tearing_bar("<LinearMovementProjectiveConstraint indices='24-29' keyTimes='0 0.2 9' movements='0 "
                                 "0 0  0 .05 .1  0 .05 .1'/>"),
                     16, {3, 12});
  // faces that went stay without load
  expect_same_future(
      tearing_bar(kHeld + "<Node name='lower'><MeshTopology name='faces' quads='0 1 4 3  1 2 5 4  0 6 9 3"
                          "  6 7 10 9'/></Node><SurfacePressureForceField topology='@lower/faces' "
                          "pressure='800'/>"),
      20, {2, 15});
  expect_same_future(tearing_bar(kHeld + kPoints), 14, {5});
}

TEST(SceneCheckpoint, BodiesWithOneLinearSolverGoOnAsWithOneEach) {
  const auto scene_of = [](bool fraction) {
    const std::string solver = "<CGLinearSolver name='cg' iterations='7' warmStart='1'/>";
    const auto bar = [&](const char* name, const char* youngs) {
      return "<Node name='" + std::string(name) + "'><EulerImplicitSolver/>" + (fraction ? "" : solver) +
             "<RegularGridTopology n='3 2 5' max='0.2 0.1 0.4'/><MechanicalObject/><DiagonalMass massDensity='1000'/>"
             "<HexahedronElastoplasticFEMForceField name='body' youngModulus='" +
             youngs + "' poissonRatio='0.3' yieldStress='500' plasticFlowRate='4'/>" + kHeld + "</Node>";
    };
    return "<Node dt='0.02' gravity='0 0 -9.81'><DefaultAnimationLoop/>" + (fraction ? solver : "") + bar("a", "2e4") +
           bar("b", "5e4") + "</Node>";
  };
  scene::Scene shared = read_and_init(scene_of(true)), apart = read_and_init(scene_of(false));
  run(shared, 12);
  run(apart, 12);
  EXPECT_EQ(hash_of(shared), hash_of(apart));
}

/// Notes its state by itself, as the component of a plugin may, and follows what another one says.
constexpr attributes::Attribute kFollowerAttributes[] = {
    {.name = "field", .type = attributes::Type::kReals, .help = "What it follows."},
};
constexpr attributes::Description kFollower{.class_name = "Follower",
                                            .category = "Test",
                                            .help = "Keeps the first value that it has seen after a change.",
                                            .attributes = kFollowerAttributes};

class Follower final : public scene::Component, public scene::Changeable, public scene::Stateful {
 public:
  Follower() : Component(kFollower) {}
  void init() override {
    latest_ = reals("field");
    ++num_looks_;
  }
  void refresh(std::span<const std::string_view>) override { init(); }
  void reset() override { num_looks_ = 1; }
  void serialize(Archive& archive) override { archive(num_looks_); }
  int num_looks() const { return num_looks_; }
  const std::vector<double>& latest() const { return latest_; }

 private:
  int num_looks_ = 0;
  std::vector<double> latest_;
};

TEST(SceneCheckpoint, WhatFollowsOthersIsAsItWas) {
  factory().add<Follower>(kFollower);
  const std::string follower = "<Follower name='follower' field='@nodes.position'/>";
  for (const std::string& text :
       {tearing_bar(kHeld + follower), replaced(tearing_bar(kHeld), "<RegularGrid", follower + "<RegularGrid")}) {
    scene::Scene straight = read_and_init(text), second = read_and_init(text);
    run(straight, 5);
    take_up(second, saved(straight));
    straight.step();
    second.step();
    EXPECT_EQ(at<Follower>(second, "follower").num_looks(), at<Follower>(straight, "follower").num_looks());
    EXPECT_EQ(at<Follower>(second, "follower").latest(), at<Follower>(straight, "follower").latest());
  }
}

TEST(SceneCheckpoint, OfAnotherSceneIsRefused) {
  scene::Scene scene = read_and_init(tearing_bar(kHeld));
  run(scene, 2);
  std::vector<std::byte> bytes = saved(scene);
  scene::Scene other = read_and_init(tearing_bar(kHeld + "<ConstantForceField indices='0' forces='0 0 1'/>"));
  EXPECT_THROW(take_up(other, bytes), InputError);
  scene::Scene larger = read_and_init(replaced(tearing_bar(kHeld), "n='3 2 5'", "n='3 2 6'"));
  EXPECT_THROW(take_up(larger, bytes), InputError) << "the same components with longer lists";
  for (std::size_t size = 0; size < bytes.size(); size += 97) {
    scene::Scene fresh = read_and_init(tearing_bar(kHeld));
    EXPECT_THROW(take_up(fresh, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), InputError);
  }
}

/// A bar that hangs, and whose load leaves all numbers in the step that begins at 0.06 s.
std::string overloaded_bar(const char* force) {
  return tearing_bar(kHeld + "<LinearForceField points='0-5' times='0 0.05 0.06' forces='0 0 0  0 0 0  0 0 " + force +
                     "'/>");
}

// Components remember more than can be put back: instruments that have closed, solvers.
TEST(FailedStep, LeavesTheMotionAsItWasAndOnlyABeginningLeadsOn) {
  for (const char* force : {"1e120", "1e300"}) {  // the flow fails, the solver fails
    scene::Scene scene = read_and_init(overloaded_bar(force));
    run(scene, 3);
    const std::vector<std::byte> checkpoint = saved(scene);
    const std::string before = hash_of(scene);
    const auto expect_refused = [&](const auto& call) {
      try {
        call();
        FAIL() << "is not refused";
      } catch (const InputError& error) {
        EXPECT_TRUE(has(error.what(), "a step has failed"));
      }
    };
    EXPECT_THROW(scene.step(), NumericalError) << force;
    EXPECT_EQ(hash_of(scene), before) << force;
    for (int again = 0; again < 2; ++again) expect_refused([&] { scene.step(); });
    expect_refused([&] { saved(scene); });
    EXPECT_EQ(hash_of(scene), before) << force;

    take_up(scene, checkpoint);
    EXPECT_THROW(scene.step(), NumericalError) << "the same step fails again";
    scene.reset();
    run(scene, 3);
    EXPECT_EQ(hash_of(scene), before);
    EXPECT_EQ(saved(scene), checkpoint);
  }
}

TEST(FailedStep, SoDoesAStateThatCouldNotBeLoaded) {
  const std::string text = tearing_bar(kHeld);
  scene::Scene scene = read_and_init(text);
  run(scene, 2);
  const std::vector<std::byte> whole = saved(scene);
  run(scene, 1);
  const std::string after = hash_of(scene);
  EXPECT_THROW(take_up(scene, {whole.begin(), whole.end() - 8}), InputError);
  EXPECT_THROW(scene.step(), InputError);
  take_up(scene, whole);
  scene.step();
  EXPECT_EQ(hash_of(scene), after);
}

TEST(Checkpoint, ContinuesARegionWhoseValuesChange) {
  expect_same_future(
      in_root(
          "gravity='0 0 0' dt='0.02'",
          "<RegularGridTopology n='3 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='100'/>"
          "<IndexValueMapper name='mapper' inputValues='@body.presentYieldStress' indices='1' value='900' "
          "defaultValue='800'/>"
          "<MaterialRegion name='region' indices='0 1' youngModulus='@mapper.outputValues'/>"
          "<HexahedronElastoplasticFEMForceField name='body' yieldStress='20' plasticFlowRate='2' hardening='3'/>"
          "<ConstantForceField indices='2 5 8 11' totalForce='90 0 0'/><FixedProjectiveConstraint indices='0 3 6 9'/>"),
      20, {1, 11});
}

}  // namespace
