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
                           kConstraint = "<FixedProjectiveConstraint indices=\"0 1 2 3 4 5\"/>",
                           kMass = "<UniformMass totalMass=\"3\"/>";

/// A variant of bar.scn: what takes the place of its parts; empty: they stay.
struct Variant {
  std::string name;
  std::string field = {}, integrator = {}, linear_solver = {}, time_step = {}, constraint = {}, mass = {};
};

std::string field(const std::string& class_name, const std::string& attributes) {
  return "<" + class_name + " youngModulus='5000' poissonRatio='0.3' " + attributes + "/>";
}

const std::string kConjugateGradients = "<CGLinearSolver iterations='500' tolerance='1e-15' threshold='1e-30'/>";

/// The bar's own elements, and some of its faces as a membrane.
std::string with_skin(const std::string& membrane) {
  return std::string(kField) +
         "<Node name='skin'><MeshTopology name='faces' position='@/mesh.position' triangles='0 2 1  1 2 3  2 4 3  3 4 5"
         "  18 19 20  19 21 20  20 21 22  21 23 22  0 6 2  2 6 8'/>" +
         membrane + "</Node>";
}

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
    {.name = "with_mass", .field = field("HexahedronFEMForceFieldAndMass", "density='40'"), .mass = " "},
    {.name = "with_lumped_mass",
     .field = field("HexahedronFEMForceFieldAndMass", "density='40' lumpedMass='true'"),
     .linear_solver = kConjugateGradients,
     .mass = " "},
    {.name = "dynamic_with_mass",
     .field = field("HexahedralFEMForceFieldAndMass", "density='40'"),
     .linear_solver = kConjugateGradients,
     .mass = " "},
    {.name = "left_handed",
     .field = "<Node name='cubes'><MeshTopology name='mirrored' position='@/mesh.position' hexahedra='"
              "6 7 9 8 0 1 3 2  8 9 11 10 2 3 5 4  12 13 15 14 6 7 9 8  14 15 17 16 8 9 11 10  "
              "18 19 21 20 12 13 15 14  20 21 23 22 14 15 17 16'/>" +
              field("HexahedralFEMForceField", "method='large'") + "</Node>",
     .linear_solver = kConjugateGradients},
    {.name = "tetrahedra_large", .field = field("TetrahedronFEMForceField", "")},
    {.name = "tetrahedra_polar", .field = field("TetrahedronFEMForceField", "method='polar' rayleighStiffness='0.01'")},
    {.name = "tetrahedra_small", .field = field("TetrahedronFEMForceField", "method='small'")},
    {.name = "triangular", .field = with_skin("<TriangularFEMForceField youngModulus='300' poissonRatio='0.3'/>")},
    {.name = "triangles",
     .field = with_skin("<TriangleFEMForceField youngModulus='6000' poissonRatio='0.3' thickness='0.05'/>")},
    {.name = "triangles_plane_strain",
     .field = with_skin("<TriangleFEMForceField youngModulus='6000' poissonRatio='0.3' thickness='0.05' "
                        "planeStrain='true'/>"),
     .linear_solver = kConjugateGradients},
};

std::string replaced(std::string scene, std::string_view part, const std::string& by) {
  const std::size_t at = scene.find(part);
  if (at == scene.npos) throw std::runtime_error("no " + std::string(part));
  return by.empty() ? scene : scene.replace(at, part.size(), by);
}

std::string text_of(const std::string& name) {
  std::ifstream file(kData + name);
  return std::string((std::istreambuf_iterator<char>(file)), {});
}

std::string scene_of(const Variant& variant) {
  std::string scene = text_of("bar.scn");
  scene = replaced(scene, kField, variant.field);
  scene = replaced(scene, kIntegrator, variant.integrator);
  scene = replaced(scene, kLinearSolver, variant.linear_solver);
  scene = replaced(scene, kConstraint, variant.constraint);
  scene = replaced(scene, kMass, variant.mass);
  return replaced(scene, kTimeStep, variant.time_step);
}

std::vector<double> numbers_of_sofa(const std::string& name) {
  std::ifstream file(kData + name + ".txt");
  return std::vector<double>(std::istream_iterator<double>(file), {});
}

PointArray states_of_sofa(const std::string& name) {
  const std::vector<double> numbers = numbers_of_sofa(name);
  return Eigen::Map<const PointArray>(numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3);
}

struct SofaTrajectories : testing::TestWithParam<Variant> {};

TEST_P(SofaTrajectories, EndWhereSofaEnds) {
  scene::Scene scene = support::read_and_init(scene_of(GetParam()));
  const PointArray start = support::nodes(scene), expected = states_of_sofa(GetParam().name);
  support::run(scene, 20);
  ASSERT_EQ(expected.rows(), start.rows());
  EXPECT_GT(support::max_abs(expected - start), 0.01) << "nothing moves";
  EXPECT_LT(support::max_abs(support::nodes(scene) - expected), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Variants, SofaTrajectories, testing::ValuesIn(kVariants),
                         [](const auto& variant) { return variant.param.name; });

// RegularGridTopology, CylinderGridTopology and SphereGridTopology, as tetrahedra, hexahedra and triangles.
TEST(SofaGrids, EndWhereSofaEnds) {
  scene::Scene scene = support::read_and_init(text_of("grids.scn"));
  support::run(scene, 20);
  for (const std::string name : {"box", "cylinder", "ball", "sheet"}) {
    const PointArray expected = states_of_sofa("grid_" + name);
    const PointArray& found = support::at<scene::MechanicalState>(scene, name + "/nodes").positions();
    ASSERT_EQ(expected.rows(), found.rows());
    EXPECT_LT(support::max_abs(found - expected), 1e-13) << name;
  }
}

// Free, prescribed, fixed and held by springs, with tissue that follows two frames at once.
TEST(SofaRigidFrames, EndWhereSofaEnds) {
  scene::Scene scene = support::read_and_init(text_of("rigid.scn"));
  support::run(scene, 20);
  const std::vector<double> expected = numbers_of_sofa("rigid_frames");
  const std::vector<double>& frames = scene.root().all<scene::RigidState>().at(0)->reals("position");
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_NEAR(frames[i], expected[i], 1e-13) << i;
  const PointArray tissue = scene.root().all<scene::MechanicalState>().at(0)->positions();
  EXPECT_LT(support::max_abs(tissue - states_of_sofa("rigid_tissue")), 1e-13);
}

}  // namespace
