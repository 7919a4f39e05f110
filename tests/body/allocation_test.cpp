// SPDX-License-Identifier: LGPL-2.1-or-later
// No step may allocate: a haptic loop has no time for it. This program counts every call of the allocator.
#include <dlfcn.h>

#include <atomic>
#include <cstdlib>

#include "support/core.hpp"
#include "support/scene.hpp"

namespace {

std::atomic<long> num_allocations{0};

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// In place of the C library's; operator new and Eigen end in them.
extern "C" {
void* malloc(std::size_t size) {
  static const auto allocate = next<void* (*)(std::size_t)>("malloc");
  ++num_allocations;
  return allocate(size);
}
void* realloc(void* at, std::size_t size) {
  static const auto allocate = next<void* (*)(void*, std::size_t)>("realloc");
  ++num_allocations;
  return allocate(at, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  static const auto allocate = next<void* (*)(std::size_t, std::size_t)>("aligned_alloc");
  ++num_allocations;
  return allocate(alignment, size);
}
int posix_memalign(void** at, std::size_t alignment, std::size_t size) {
  static const auto allocate = next<int (*)(void**, std::size_t, std::size_t)>("posix_memalign");
  ++num_allocations;
  return allocate(at, alignment, size);
}
}

namespace hexaplast {
namespace {

/// Allocations of three steps after four others, on two threads.
long allocations_of(const std::function<void()>& step) {
  const int before = num_threads();
  set_num_threads(2);
  for (int k = 0; k < 4; ++k) step();
  const long allocated = num_allocations;
  for (int k = 0; k < 3; ++k) step();
  const long found = num_allocations - allocated;
  set_num_threads(before);
  return found;
}

enum class Does { kNothing, kIdles, kFlows };

struct Case {
  const char* name;
  Precision precision;
  Does plasticity;
  std::unique_ptr<LinearSolver> (*solver)();
  RestShape rest_shape = RestShape::kIsolated;
  bool relaxes = false;
  bool may_tear = false;  // along faces, later
};

template <Preconditioner kPreconditioner>
std::unique_ptr<LinearSolver> preconditioned() {
  return std::make_unique<PreconditionedConjugateGradients>(1e-2, 500, kPreconditioner);
}
std::unique_ptr<LinearSolver> tight() { return std::make_unique<PreconditionedConjugateGradients>(1e-6, 500); }
std::unique_ptr<LinearSolver> plain() {
  return std::make_unique<ConjugateGradients>(ConjugateGradientSettings{.iterations = 10, .tolerance = 0});
}
std::unique_ptr<LinearSolver> warm() {
  return std::make_unique<ConjugateGradients>(
      ConjugateGradientSettings{.iterations = 10, .tolerance = 0, .warm_start = true});
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Allocations : public testing::TestWithParam<Case> {};

TEST_P(Allocations, AStepHasNone) {
  Material material{.young_modulus = 5000, .poisson_ratio = 0.45};
  if (GetParam().plasticity != Does::kNothing) {
    material.flow_rate = 2;
    material.hardening = 0.2;
    material.yield_stress = GetParam().plasticity == Does::kFlows ? 1e-3 : 1e9;
  }
  Settings settings;
  settings.precision = GetParam().precision;
  settings.rest_shape = GetParam().rest_shape;
  if (GetParam().may_tear) {
    material.fracture_stress = 1e6;
    settings.fracture = Fracture::kFace;
  }
  if (GetParam().relaxes) settings.relaxation = {0.7, 0.3, 2, 0.02};
  Body body(block({8, 8, 32}, 0.01), {material}, settings);
  Motion setup;
  setup.fixed = nodes_at(body.mesh(), 2, 0);
  setup.load = [](double, ConstPoints, Points f) { f.col(0).array() += 1e-4; };
  MovingBody simulation(std::move(body), setup, GetParam().solver());

  FlowReport flow;
  EXPECT_EQ(allocations_of([&] { flow = simulation.step(); }), 0);
  EXPECT_EQ(flow.yielded > 0, GetParam().plasticity == Does::kFlows);
  EXPECT_TRUE(flow.torn.empty());
}

TEST(Allocations, AStepOfManyBodiesInOneLoopHasNone) {
  std::vector<std::unique_ptr<MovingBody>> bodies;
  for (int k = 0; k < 6; ++k) {
    Body body(block({3, 3, 4 + k}, 0.01),
              {{.young_modulus = 5000, .poisson_ratio = 0.45, .yield_stress = 1e-3, .flow_rate = 2, .hardening = 0.2}});
    Motion setup;
    setup.fixed = nodes_at(body.mesh(), 2, 0);
    setup.load = [](double, ConstPoints, Points f) { f.col(0).array() += 1e-4; };
    bodies.push_back(std::make_unique<MovingBody>(std::move(body), setup, plain()));
  }
  EXPECT_EQ(allocations_of([&] { parallel_for(6, [&](int k) { bodies[static_cast<std::size_t>(k)]->step(); }); }), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Steps, Allocations,
    testing::Values(
        Case{"plain_double", Precision::kDouble, Does::kNothing, plain},
        Case{"plain_mixed", Precision::kMixed, Does::kNothing, plain},
        Case{"warm_mixed", Precision::kMixed, Does::kIdles, warm},
        Case{"diagonal_mixed", Precision::kMixed, Does::kIdles, preconditioned<Preconditioner::kDiagonal>},
        Case{"multigrid_mixed", Precision::kMixed, Does::kNothing, preconditioned<Preconditioner::kMultigrid>},
        Case{"multigrid_double", Precision::kDouble, Does::kNothing, preconditioned<Preconditioner::kMultigrid>},
        Case{"auto_mixed", Precision::kMixed, Does::kNothing, preconditioned<Preconditioner::kAuto>},
        Case{"tight_mixed", Precision::kMixed, Does::kNothing, tight},
        Case{"isolated_double", Precision::kDouble, Does::kFlows, preconditioned<Preconditioner::kMultigrid>},
        Case{"isolated_mixed", Precision::kMixed, Does::kFlows, plain},
        Case{"may_tear", Precision::kDouble, Does::kFlows, plain, RestShape::kIsolated, false, true},
        Case{"relaxing_double", Precision::kDouble, Does::kNothing, preconditioned<Preconditioner::kMultigrid>,
             RestShape::kJoined, true},
        Case{"relaxing_mixed", Precision::kMixed, Does::kNothing, plain, RestShape::kIsolated, true},
        Case{"relaxing_isolated_double", Precision::kDouble, Does::kFlows, plain, RestShape::kIsolated, true},
        Case{"relaxing_isolated_mixed", Precision::kMixed, Does::kFlows, preconditioned<Preconditioner::kMultigrid>,
             RestShape::kIsolated, true}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Allocations, KeepingAccountsOfEnergyHasNone) {
  Body body(block({4, 4, 8}, 0.01), {Material{.young_modulus = 5000, .yield_stress = 1e-3, .flow_rate = 2}});
  LoadedBody system(body, lumped_masses(body, 1000), nodes_at(body.mesh(), 2, 0),
                    [](double, ConstPoints, Points f) { f.col(0).array() += 1e-4; });
  ImplicitEuler euler({.rayleigh_stiffness = 0.01, .velocity_damping = 0.1});
  euler.measure_energy();
  EnergyBalance balance;
  const std::unique_ptr<LinearSolver> solver = plain();
  PointArray x = body.mesh().positions(), v = PointArray::Zero(x.rows(), 3);
  EXPECT_EQ(allocations_of([&] {
              euler.step(system, *solver, 0, 0.01, x, v);
              balance.add_step(euler.energy(), 0, body.energy(x), body.recovery_work(x));
              body.flow(x, 0.01);
              balance.add_flow(body.energy(x));
            }),
            0);
  EXPECT_GT(balance.load_work, 0);
  EXPECT_GT(balance.flow_loss, 0);
}

struct ShippedScene {
  const char* name;
  int first;           ///< step from which all that the scene is about has begun, grips that reach their limit included
  int of_cholmod = 0;  ///< that the direct solver's library makes in each factorisation and solution
};

void PrintTo(const ShippedScene& scene, std::ostream* out) { *out << scene.name; }

class AllocationsOf : public testing::TestWithParam<ShippedScene> {};

TEST_P(AllocationsOf, AShippedSceneHasNoneOfOurs) {
  scene::Scene scene =
      scene::read_scene(std::string(HEXAPLAST_SOURCE_DIR "/scenes/") + GetParam().name + ".scn", factory(), plugins());
  scene.init();
  for (int step = 0; step < GetParam().first; ++step) scene.step();
  for (int step = 0; step < 5; ++step) {
    const long before = num_allocations;
    scene.step();
    EXPECT_LE(num_allocations - before, GetParam().of_cholmod) << "step " << step;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, AllocationsOf,
                         testing::Values(ShippedScene{"fatty_tissue", 30}, ShippedScene{"liver_cage", 40},
                                         ShippedScene{"peritoneum_tear", 40}, ShippedScene{"vessel_mobilise", 20, 6},
                                         ShippedScene{"probe_liver", 120}, ShippedScene{"slope", 60},
                                         ShippedScene{"forceps_fat", 120}, ShippedScene{"two_organs", 60},
                                         ShippedScene{"fold", 170}),
                         [](const auto& test) { return std::string(test.param.name); });

/// What acts beside a body.
struct OtherTerms {
  const char* name;
  const char* lines;
};

void PrintTo(const OtherTerms& other, std::ostream* out) { *out << other.name; }

class AllocationsBeside : public testing::TestWithParam<OtherTerms> {};

// Planes that are touched, a grip at its greatest force, points that follow nodes, a second body.
TEST_P(AllocationsBeside, ABodyAStepHasNone) {
  for (const std::string precision : {"double", "mixed"})
    for (const std::string preconditioner : {"multigrid", "diagonal"}) {
      const std::string body =
          "<HexahedronElastoplasticFEMForceField youngModulus='1e5' poissonRatio='0.45' precision='" + precision +
          "'/>";
      scene::Scene scene = read_and_init(
          "<Node dt='0.01' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='0.1' "
          "rayleighStiffness='0.01'/><MultigridCGLinearSolver tolerance='1e-6' preconditioner='" +
          preconditioner +
          "'/><RegularGridTopology name='grid' n='11 11 4' min='0 0 0' max='0.1 0.1 0.03'/>"
          "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
          "<BoxROI name='end' box='-1 -1 -1  1e-6 1 1'/><FixedProjectiveConstraint indices='@end.indices'/>" +
          body + GetParam().lines + "</Node>");
      run(scene, 12);
      for (int step = 0; step < 3; ++step) {
        const long before = num_allocations;
        const SolveReport report = scene.step();
        EXPECT_EQ(num_allocations - before, 0) << precision << ", " << preconditioner;
        EXPECT_EQ(name_of(report.preconditioner), preconditioner);
      }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Beside, AllocationsBeside,
    testing::Values(OtherTerms{"Plane", "<PlaneForceField normal='.36 .48 .8' d='.04' stiffness='50'/>"},
                    OtherTerms{"Grip",
                               "<GraspForceField radius='0.02' keyTimes='0 0.1' positions='.1 .05 .03  .12 .06 .06' "
                               "stiffness='50' maxForce='.02'/>"},
                    OtherTerms{"Points",
                               "<Node><MechanicalObject position='.07 .05 .031  .08 .03 .02'/><BarycentricMapping/>"
                               "<UniformMass totalMass='.05'/><PlaneForceField normal='0 0 1' d='.1' stiffness='20'/>"
                               "</Node>"},
                    OtherTerms{"SecondBody",
                               "<HexahedronElastoplasticFEMForceField youngModulus='1e4' poissonRatio='0.3'/>"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Allocations, AreCounted) {
  const long before = num_allocations;
  PointArray field = PointArray::Zero(100, 3);
  EXPECT_EQ(num_allocations - before, 1) << field.size();
}

}  // namespace
}  // namespace hexaplast
