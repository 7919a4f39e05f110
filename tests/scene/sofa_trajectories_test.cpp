// SPDX-License-Identifier: LGPL-2.1-or-later
// Where SOFA's elements and integrators end in SOFA itself (tests/data/sofa/README.md).
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <vector>

#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;

const std::string kData = HEXAPLAST_TEST_DATA "/sofa/";
constexpr std::string_view kField = "<HexahedronFEMForceField youngModulus=\"5000\" poissonRatio=\"0.3\"/>",
                           kIntegrator = "<EulerImplicitSolver/>",
                           kLinearSolver = "<SparseLDLSolver template=\"CompressedRowSparseMatrixMat3x3d\"/>",
                           kTimeStep = "dt=\"0.01\"",
                           kConstraint = "<FixedProjectiveConstraint indices=\"0 1 2 3 4 5\"/>";

/// A variant of bar.scn: what takes the place of its parts; empty: they stay.
struct Variant {
  std::string name;
  std::string field = {}, integrator = {}, linear_solver = {}, time_step = {}, constraint = {};
};

std::string field(const std::string& class_name, const std::string& attributes) {
  return "<" + class_name + " youngModulus='5000' poissonRatio='0.3' " + attributes + "/>";
}

const std::string kConjugateGradients = "<CGLinearSolver iterations='500' tolerance='1e-15' threshold='1e-30'/>";

const std::vector<Variant> kVariants = {
    {.name = "large"},
    {.name = "polar", .field = field("HexahedronFEMForceField", "method='polar'")},
    {.name = "small", .field = field("HexahedronFEMForceField", "method='small'")},
    {.name = "damped",
     .field = field("HexahedronFEMForceField", "method='polar' rayleighStiffness='0.02'"),
     .integrator = "<EulerImplicitSolver rayleighMass='0.3' rayleighStiffness='0.05' vdamping='0.4'/>"},
    {.name = "trapezoidal", .integrator = "<EulerImplicitSolver trapezoidalScheme='true'/>"},
    {.name = "first_order", .integrator = "<EulerImplicitSolver firstOrder='true'/>"},
    {.name = "dynamic_large",
     .field = field("HexahedralFEMForceField", "method='large'"),
     .linear_solver = kConjugateGradients},
    {.name = "dynamic_polar",
     .field = field("HexahedralFEMForceField", "method='polar'"),
     .linear_solver = kConjugateGradients},
    {.name = "explicit", .integrator = "<EulerExplicitSolver/>", .time_step = "dt='0.002'"},
    {.name = "explicit_not_symplectic",
     .integrator = "<EulerExplicitSolver symplectic='false'/>",
     .time_step = "dt='0.002'"},
    {.name = "midpoint", .integrator = "<RungeKutta2Solver/>", .time_step = "dt='0.002'"},
    {.name = "runge_kutta", .integrator = "<RungeKutta4Solver/>", .time_step = "dt='0.004'"},
    {.name = "runge_kutta_led",
     .integrator = "<RungeKutta4Solver/>",
     .time_step = "dt='0.002'",
     .constraint = "<FixedProjectiveConstraint indices='0 1 2 3 4 5'/><LinearMovementProjectiveConstraint "
                   "indices='18 19 20' keyTimes='0 0.02 1' movements='0 0 0  0.01 0.02 0  0.01 0.02 0'/>"},
    {.name = "central_difference",
     .integrator = "<CentralDifferenceSolver rayleighMass='0.7'/>",
     .time_step = "dt='0.002'"},
    {.name = "newmark", .integrator = "<NewmarkImplicitSolver/>"},
    {.name = "newmark_damped",
     .field = field("HexahedronFEMForceField", "rayleighStiffness='0.01'"),
     .integrator = "<NewmarkImplicitSolver rayleighMass='0.3' rayleighStiffness='0.02' vdamping='0.4' gamma='0.6' "
                   "beta='0.3'/>"},
};

std::string replaced(std::string scene, std::string_view part, const std::string& by) {
  const std::size_t at = scene.find(part);
  if (at == scene.npos) throw std::runtime_error("no " + std::string(part));
  return by.empty() ? scene : scene.replace(at, part.size(), by);
}

std::string scene_of(const Variant& variant) {
  std::ifstream file(kData + "bar.scn");
  std::string scene((std::istreambuf_iterator<char>(file)), {});
  scene = replaced(scene, kField, variant.field);
  scene = replaced(scene, kIntegrator, variant.integrator);
  scene = replaced(scene, kLinearSolver, variant.linear_solver);
  scene = replaced(scene, kConstraint, variant.constraint);
  return replaced(scene, kTimeStep, variant.time_step);
}

PointArray states_of_sofa(const Variant& variant) {
  std::ifstream file(kData + variant.name + ".txt");
  const std::vector<double> numbers(std::istream_iterator<double>(file), {});
  return Eigen::Map<const PointArray>(numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3);
}

struct SofaTrajectories : testing::TestWithParam<Variant> {};

TEST_P(SofaTrajectories, EndWhereSofaEnds) {
  scene::Scene scene = support::read_and_init(scene_of(GetParam()));
  const PointArray start = support::nodes(scene), expected = states_of_sofa(GetParam());
  support::run(scene, 20);
  ASSERT_EQ(expected.rows(), start.rows());
  EXPECT_GT(support::max_abs(expected - start), 0.01) << "nothing moves";
  EXPECT_LT(support::max_abs(support::nodes(scene) - expected), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Variants, SofaTrajectories, testing::ValuesIn(kVariants),
                         [](const auto& variant) { return variant.param.name; });

}  // namespace
