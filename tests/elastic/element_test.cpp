// SPDX-License-Identifier: LGPL-2.1-or-later
// The element in all its forms: what volume, bending and law have to do with one another.
#include "base/simd.hpp"
#include "hexaplast/material/rows.hpp"
#include "hexaplast/solve/newton_raphson.hpp"
#include "kinematics/polar.hpp"
#include "plain/plain.hpp"
#include "support/core.hpp"
#include "support/elastic_laws.hpp"
#include "support/large_strain.hpp"

namespace hexaplast {
namespace {

constexpr double kYoung = 5000;  // [Pa]
constexpr Bending kBendings[] = {Bending::kBlended, Bending::kAssumedCorner};
constexpr Volumetric kVolumetrics[] = {Volumetric::kSample, Volumetric::kVolumeRatio};
constexpr ElasticLaw kLaws[] = {ElasticLaw::kCorotated, ElasticLaw::kNeoHookean, ElasticLaw::kStableNeoHookean,
                                ElasticLaw::kMooneyRivlin};

std::string word(std::string_view attribute, int value) {
  return std::string(find_row(settings_rows(), attribute, Names::kScenes)->words[value]);
}
std::string name_of(const Settings& settings) {
  return word("bending", static_cast<int>(settings.bending)) + "_" +
         word("volumetric", static_cast<int>(settings.volumetric)) + "_" + word("law", static_cast<int>(settings.law));
}

std::vector<Settings> all_forms() {
  std::vector<Settings> all;
  for (const Bending bending : kBendings)
    for (const Volumetric volumetric : kVolumetrics)
      for (const ElasticLaw law : kLaws) {
        Settings settings = published_element();  // springs come and go: their force is no slope of an energy
        settings.bending = bending;
        settings.volumetric = volumetric;
        settings.law = law;
        all.push_back(settings);
      }
  for (const Bending bending : {Bending::kVertex, Bending::kCentre}) {
    all.push_back(published_element());
    all.back().bending = bending;
  }
  return all;
}

class EveryForm : public testing::TestWithParam<Settings> {
 protected:
  Body body_of(HexMesh mesh, double poisson_ratio = 0.45) const {
    return Body(std::move(mesh), {Material{.poisson_ratio = poisson_ratio}}, GetParam());
  }
};
INSTANTIATE_TEST_SUITE_P(Element, EveryForm, testing::ValuesIn(all_forms()),
                         [](const auto& test) { return name_of(test.param); });

TEST_P(EveryForm, HasAnEnergyBalanceAndAStiffness) {
  Random random(302);
  for (const double distortion : {0.0, 0.15}) {
    Body body = body_of(distorted_block({2, 2, 2}, kEdge, distortion, 301));
    for (const double size : {0.1, 0.3, 0.6}) {  // inverted elements in the last
      SCOPED_TRACE(testing::Message() << distortion << ' ' << size);
      const PointArray x = body.mesh().positions() + random.field(body.mesh().num_nodes(), size * kEdge);
      expect_elastic_laws(body, x, random, size > 0.5);
    }
  }
}

TEST_P(EveryForm, OfARigidMotionHasNeitherForceNorEnergy) {
  Body body = body_of(distorted_block({2, 1, 1}, kEdge, 0.15, 86));
  Random random(85);
  for (int k = 0; k < 1000; ++k) {
    const Mat3 R =
        k % 10 == 0 ? random.rotation_by(std::numbers::pi + random.uniform(-1e-12, 1e-12)) : random.rotation();
    const PointArray x = mapped(body.mesh().positions(), R, random.vector(1));
    ASSERT_LE(max_abs(force_at(body, x)), 1e-10 * kYoung * kEdge * kEdge);
    ASSERT_LE(body.energy(x), 1e-12 * kYoung * kEdge * kEdge * kEdge);
  }
}

// Where nothing is strained the operator with fixed rotations lacks nothing.
TEST_P(EveryForm, StiffnessIsTheSlopeOfTheForceAtARigidMotion) {
  Body body = body_of(distorted_block({2, 2, 2}, kEdge, 0.15, 98));
  Random random(97);
  const PointArray x = mapped(body.mesh().positions(), random.rotation()), dx = random.field(27, 1);
  const double h = 1e-7;
  const PointArray slope = (force_at(body, x + h * dx) - force_at(body, x - h * dx)) / (2 * h);
  PointArray product = PointArray::Zero(27, 3);
  body.linearize(x);
  body.add_stiffness_product(1, dx, product);
  EXPECT_TRUE(agrees(product, slope, 1e-6));
}

TEST_P(EveryForm, PassesThePatchTest) {
  const HexMesh mesh = distorted_block({3, 3, 3}, kEdge, 0.15, 305);
  const std::vector<bool> on_boundary = is_on_boundary(mesh);
  Body body = body_of(mesh);
  Random random(306);
  const Mat3 F = random.rotation() * (Mat3::Identity() + random.matrix(0.2));
  const PointArray f = force_at(body, mapped(mesh.positions(), F));
  double inside = 0, boundary = 0;
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    double& max = on_boundary[n] ? boundary : inside;
    max = std::max(max, f.row(n).norm());
  }
  if (GetParam().bending == Bending::kVertex || GetParam().bending == Bending::kCentre)
    EXPECT_GE(inside, 1e-3 * boundary);
  else
    EXPECT_LE(inside, 1e-10 * boundary);
}

// The centre alone leaves twelve hourglass modes beside them.
TEST_P(EveryForm, HasSixZeroModes) {
  const int num_zero = GetParam().bending == Bending::kCentre ? 18 : 6;
  for (const double distortion : {0.0, 0.15}) {
    Body body = body_of(single_element(distorted_hexahedron(kEdge, distortion, 307)));
    Random random(308);
    const PointArray X = mapped(body.mesh().positions(), random.rotation(), random.vector(1));
    const Eigen::VectorXd at_rest = eigenvalues(stiffness_at(body, X));
    EXPECT_EQ((at_rest.array().abs() <= 1e-10 * at_rest[23]).count(), num_zero) << at_rest.transpose();
    EXPECT_GE(at_rest[num_zero], 1e-3 * at_rest[23]);
  }
}

// Coefficients are in units of the mesh: a millionth of the size is a millionth of the stiffness.
TEST_P(EveryForm, HasTheStiffnessOfItsSize) {
  Random random(317);
  const HexMesh mesh = distorted_block({2, 1, 1}, kEdge, 0.15, 318);
  const PointArray x = mesh.positions() + random.field(mesh.num_nodes(), 0.2 * kEdge);
  Body large = body_of(mesh), small = body_of(HexMesh(1e-6 * mesh.positions(), mesh.hexahedra()));
  const Eigen::MatrixXd K = stiffness_at(large, x), k = stiffness_at(small, 1e-6 * x);
  EXPECT_LE(max_abs(1e6 * k - K), 1e-9 * max_abs(K));
}

TEST_P(EveryForm, ConvergesWithMultigridInEachPrecision) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    Settings settings = GetParam();
    settings.precision = precision;
    if (is_plain({{}}, settings)) continue;  // in double precision and without multigrid
    const HexMesh mesh = block({4, 4, 8}, kEdge);
    MovingBody bar(Body(mesh, {Material{}}, settings), {.gravity = {0, -9.81, 0}, .fixed = nodes_at(mesh, 2, 0)},
                   std::make_unique<PreconditionedConjugateGradients>(1e-6, 100, Preconditioner::kMultigrid));
    for (int step = 0; step < 3; ++step) {
      bar.step();
      EXPECT_TRUE(bar.latest.converged) << "residual " << bar.latest.residual;
    }
  }
}

TEST_P(EveryForm, KeepsItsMomentumWhileSpinning) {
  MovingBody bar(body_of(block({2, 2, 4}, kEdge)), {});
  const Vec3 omega(4, 0, 0), drift(0.3, -0.2, 0.1), centre = bar.positions.colwise().mean().transpose();
  for (int n = 0; n < bar.positions.rows(); ++n)
    bar.velocities.row(n) = (drift + omega.cross(Vec3(bar.positions.row(n)) - centre)).transpose();
  const auto momentum = [&] {
    return Vec3(bar.velocities.transpose() *
                Eigen::Map<const Eigen::VectorXd>(bar.mass().data(), bar.positions.rows()));
  };
  const auto angular_momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (int n = 0; n < bar.positions.rows(); ++n)
      sum += bar.mass()[n] * (Vec3(bar.positions.row(n)) - centre).cross(Vec3(bar.velocities.row(n)));
    return sum;
  };
  const Vec3 before = angular_momentum(), momentum_before = momentum();
  bar.run(100);  // 1 s
  EXPECT_LE((momentum() - momentum_before).norm(), 1e-12 * momentum_before.norm());
  // the guard of Mooney-Rivlin's tangent is not zero where the body is stretched, as this one is by six per cent
  const double lost = GetParam().law == ElasticLaw::kMooneyRivlin ? 0.012 : 0.005;
  EXPECT_LE((angular_momentum() - before).norm(), lost * before.norm());
}

/// MacNeal and Harder's solid patch: a unit cube around a distorted hexahedron, seven elements in all. One corner of
/// the element in front is reentrant.
HexMesh macneal_harder_patch() {
  PointArray positions(16, 3);
  for (int a = 0; a < kCorners; ++a) {
    for (int d = 0; d < 3; ++d) positions(a, d) = kCornerSign[a][d] > 0 ? 1 : 0;
  }
  positions.bottomRows(8) << .249, .342, .192, .826, .288, .288, .850, .649, .263, .273, .750, .230, .320, .186, .643,
      .677, .305, .683, .788, .693, .644, .165, .745, .702;
  std::vector<Hexahedron> hexahedra{{8, 9, 10, 11, 12, 13, 14, 15}};
  for (const auto& face : kFaces) {
    // from the outer face, seen from within, to the same face of the inner element
    hexahedra.push_back({face[0], face[3], face[2], face[1], face[0] + 8, face[3] + 8, face[2] + 8, face[1] + 8});
  }
  return HexMesh(positions, hexahedra);
}

TEST(MacNealHarderPatch, HasTheStatedStressEverywhere) {
  const Material m{.young_modulus = 1e6, .poisson_ratio = 0.25};
  const Lame k = lame(m.young_modulus, m.poisson_ratio);
  Mat3 expected = Mat3::Constant(400);
  expected.diagonal().setConstant(2000);
  const Mat3 gradient = (Mat3() << 2, 1, 1, 1, 2, 1, 1, 1, 2).finished() * 0.5e-3;  // u = 1e-3 (2x + y + z) / 2, ...
  Random random(113);

  for (const bool turned : {false, true}) {
    const Mat3 R = turned ? random.rotation() : Mat3(Mat3::Identity());
    const HexMesh mesh = macneal_harder_patch();
    Body body(mesh, {m});
    PointArray x = mapped(mesh.positions(), R);
    x.topRows(8) = mapped(mesh.positions(), R * (Mat3::Identity() + gradient)).topRows(8);
    LoadedBody system(body, std::vector<double>(16, 0.0), {0, 1, 2, 3, 4, 5, 6, 7}, {});
    CholeskySolver solver;
    NewtonRaphson({.iterations = 100, .relative_successive = 0, .relative_initial = 0, .absolute_residual = 1e-11})
        .solve(system, solver, 0, x);

    for (const Hexahedron& corners : mesh.hexahedra()) {
      const plain::Element element(gather(mesh.positions(), corners), gather(x, corners), k, {});
      for (const Mat3& F : element.samples().F) {
        EXPECT_LE((corotated_stress(polar(F).S, k) - expected).cwiseAbs().maxCoeff(), 1e-10 * 2000);
        EXPECT_LE((polar(F).R - R).cwiseAbs().maxCoeff(), 1e-12);
      }
    }
  }
}

// Corner a of the cube goes where a rotation of the cube takes it: 24 ways to number one and the same hexahedron.
TEST(Force, DoesNotDependOnTheNumberingOfTheCorners) {
  Random random(89);
  const ElementPoints X = distorted_hexahedron(kEdge, 0.2, 90);
  const PointArray x = PointArray(X) + random.field(8, 0.3 * kEdge);
  Body body(single_element(X), {Material{}});
  const PointArray f = force_at(body, x);

  int num_numberings = 0;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3i Q = Eigen::Matrix3i::Zero();
      for (int d = 0; d < 3; ++d) Q(axes[d], d) = signs & (1 << d) ? -1 : 1;
      if (Q.cast<double>().determinant() < 0) continue;
      Hexahedron corners;
      for (int a = 0; a < kCorners; ++a) {
        const Eigen::Vector3i turned = Q * Eigen::Vector3i(kCornerSign[a].data());
        for (int b = 0; b < kCorners; ++b) {
          if (turned == Eigen::Vector3i(kCornerSign[b].data())) corners[a] = b;
        }
      }
      Body renumbered(HexMesh(PointArray(X), {corners}), {Material{}});
      EXPECT_TRUE(agrees(force_at(renumbered, x), f, 1e-12));
      ++num_numberings;
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  EXPECT_EQ(num_numberings, 24);
}

// ---- large strain of one hexahedron, against the solution of the equations for it

struct Uniaxial {
  ElasticLaw law;
  Volumetric volumetric;
  double poisson_ratio, stretch, nominal_stress, volume_ratio;  // stress over Young's modulus
};
void PrintTo(const Uniaxial& u, std::ostream* out) {
  *out << word("law", static_cast<int>(u.law)) << ' ' << u.poisson_ratio << ' ' << u.stretch;
}

class UniaxialStress : public testing::TestWithParam<Uniaxial> {};
INSTANTIATE_TEST_SUITE_P(
    Element, UniaxialStress,
    testing::Values(Uniaxial{ElasticLaw::kCorotated, Volumetric::kSample, 0.45, 0.5, -0.5, 0.750},
                    Uniaxial{ElasticLaw::kCorotated, Volumetric::kSample, 0.45, 2, 1, 0.605},
                    Uniaxial{ElasticLaw::kCorotated, Volumetric::kVolumeRatio, 0.45, 0.5, -0.958, 0.889},
                    Uniaxial{ElasticLaw::kCorotated, Volumetric::kVolumeRatio, 0.45, 1.2, 0.180, 1.016},
                    Uniaxial{ElasticLaw::kCorotated, Volumetric::kVolumeRatio, 0.45, 2, 0.759, 1.043},
                    Uniaxial{ElasticLaw::kCorotated, Volumetric::kVolumeRatio, 0.49, 2, 0.740, 1.008},
                    Uniaxial{ElasticLaw::kNeoHookean, Volumetric::kSample, 0.45, 0.5, -1.069, 0.900},
                    Uniaxial{ElasticLaw::kNeoHookean, Volumetric::kVolumeRatio, 0.45, 1.5, 0.359, 1.033},
                    Uniaxial{ElasticLaw::kNeoHookean, Volumetric::kSample, 0.49, 2, 0.586, 1.010},
                    Uniaxial{ElasticLaw::kStableNeoHookean, Volumetric::kSample, 0.45, 0.5, -1.109, 0.887},
                    Uniaxial{ElasticLaw::kStableNeoHookean, Volumetric::kVolumeRatio, 0.45, 2, 0.667, 1.045},
                    Uniaxial{ElasticLaw::kStableNeoHookean, Volumetric::kSample, 0.49, 2, 0.652, 1.009},
                    Uniaxial{ElasticLaw::kMooneyRivlin, Volumetric::kSample, 0.45, 0.5, -1.194, 0.877},
                    Uniaxial{ElasticLaw::kMooneyRivlin, Volumetric::kVolumeRatio, 0.45, 1.5, 0.337, 1.028},
                    Uniaxial{ElasticLaw::kMooneyRivlin, Volumetric::kSample, 0.49, 2, 0.528, 1.007}));

TEST_P(UniaxialStress, OfOneHexahedronIsThatOfTheLaw) {
  const Uniaxial& asked = GetParam();
  for (const Bending bending : {Bending::kBlended, Bending::kAssumedCorner}) {
    const Strained found = uniaxial(asked.poisson_ratio, asked.stretch,
                                    {.bending = bending, .volumetric = asked.volumetric, .law = asked.law});
    EXPECT_NEAR(found.force, asked.nominal_stress, 0.0006);
    EXPECT_NEAR(found.volume_ratio, asked.volume_ratio, 0.0006);
  }
}

// ---- an independent writing-out of the equations

using Case = std::tuple<std::string, std::string>;  // file, variant

class GoldenElement : public testing::TestWithParam<Case> {};

std::vector<Case> golden_cases() {
  std::vector<Case> cases;
  for (const std::string file : {"golden_element_hexahedron", "golden_element_mesh"}) {
    const Json data = test_data("element", file);
    for (const auto& [name, variant] : data.at("variants").items()) cases.emplace_back(file, name);
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Element, GoldenElement, testing::ValuesIn(golden_cases()), [](const auto& test) {
  return std::get<0>(test.param).substr(15) + "_" + std::get<1>(test.param);
});

TEST_P(GoldenElement, EnergyForceAndTangent) {
  const auto& [file, name] = GetParam();
  const Json data = test_data("element", file), &variant = data.at("variants").at(name);
  Settings settings;
  for (const auto& [attribute, value] : variant.at("options").items()) {
    const Row<Settings>* row = find_row(settings_rows(), attribute, Names::kScenes);
    ASSERT_TRUE(row) << attribute;
    row->at.set(settings, value.is_string() ? place_of_word(*row, value.get<std::string>()) : value.get<double>());
  }
  const Material material{.young_modulus = data.at("youngModulus"), .poisson_ratio = data.at("poissonRatio")};
  std::vector<Hexahedron> hexahedra{{0, 1, 2, 3, 4, 5, 6, 7}};
  if (data.contains("hexahedra")) hexahedra = support::hexahedra(data.at("hexahedra"));
  const PointArray X = matrix(data.at("material")), x = matrix(data.at("world")), dx = matrix(data.at("dx"));
  for (const std::string& target : simd_targets()) {
    set_simd_target(target);
    Body body(HexMesh(X, hexahedra), {material}, settings);
    EXPECT_NEAR(body.energy(x), variant.at("energy").get<double>(), 1e-12 * variant.at("energy").get<double>());
    EXPECT_TRUE(agrees(force_at(body, x), matrix(variant.at("force")), 1e-12)) << target;
    PointArray product = PointArray::Zero(X.rows(), 3);
    body.add_stiffness_product(1, dx, product);
    const char* const tangent = variant.contains("tangent_product") ? "tangent_product" : "tangent_product_frozen";
    EXPECT_TRUE(agrees(product, matrix(variant.at(tangent)), 1e-12)) << target;
    EXPECT_TRUE(agrees(unstacked(-stiffness_at(body, x) * stacked(dx)), product, 1e-12)) << target;
  }
  set_simd_target("");
}

// ---- springs that lead folded elements back

TEST(GoldenRecovery, EnergyForceAndTangent) {
  const Json data = test_data("element", "golden_element_recovery");
  Settings settings{.rest_shape = RestShape::kJoined};  // springs alone
  settings.recovery = RecoveryMode::kCluster;
  settings.recovery_strength = data.at("strength");
  settings.recovery_from = settings.recovery_full = data.at("threshold");
  const Material material{.young_modulus = data.at("youngModulus"), .poisson_ratio = data.at("poissonRatio")};
  const PointArray X = matrix(data.at("material"));
  for (const auto& [name, found] : data.at("cases").items()) {
    const PointArray x = matrix(found.at("world")), dx = matrix(found.at("dx"));
    Settings without = settings;
    without.recovery = RecoveryMode::kNone;
    const HexMesh mesh(X, support::hexahedra(data.at("hexahedra")));
    Body with_springs(mesh, {material}, settings), without_springs(mesh, {material}, without);
    const double energy = with_springs.energy(x) - without_springs.energy(x);
    EXPECT_NEAR(energy, found.at("energy").get<double>(), 1e-11 * energy) << name;
    EXPECT_TRUE(agrees(force_at(with_springs, x) - force_at(without_springs, x), matrix(found.at("force")), 1e-11))
        << name;
    PointArray product = PointArray::Zero(X.rows(), 3);
    with_springs.add_stiffness_product(1, dx, product);
    without_springs.add_stiffness_product(-1, dx, product);
    // the prototype adds 5e-9 of its trace to B^T W B
    EXPECT_TRUE(agrees(product, matrix(found.at("tangent_product")), 2e-8)) << name;
  }
}

double min_corner_ratio(const HexMesh& mesh, const PointArray& x) {
  double min = 1e300;
  for (const Hexahedron& corners : mesh.hexahedra())
    for (int a = 0; a < kCorners; ++a)
      min = std::min(min, corner_jacobian(gather(x, corners), a).determinant() /
                              corner_jacobian(gather(mesh.positions(), corners), a).determinant());
  return min;
}

// Elements that cannot be folded are passed over: that must miss none.
TEST(Recovery, ActsAsSoonAsACornerIsThin) {
  Random random(319);
  for (int round = 0; round < 400; ++round) {
    Settings settings{.rest_shape = RestShape::kJoined};  // springs alone
    settings.recovery_from = round % 3 == 0 ? 0.5 : 0.05;
    const Mat3 sheared = Mat3::Identity() + 0.5 * Mat3(random.field(3, 1));
    const HexMesh cubes = block({2, 2, 1}, kEdge);
    const HexMesh mesh(mapped(cubes.positions(), sheared * sheared.transpose()), cubes.hexahedra());
    const PointArray way = random.field(mesh.num_nodes(), kEdge) + mapped(cubes.positions(), Mat3(random.field(3, 1)));
    double thick = 0, thin = 1;  // of the way
    while (min_corner_ratio(mesh, mesh.positions() + thin * way) >= settings.recovery_from) thin *= 2;
    while (thin - thick > 1e-9) {
      const double middle = (thin + thick) / 2;
      (min_corner_ratio(mesh, mesh.positions() + middle * way) < settings.recovery_from ? thin : thick) = middle;
    }
    Body body(mesh, {Material{}}, settings);
    for (const double fraction : {0.05 * thick, 0.3 * thick, 0.6 * thick, 0.9 * thick, thick, thin, 2 * thin}) {
      const PointArray x = mesh.positions() + fraction * way;
      force_at(body, x);
      EXPECT_EQ(body.state().backend->recovery().acts(), min_corner_ratio(mesh, x) < settings.recovery_from)
          << round << " " << fraction;
    }
  }
}

TEST(Recovery, IsInAssembledMatricesAsInProducts) {
  for (const int width : {1, 7}) {  // large clusters leave their six rigid motions to products
    const HexMesh mesh = distorted_block({8, width, width}, kEdge, 0.1, 317);
    Random random(318);
    PointArray x = mesh.positions();
    for (int n = 0; n < mesh.num_nodes(); ++n)  // both ends are folded, the middle is not: two clusters
      if (std::abs(x(n, 0) - 4 * kEdge) > 2.5 * kEdge) x.row(n) += random.field(1, 0.9 * kEdge).row(0);
    Body body(mesh, {Material{}});
    const Eigen::MatrixXd K = stiffness_at(body, x);
    BlockMatrix again(mesh.num_nodes());
    body.add_stiffness_blocks(-1, again);
    EXPECT_EQ(again.leaves_out(), width == 7);
    constexpr int kProducts = 14;  // more than there are motions in all
    Eigen::MatrixXd left_out(K.rows(), kProducts);
    for (int k = 0; k < kProducts; ++k) {
      const PointArray dx = random.field(mesh.num_nodes(), 1);
      PointArray product = PointArray::Zero(mesh.num_nodes(), 3);
      body.add_stiffness_product(-1, dx, product);
      left_out.col(k) = (K * stacked(dx) - stacked(product)) / product.norm();
      EXPECT_GE(stacked(dx).dot(left_out.col(k)), -1e-12) << "the matrix is not less than the operator";
    }
    const Eigen::VectorXd sizes = left_out.jacobiSvd().singularValues();
    EXPECT_EQ((sizes.array() > 1e-10).count(), width == 1 ? 0 : 12) << sizes.transpose();
  }
}

TEST(Recovery, IsInEverySystemThatABodyDescribesWithItsOwnFactor) {
  const HexMesh mesh = distorted_block({3, 2, 2}, kEdge, 0.1, 319);
  Random random(320);
  Body body(mesh, {Material{}}, {.recovery = RecoveryMode::kCluster});
  body.linearize(mesh.positions() + random.field(mesh.num_nodes(), 0.9 * kEdge));
  const PointArray p = random.field(mesh.num_nodes(), 1);
  const auto product = [&](const MatrixFreeSystem& system) {
    PointArray Fp = PointArray::Zero(p.rows(), 3);
    for (const NodalTerm& term : system.others) term.add_product(p, Fp);
    return Fp;
  };
  MatrixFreeSystem first, second;
  body.add_operator(-1, first);
  const PointArray alone = product(first);
  ASSERT_GT(alone.norm(), 0);
  body.add_operator(-4, second);
  EXPECT_EQ(product(first), alone);
  EXPECT_TRUE(agrees(product(second), 4 * alone, 1e-14));
}

// A cube of 1 m whose corner 0 is pushed to (t, t, t): there d = det(1 - t 1 1^T) = 1 - 3 t, and 1 - t at its
// neighbours.
TEST(CornerEnergy, OfACubeIsThatByHand) {
  const Material material;
  const double mu = material.young_modulus / (2 * (1 + material.poisson_ratio)), t = 0.5, missing = 0.3 - (1 - 3 * t);
  const HexMesh cube = block({1, 1, 1}, 1);
  PointArray x = cube.positions();
  x.row(0).setConstant(t);
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const Settings settings{
        .recovery_strength = 1e-12,  // springs that nobody feels
        .rest_shape = RestShape::kIsolated,
        .precision = precision,
    };
    Settings without = settings;
    without.recovery = RecoveryMode::kNone;
    Body with_energy(cube, {material}, settings), alone(cube, {material}, without);
    EXPECT_NEAR(with_energy.energy(x) - alone.energy(x), 5 * mu / 16 * missing * missing, 1e-9 * mu);
    const PointArray force = force_at(with_energy, x) - force_at(alone, x);
    EXPECT_NEAR(force.row(0).sum(), -5 * mu / 8 * missing * 3, 1e-9 * mu);  // - dE/dt
  }
}

// On a folded mesh: the force against the slope of the energy, the product against slopes of the ratios of corners, and
// blocks, diagonal and the term of linear systems against the product.
TEST(CornerEnergy, ForceAndProductAreSlopes) {
  const HexMesh mesh = distorted_block({2, 2, 2}, kEdge, 0.1, 321);
  Random random(322);
  const PointArray X = mesh.positions(), x = X + random.field(mesh.num_nodes(), 0.6 * kEdge),
                   p = random.field(mesh.num_nodes(), 1);
  constexpr double kMu = 700, kVolume = 1e-3, kNudge = 1e-7;
  const auto corners_at = [&](const PointArray& at) {
    CornerEnergy corners;
    for (const Hexahedron& nodes : mesh.hexahedra())
      corners.add(nodes, kMu, kVolume, gather(X, nodes), gather(at, nodes));
    return corners;
  };
  const CornerEnergy corners = corners_at(x);
  ASSERT_TRUE(corners.acts());
  PointArray f = PointArray::Zero(x.rows(), 3), product = f, expected = f, diagonal = f;
  corners.add_force(f);
  const double slope = (corners_at(x + kNudge * p).energy() - corners_at(x - kNudge * p).energy()) / (2 * kNudge);
  EXPECT_NEAR(f.cwiseProduct(p).sum(), -slope, 1e-6 * std::abs(slope));

  corners.add_product(2, p, product);
  for (const Hexahedron& nodes : mesh.hexahedra()) {
    const auto ratios = [&](const PointArray& at) { return corner_ratios(gather(X, nodes), gather(at, nodes)); };
    const CornerValues now = ratios(x), ahead = ratios(x + kNudge * p), behind = ratios(x - kNudge * p);
    for (int n = 0; n < x.rows(); ++n)
      for (int axis = 0; axis < 3; ++axis) {
        PointArray unit = PointArray::Zero(x.rows(), 3);
        unit(n, axis) = kNudge;
        const CornerValues above = ratios(x + unit), below = ratios(x - unit);
        for (int i = 0; i < kCorners; ++i)
          if (now[i] < CornerEnergy::kFrom)
            expected(n, axis) += 2 * CornerEnergy::kStrength * kMu * kVolume / 8 * (above[i] - below[i]) *
                                 (ahead[i] - behind[i]) / (4 * kNudge * kNudge);
      }
  }
  EXPECT_TRUE(agrees(product, expected, 1e-6));

  BlockMatrix K(mesh.num_nodes());
  corners.add_blocks(2, K);
  const Eigen::MatrixXd dense = support::dense(K);
  EXPECT_TRUE(agrees(unstacked(dense * stacked(p)), product, 1e-12));
  corners.add_diagonal(2, diagonal);
  EXPECT_TRUE(agrees(unstacked(dense.diagonal()), diagonal, 1e-12));
}

// Beside cubes of 1 m, gradients in a layer of 1e-5 m are 1e5: more than half precision has.
TEST(MixedPrecision, TakesHexahedraHoweverThinBesideOthers) {
  PointArray positions = block({1, 1, 2}, 1).positions();
  positions.bottomRows(4).col(2).setConstant(1 + 1e-5);
  const HexMesh mesh(positions, block({1, 1, 2}, 1).hexahedra());
  const PointArray dx = Random(321).field(mesh.num_nodes(), 1e-5);
  const auto product = [&](Precision precision) {
    Body body(mesh, {Material{}}, {.precision = precision});
    body.linearize(mesh.positions());
    PointArray df = PointArray::Zero(mesh.num_nodes(), 3);
    body.add_stiffness_product(1, dx, df);
    return df;
  };
  EXPECT_TRUE(agrees(product(Precision::kMixed), product(Precision::kDouble), 1e-3));
}

}  // namespace
}  // namespace hexaplast
