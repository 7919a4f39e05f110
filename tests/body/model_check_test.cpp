// SPDX-License-Identifier: LGPL-2.1-or-later
#include "model_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>

#include "support/core.hpp"

namespace hexaplast {
namespace {

TEST(MeshQuality, IsThatOfTheWorstCorner) {
  const auto of_cube = [](const Mat3& map) { return scaled_jacobian(mapped(support::cube(0.3), map)); };
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_NEAR(of_cube(turn * Vec3(1, 20, 0.1).asDiagonal()), 1, 1e-12) << "a box of any proportions";
  Mat3 shear = Mat3::Identity();
  shear(0, 1) = 1 / std::tan(0.6);  // the y edges lean: the angle to the x edges is 0.6 rad
  EXPECT_NEAR(of_cube(shear), std::sin(0.6), 1e-12);
  ElementPoints x = support::cube(2);
  x.row(6) << -0.25, -0.25, -0.25;  // pushed behind the plane of its three neighbours, which passes (1/3, 1/3, 1/3)
  EXPECT_LT(scaled_jacobian(x), 0);
}

TEST(MeshQuality, FindsTheWorstElementAndTheEdges) {
  PointArray x = support::block({3, 1, 1}, 0.5).positions();
  x(3, 0) += 0.25;  // node (3, 0, 0), of the third cube: its x edge grows to 0.75, the edges beside it lean
  x.conservativeResize(x.rows() + 2, 3);
  x.bottomRows(2).setConstant(7);
  const MeshQuality found = quality(HexMesh(x, support::block({3, 1, 1}, 0.5).hexahedra()));
  EXPECT_EQ(found.worst_element, 2);
  EXPECT_LT(found.min_scaled_jacobian, 0.95);
  EXPECT_DOUBLE_EQ(found.shortest_edge, 0.5);
  EXPECT_DOUBLE_EQ(found.longest_edge, 0.75);
  EXPECT_EQ(found.num_unused_nodes, 2);
  EXPECT_EQ(found.num_inverted, 0);
  EXPECT_TRUE(check_shapes(found).empty());
}

TEST(MeshQuality, CornersThatAreInsideOutAreCounted) {
  PointArray x = support::block({3, 1, 1}, 0.5).positions();
  x.row(3) << 1.3, 0.2, 0.2;  // node (3, 0, 0), pushed behind the plane of its three neighbours in the last cube
  const MeshQuality found = quality(HexMesh(x, support::block({3, 1, 1}, 0.5).hexahedra()));
  EXPECT_EQ(found.worst_element, 2);
  EXPECT_EQ(found.num_inverted, 1);
  ASSERT_EQ(check_shapes(found).size(), 1u);
  EXPECT_EQ(check_shapes(found)[0].find("1 of the hexahedra is inverted at a corner; the worst is hexahedron 2"), 0u)
      << check_shapes(found)[0];

  MeshQuality poor;
  EXPECT_TRUE(check_shapes(poor).empty());
  poor.min_scaled_jacobian = 0.1;
  EXPECT_NE(check_shapes(poor).at(0).find("badly shaped"), std::string::npos);
}

TEST(ModelCheck, TakesTheUtmostOfSeveralMaterials) {
  Material soft{.young_modulus = 1000, .poisson_ratio = 0, .yield_stress = 50, .flow_rate = 2, .rotation_yield = 0.1};
  Material hard{
      .young_modulus = 9000, .poisson_ratio = 0.25, .yield_stress = 90, .rotation_yield = 0.2, .rotation_flow_rate = 3};
  const Body body(support::block({2, 1, 1}, 0.5), {soft, hard}, {.rest_shape = RestShape::kJoined});
  const ModelCheck found = check_model(body, 0.5, 0.01);
  EXPECT_EQ(found.yield_stress, 50);
  EXPECT_DOUBLE_EQ(found.yield_strain, 0.01);  // 90 / 9000, not 50 / 1000
  EXPECT_EQ(found.rotation_yield, 0.2);        // the hard one's: the soft one's rotation never flows
  EXPECT_DOUBLE_EQ(found.cfl_number, std::sqrt(5400.0) * 0.01 / 0.5);  // lambda = mu = 3600 Pa, 2 kg/m^3
  EXPECT_TRUE(model_warnings(found).empty());
}

/// [rad/s] of the fastest vibration of a body at rest, whose masses `divide` divides by: the power method on M^-1 K.
template <class Divide>
double fastest_vibration(Body& body, const Divide& divide) {
  body.linearize(body.mesh().positions());
  Random random(11);
  PointArray u = random.field(body.mesh().num_nodes(), 1);
  double eigenvalue = 0;
  for (int k = 0; k < 400; ++k) {
    PointArray product = PointArray::Zero(u.rows(), 3);
    body.add_stiffness_product(-1, u, product);
    divide(product);
    eigenvalue = product.norm() / u.norm();
    u = product / product.norm();
  }
  return std::sqrt(eigenvalue);
}

double fastest_with_lumped_masses(Body& body, double density) {
  const std::vector<double> mass = lumped_masses(body, density);
  return fastest_vibration(body, [&](PointArray& f) {
    for (Eigen::Index n = 0; n < f.rows(); ++n) f.row(n) /= mass[static_cast<std::size_t>(n)];
  });
}

// Exact for one cube; many cubes vibrate slower, in these blocks at 0.578 of it or faster.
TEST(ModelCheck, TheHighestFrequencyIsThatOfTheFastestVibrationOrSomewhatMore) {
  for (const Bending bending : {Bending::kBlended, Bending::kVertex, Bending::kCentre})
    for (const double nu : {0.0, 0.3, 0.45, 0.49}) {
      const Material material{.young_modulus = 5000, .poisson_ratio = nu};
      Settings settings = published_element();
      settings.bending = bending;
      if (bending != Bending::kBlended) settings.implementation = Implementation::kPlain;
      Body cube(support::block({1, 1, 1}, 0.1), {material}, settings);
      const ModelCheck of_cube = check_model(cube, 1, 0.01);
      EXPECT_NEAR(of_cube.highest_frequency / fastest_with_lumped_masses(cube, 1000), 1, 1e-6) << nu;
      for (const double moved : {0.0, 0.1}) {
        Body block(distorted_block({5, 5, 5}, 0.1, moved, 12), {material}, settings);
        const ModelCheck of_block = check_model(block, 125, 0.01);
        const double ratio = fastest_with_lumped_masses(block, 1000) / of_block.highest_frequency;
        EXPECT_LE(ratio, 1 + 1e-6) << nu << " " << moved;
        EXPECT_GE(ratio, 0.57) << nu << " " << moved;
      }
    }
}

TEST(FractureAdvice, NamesWhatIsMissingForALimitToBeReached) {
  using Sentences = std::vector<std::string>;
  const Material whole{.yield_stress = 300, .flow_rate = 4, .hardening = 0.3};
  EXPECT_TRUE(fracture_warnings({whole}, {}).empty());
  Material tears = whole;
  tears.fracture_stress = 600;
  tears.fracture_stretch = 1.3;
  EXPECT_TRUE(fracture_warnings({tears}, {}).empty());
  const auto changed = [&](double Material::*member, double value) {
    Material material = tears;
    material.*member = value;
    return fracture_warnings({material}, {});
  };
  for (const double hardening : {0.0, -0.1})
    EXPECT_EQ(changed(&Material::hardening, hardening),
              Sentences{"fracture_stress has no effect: without a hardening above 0 the yield stress does not grow"});
  EXPECT_EQ(changed(&Material::yield_stress, std::numeric_limits<double>::infinity()),
            (Sentences{"fracture_stretch has no effect: without yield_stress no stretch flows",
                       "fracture_stress has no effect: without yield_stress the yield stress does not grow"}));
  EXPECT_EQ(changed(&Material::flow_rate, 0),
            (Sentences{"fracture_stretch has no effect: without flow_rate no stretch flows",
                       "fracture_stress has no effect: without flow_rate the yield stress does not grow"}));
  Material wall = tears;
  wall.yield_stress = 1e9;
  EXPECT_EQ(fracture_warnings({tears, wall, tears}, {}),
            Sentences{"yield_stress exceeds fracture_stress in 1 of 3 hexahedra: they tear as soon as they flow"});
  EXPECT_EQ(fracture_warnings({tears, wall, tears}, {}, Names::kScenes),
            Sentences{"yieldStress exceeds fractureStress in 1 of 3 hexahedra: they tear as soon as they flow"});
  tears.fracture_energy = 20;
  EXPECT_EQ(fracture_warnings({tears}, {}),
            Sentences{"fracture_energy has no effect: without fracture = face no crack grows"});
  EXPECT_TRUE(fracture_warnings({tears}, {.fracture = Fracture::kFace}).empty());
  tears.fracture_energy = 0;
  wall.hardening = 0;
  EXPECT_TRUE(fracture_warnings({tears, wall, tears}, {}).empty());
}

TEST(ModelCheck, WarnsOfWhatDoesNothingWithIsolatedRestShapes) {
  EXPECT_TRUE(idle_option_warnings({}, Names::kScenes).empty());
  Settings idle{.rotation_frame = RotationFrame::kWorld, .averaging_steps = 2, .volume_restitution = 5};
  EXPECT_EQ(idle_option_warnings(idle, Names::kScenes).size(), 3u);
  EXPECT_EQ(idle_option_warnings(idle, Names::kScenes)[2],
            "volumeRestitution has no effect with restShape = isolated: flow keeps the volume of a hexahedron");
  idle.rest_shape = RestShape::kJoined;
  EXPECT_TRUE(idle_option_warnings(idle).empty());
}

TEST(ModelCheck, WithoutMassThereAreNoWaves) {
  const ModelCheck found = check_model(Body(support::block({1, 1, 1}, 1), {{}}), 0, 0.01);
  EXPECT_EQ(found.wave_speed, 0);
  EXPECT_EQ(found.yield_strain, std::numeric_limits<double>::infinity());
  EXPECT_EQ(found.rotation_yield, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(model_warnings(found).empty());
}

TEST(ModelCheck, OfABodyWithoutHexahedraHasNoMaterial) {
  const ModelCheck found = check_model(Body(HexMesh(PointArray::Zero(1, 3), {}), {}), 0, 0.01);
  EXPECT_EQ(found.num_parts, 0);
  EXPECT_EQ(found.density, 0);
  EXPECT_EQ(found.max_young_modulus, 0);
}

TEST(ModelCheck, EachUnwiseChoiceIsNamed) {
  const ModelCheck good = check_model(Body(support::block({1, 1, 1}, 1), {{}}), 1, 0.001);
  ASSERT_TRUE(model_warnings(good).empty());
  const auto only_warning = [&](auto change) {
    ModelCheck changed = good;
    change(changed);
    const std::vector<std::string> sentences = model_warnings(changed);
    return sentences.size() == 1 ? sentences[0] : "";
  };
  EXPECT_NE(only_warning([](ModelCheck& s) { s.quality.num_unused_nodes = 3; }).find("3 nodes"), std::string::npos);
  EXPECT_NE(only_warning([](ModelCheck& s) { s.num_parts = 2; }).find("2 unconnected parts"), std::string::npos);
  EXPECT_NE(only_warning([](ModelCheck& s) { s.max_poisson_ratio = 0.495, s.locks = true; }).find("0.495"),
            std::string::npos);
  EXPECT_NE(only_warning([](ModelCheck& s) { s.yield_strain = 0.75; }).find("0.75"), std::string::npos);
  EXPECT_NE(only_warning([](ModelCheck& s) { s.steps_across = 0.5; }).find("0.5 time steps"), std::string::npos);
}

// A cube of 1 m and 1,000 kg; at 9.81 m/s^2 it stands under rho g L = 9,810 Pa.
TEST(ModelCheck, SizesOfNoTissueAreNamed) {
  const Vec3 gravity(0, 0, -9.81);
  const auto warnings = [&](double edge, double mass, double young_modulus) {
    const Body body(support::block({1, 1, 1}, edge), {{.young_modulus = young_modulus, .poisson_ratio = 0.3}});
    const std::vector<std::string> sentences = size_warnings(check_model(body, mass, 0.01), gravity);
    return fmt::format("{}", fmt::join(sentences, "; "));
  };
  EXPECT_EQ(warnings(0.1, 1, 3000), "");
  EXPECT_NE(warnings(100, 1, 3000).find("100 m long: are its coordinates in millimetres?"), std::string::npos);
  EXPECT_NE(warnings(1, 501, 1e6).find("weighs 501 kg"), std::string::npos);
  EXPECT_EQ(warnings(1, 400, 0.51 * 400 * 9.81), "");
  EXPECT_NE(warnings(1, 400, 0.49 * 400 * 9.81).find("shorten the body by 1.02 times its height"), std::string::npos);
}

}  // namespace
}  // namespace hexaplast
