// SPDX-License-Identifier: LGPL-2.1-or-later
// Small scenes of contact with what hand or symmetry tells of each, as they stand, turned, and mirrored; and a ball
// that is pressed into an elastic block, against Hertz and CalculiX (docs/validation.md).
#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hexaplast/body.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "support/compare.hpp"
#include "support/mesh_text.hpp"
#include "support/scene.hpp"
#include "support/shapes.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// Where a scene stands in space. Its vectors are told, and asked for, as if it were neither turned nor mirrored.
struct Placed {
  Mat3 turn;  // may mirror

  std::string vector(const Vec3& v) const { return text(turn * v); }
  std::string vectors(const std::vector<Vec3>& vs) const {
    std::string all;
    for (const Vec3& v : vs) all += vector(v) + "  ";
    return all;
  }
  /// Of a tool that is its own image in its middle, turned by this.
  std::string orientation(const Eigen::AngleAxisd& own) const {
    const Eigen::Quaterniond q(Mat3(turn.determinant() * turn * own.toRotationMatrix()));
    return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}  ", q.x(), q.y(), q.z(), q.w());
  }
  Vec3 own(const Vec3& v) const { return turn.transpose() * v; }

  /// A block in a node of its own. held: of its nodes, where they are.
  std::string body(const std::string& name, std::array<int, 3> cells, const Vec3& min, const Vec3& max,
                   const std::string& material, bool (*held)(const Vec3&), const std::string& inside = "") const {
    return body(name, regular_grid(cells, min, max), material, held, inside);
  }
  std::string body(const std::string& name, const HexMesh& mesh, const std::string& material, bool (*held)(const Vec3&),
                   const std::string& inside = "") const {
    std::string fixed;
    for (int n = 0; n < mesh.num_nodes(); ++n)
      if (held && held(mesh.positions().row(n).transpose())) fixed += std::to_string(n) + " ";
    std::vector<Hexahedron> hexahedra = mesh.hexahedra();
    if (turn.determinant() < 0)
      for (Hexahedron& corners : hexahedra)
        for (int a = 0; a < kCorners; a += 2) std::swap(corners[a], corners[a + 1]);
    return "<Node name='" + name + "'>" + mesh_topology(HexMesh(mapped(mesh.positions(), turn), hexahedra)) +
           "<MechanicalObject name='state'/><UniformMass totalMass='.02'/>"
           "<HexahedronElastoplasticFEMForceField name='body' " +
           material + "/>" + (fixed.empty() ? "" : "<FixedProjectiveConstraint indices='" + fixed + "'/>") + inside +
           "</Node>";
  }
  std::string root(double dt, double gravity, const std::string& integrator, const std::string& inside) const {
    return fmt::format(
        "<Node dt='{:g}' gravity='{}'><DefaultAnimationLoop/><EulerImplicitSolver {}/>"
        "<SparseLDLSolver/>{}</Node>",
        dt, vector({0, 0, -gravity}), integrator, inside);
  }
  std::string tool(const std::string& shape, const std::string& times, const std::vector<Vec3>& positions,
                   const std::string& name = "tool") const {
    return "<InstrumentContactForceField name='" + name + "' " + shape + " keyTimes='" + times + "' positions='" +
           vectors(positions) + "'/>";
  }

  Vec3 force(scene::Scene& scene, const std::string& path) const {
    return own(Vec3::Map(at<scene::Component>(scene, path).reals("force").data()));
  }
  Vec3 momentum(scene::Scene& scene, const std::string& body) const {
    return own(kMass * at<scene::MechanicalState>(scene, body + "/state").velocities().colwise().mean().transpose());
  }
  PointArray positions(scene::Scene& scene, const std::string& body) const {
    return at<scene::MechanicalState>(scene, body + "/state").positions() * turn;
  }

  static constexpr double kMass = 0.02;  // of each body [kg]

 private:
  static std::string text(const Vec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z()); }
};

class ContactCases : public testing::TestWithParam<Placed> {};
INSTANTIATE_TEST_SUITE_P(Placed, ContactCases,
                         testing::Values(Placed{Mat3::Identity()},
                                         Placed{Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).matrix()},
                                         Placed{Vec3(-1, 1, 1).asDiagonal()},
                                         Placed{-Eigen::AngleAxisd(2.3, Vec3(2, 1, 3).normalized()).matrix()}));

constexpr double kWeight = Placed::kMass * 9.81;  // [N]
const std::string kSoft = "youngModulus='10000' poissonRatio='.3'";
const std::string kBetween = "<TissueContactForceField name='contact' object1='@lower/state' object2='@upper/state' ";
bool bottom(const Vec3& x) { return x.z() < 1e-9; }
bool rim(const Vec3& x) { return std::max(std::abs(x.x()), std::abs(x.y())) > 0.0199; }

// Without friction what falls, or begins, beside an edge or a corner is not pushed aside, however long a step is, and
// comes to be carried.
TEST_P(ContactCases, ABlockThatLandsBesideAnEdge) {
  const Placed& p = GetParam();
  for (const Vec3& min : {Vec3(0.019, 0.009, 0.0205), Vec3(0.0197, 0.0196, 0.02)})
    for (const double dt : {0.01, 0.004}) {
      scene::Scene scene = read_and_init(p.root(
          dt, 9.81, "rayleighMass='.1' rayleighStiffness='.01'",
          kBetween + "/>" + p.body("lower", {4, 4, 2}, {0, 0, 0}, {0.04, 0.04, 0.02}, "youngModulus='1e7'", bottom) +
              p.body("upper", {2, 2, 2}, min, min + Vec3::Constant(0.02), kSoft, nullptr)));
      for (int k = 0; k < 60; ++k) {
        scene.step();
        const Vec3 force = p.force(scene, "contact");
        EXPECT_LT(force.head<2>().norm(), 0.02 * std::abs(force.z()) + 1e-9) << min.x() << " " << dt << " step " << k;
      }
      EXPECT_NEAR(p.force(scene, "contact").z(), -kWeight, 0.01 * kWeight) << min.x() << " " << dt;
    }
}

// Pinched between a ball and a plate a free body tears, and its momentum goes on being what these two give it.
// Reported is what acted, also where the integrator damps velocities afterwards.
TEST_P(ContactCases, ABodyThatTearsUnderContact) {
  const Placed& p = GetParam();
  const double h = 0.005, decay = std::exp(-20 * h);
  const std::string plate = "shape='box' size='.1 .1 .02' orientations='" + p.orientation({0, Vec3::UnitZ()}) + "'";
  scene::Scene scene = read_and_init(p.root(
      h, 0, "vdamping='20'",
      p.body(
          "block", {4, 4, 2}, {0, 0, 0}, {0.04, 0.04, 0.02},
          "youngModulus='10000' yieldStress='50' plasticFlowRate='20' hardening='1' fractureStress='150'", nullptr,
          p.tool("radius='.008' friction='.5' damping='1e3'", "0 .3", {{0.019, 0.022, 0.029}, {0.019, 0.022, 0.009}}) +
              p.tool(plate, "0", {{0.02, 0.02, -0.0101}}, "plate"))));
  for (int k = 0; k < 60; ++k) {
    const Vec3 before = p.momentum(scene, "block");
    scene.step();
    const Vec3 force = p.force(scene, "block/tool") + p.force(scene, "block/plate");
    EXPECT_LT((p.momentum(scene, "block") / decay - before + h * force).norm(), 1e-9) << k;
  }
  EXPECT_FALSE(at<scene::ForceField>(scene, "block/body").body()->removed().empty());
}

TEST_P(ContactCases, BodiesThatMeetKeepTheirMomentum) {
  const Placed& p = GetParam();
  scene::Scene scene = read_and_init(
      p.root(0.005, 0, "",
             kBetween + "friction='.3'/>" + p.body("lower", {4, 4, 2}, {0, 0, 0}, {0.04, 0.04, 0.02}, kSoft, nullptr) +
                 p.body("upper", {2, 2, 2}, {0.0113, 0.013, 0.021}, {0.0313, 0.033, 0.041}, kSoft, nullptr)));
  at<scene::MechanicalState>(scene, "upper/state").velocities().rowwise() =
      Vec3(p.turn * Vec3(0.05, 0.02, -0.3)).transpose();
  const auto momentum = [&] { return Vec3(p.momentum(scene, "lower") + p.momentum(scene, "upper")); };
  const auto angular = [&] {
    Vec3 sum = Vec3::Zero();
    for (scene::MechanicalState* state : scene.root().all<scene::MechanicalState>())
      sum += Placed::kMass / state->num_nodes() * moment(state->positions(), state->velocities());
    return sum;
  };
  const Vec3 before = momentum(), angular_before = angular();
  double touched = 0;
  for (int k = 0; k < 60; ++k) {
    scene.step();
    touched = std::max(touched, at<scene::Component>(scene, "contact").reals("touching")[0]);
  }
  EXPECT_GT(touched, 20);
  EXPECT_EQ(at<scene::Component>(scene, "contact").reals("touching")[0], 0);
  EXPECT_LT((momentum() - before).norm(), 1e-12 * before.norm());
  EXPECT_LT((angular() - angular_before).norm(), 0.02 * angular_before.norm()) << "linearised steps";
}

// Of two blocks that are one body, the upper one comes to lie on the lower one, or falls through it.
TEST_P(ContactCases, ABodyThatLiesOnItself) {
  const Placed& p = GetParam();
  const HexMesh blocks = joined(regular_grid({4, 4, 2}, {0, 0, 0}, {0.04, 0.04, 0.02}),
                                regular_grid({2, 2, 2}, {0.0113, 0.013, 0.025}, {0.0313, 0.033, 0.045}));
  for (const bool touches : {true, false}) {
    scene::Scene scene =
        read_and_init(p.root(0.005, 9.81, "rayleighMass='.1' rayleighStiffness='.01'",
                             std::string(touches ? "<TissueContactForceField object1='@both/state'/>" : "") +
                                 p.body("both", blocks, kSoft, bottom)));
    run(scene, 100);
    EXPECT_EQ(p.positions(scene, "both").bottomRows(27).col(2).minCoeff() > 0.019, touches);
  }
}

// A block that lies on another one whose prescribed motion turns: what is reported is what changes its momentum.
TEST_P(ContactCases, AMotionThatTurnsBack) {
  const Placed& p = GetParam();
  const double h = 0.005, rayleigh_mass = 0.1;
  const std::string motion = "<LinearMovementProjectiveConstraint indices='0-74' keyTimes='0 .1 .2 1' movements='" +
                             p.vectors({{0, 0, 0}, {0, 0, 0.006}, {0, 0, 0.002}, {0, 0, 0}}) + "'/>";
  scene::Scene scene = read_and_init(p.root(
      h, 9.81, "rayleighMass='.1'",
      kBetween + "damping='1e3'/>" + p.body("lower", {4, 4, 2}, {0, 0, 0}, {0.04, 0.04, 0.02}, kSoft, nullptr, motion) +
          p.body("upper", {2, 2, 2}, {0.0113, 0.013, 0.02}, {0.0313, 0.033, 0.04}, kSoft, nullptr)));
  double greatest = 0;
  for (int k = 0; k < 60; ++k) {
    const Vec3 before = p.momentum(scene, "upper");
    scene.step();
    const Vec3 force = p.force(scene, "contact"), after = p.momentum(scene, "upper");
    greatest = std::max(greatest, -force.z());
    const Vec3 acted = (after - before) / h + rayleigh_mass * after + Vec3(0, 0, kWeight);
    EXPECT_LT((acted + force).norm(), 1e-8 * kWeight + 1e-6 * greatest) << k;
  }
  EXPECT_GT(greatest, 1.5 * kWeight);
}

TEST_P(ContactCases, AnInstrumentThatTurns) {
  const Placed& p = GetParam();
  for (const auto& [shape, axis, above] :
       {std::tuple("shape='box' size='.2 .2 .01'", Vec3(0, 0, 1), 0.035),
        std::tuple("shape='cylinder' radius='.01' length='.1'", Vec3(0, 0, 1), 0.04)}) {
    const bool rolls = above > 0.035;  // its axis, z, lies along x
    const auto pressed = [&](double turned) {
      std::string times, orientations;
      std::vector<Vec3> positions;
      for (int k = 0; k <= 40; ++k) {
        times += fmt::format("{:g} ", 0.01 * k);
        positions.emplace_back(0.031, 0.029, above - 0.0001 * std::min(k, 20));
        const Eigen::Quaterniond lies(Eigen::AngleAxisd(rolls ? std::acos(0.0) : 0, Vec3::UnitY()));
        orientations += p.orientation(Eigen::AngleAxisd(lies * Eigen::AngleAxisd(turned * k, axis)));
      }
      scene::Scene scene = read_and_init(
          p.root(0.01, 0, "rayleighStiffness='.01'",
                 p.body("block", {6, 6, 3}, {0, 0, 0}, {0.06, 0.06, 0.03}, kSoft, bottom,
                        p.tool(std::string(shape) + " orientations='" + orientations + "'", times, positions))));
      run(scene, 40);
      return p.force(scene, "block/tool");
    };
    const Vec3 still = pressed(0), turning = pressed(0.6);
    EXPECT_GT(still.z(), 0.05) << shape;
    EXPECT_LT((turning - still).norm(), 1e-6 * still.norm()) << shape;
  }
}

TEST_P(ContactCases, ComingBackOnTheOtherSide) {
  const Placed& p = GetParam();
  const std::string times = "0 .1 .3 .4 .5 .6 .7 .8 2";
  const std::vector<Vec3> way = {{0, 0, 0.0155},    {0, 0, 0.0115},  {0, 0, 0.0115},  {0, 0, 0.0255}, {0.1, 0, 0.0255},
                                 {0.1, 0, -0.0255}, {0, 0, -0.0155}, {0, 0, -0.0115}, {0, 0, -0.0115}};
  std::vector<Vec3> moved;
  for (const Vec3& at : way) moved.push_back(at - way[0]);
  const std::string turned(p.orientation({0, Vec3::UnitZ()}));
  std::string orientations;
  for (std::size_t k = 0; k < way.size(); ++k) orientations += turned;
  const auto sheet = [&](const std::string& inside) {
    return p.body("lower", {8, 8, 2}, {-0.02, -0.02, -0.002}, {0.02, 0.02, 0.002}, kSoft, rim, inside);
  };
  const std::vector<std::pair<std::string, std::string>> scenes = {
      {"lower/tool", sheet(p.tool("shape='box' size='.02 .02 .02' orientations='" + orientations + "'", times, way))},
      {"contact", kBetween + "/>" + sheet("") +
                      p.body("upper", {2, 2, 2}, {-0.01, -0.01, 0.0055}, {0.01, 0.01, 0.0255}, kSoft, nullptr,
                             "<LinearMovementProjectiveConstraint indices='0-26' keyTimes='" + times + "' movements='" +
                                 p.vectors(moved) + "'/>")}};
  for (const auto& [path, text] : scenes) {
    scene::Scene scene = read_and_init(p.root(0.01, 0, "rayleighMass='5' rayleighStiffness='.01'", text));
    run(scene, 30);
    const double above = p.force(scene, path).z();
    run(scene, 15);
    EXPECT_EQ(p.force(scene, path), Vec3::Zero()) << path;
    run(scene, 55);
    EXPECT_GT(std::abs(above), 0.01) << path;
    EXPECT_NEAR(p.force(scene, path).z(), -above, 1e-3 * std::abs(above)) << path;
  }
}

using Json = nlohmann::json;

const Json& reference() {
  static const Json table = Json::parse(std::ifstream(HEXAPLAST_TEST_DATA "/calculix/indentation.json"));
  return table;
}

const Json& coarse() { return reference()["meshes"]["coarse"]; }

/// A quarter of the block with planes of symmetry, held at its bottom, and a ball that comes down by each depth [m] and
/// stays there for a while. Steps of .1 s are longer than a period of the block: every stay ends at rest.
struct Indentation {
  static constexpr double kStep = 0.1;         // [s]
  static constexpr int kDown = 5, kStay = 15;  // steps

  Indentation(double poisson_ratio, const std::vector<double>& depths, double stiffness) {
    const std::vector<double> across = coarse()["across"], up = coarse()["up"];  // [mm] of a graded mesh
    const int n = static_cast<int>(across.size()) - 1, m = static_cast<int>(up.size()) - 1;
    const HexMesh cells = support::block({n, n, m}, 1);
    PointArray x = cells.positions();
    for (auto row : x.rowwise())
      row << 1e-3 * across[std::lround(row[0])], 1e-3 * across[std::lround(row[1])], 1e-3 * up[std::lround(row[2])];
    const auto held = [&](int axis, const std::string& direction) {
      return fmt::format("<PartialFixedProjectiveConstraint indices='{}' fixedDirections='{}'/>",
                         fmt::join(nodes_at(cells, axis, 0), " "), direction);
    };
    const double radius = reference()["radius"], top = 1e-3 * up.back() + radius;
    std::string times = "0", places = fmt::format("0 0 {}", top);
    for (std::size_t d = 0; d < depths.size(); ++d) {
      const double begin = kStep * static_cast<double>(d * (kDown + kStay));
      times += fmt::format(" {} {}", begin + kStep * kDown, begin + kStep * (kDown + kStay));
      for (int end = 0; end < 2; ++end) places += fmt::format("  0 0 {}", top - depths[d]);
    }
    scene = std::make_unique<scene::Scene>(read_and_init(fmt::format(
        "<Node dt='{}' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/>"
        "<MultigridCGLinearSolver tolerance='1e-6'/>{}<MechanicalObject name='nodes'/><UniformMass totalMass='.01'/>"
        "<HexahedronElastoplasticFEMForceField youngModulus='{}' poissonRatio='{}'/>{}{}{}"
        "<InstrumentContactForceField name='ball' radius='{}' contactStiffness='{}' keyTimes='{}' positions='{}'/>"
        "</Node>",
        kStep, mesh_topology(HexMesh(x, cells.hexahedra())), reference()["young_modulus"].get<double>(), poisson_ratio,
        held(2, "1 1 1"), held(0, "1 0 0"), held(1, "0 1 0"), radius, stiffness, times, places)));
    for (std::size_t d = 0; d < depths.size(); ++d) {
      run(*scene, kDown + kStay);
      forces.push_back(4 * at<scene::Component>(*scene, "ball").reals("force")[2]);
    }
  }

  std::unique_ptr<scene::Scene> scene;
  std::vector<double> forces;  // [N] on the whole ball, at the end of each stay
};

/// [N] Hertz, with the correction for a layer that sticks to a rigid ground (Dimitriadis et al., Biophys. J. 82, 2002).
double hertz(double depth, double E, double nu, double radius, double thickness) {
  constexpr double pi = std::numbers::pi;
  const double chi = std::sqrt(radius * depth) / thickness;
  const double a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  const double factor = 1 - 2 * a / pi * chi + 4 * a * a / (pi * pi) * chi * chi -
                        8 / std::pow(pi, 3) * (std::pow(a, 3) + 4 * pi * pi / 15 * b) * std::pow(chi, 3) +
                        16 * a / std::pow(pi, 4) * (std::pow(a, 3) + 3 * pi * pi / 5 * b) * std::pow(chi, 4);
  return 4 * E * std::sqrt(radius) * std::pow(depth, 1.5) / (3 * (1 - nu * nu)) * factor;
}

double thickness() { return 1e-3 * coarse()["up"].back().get<double>(); }

TEST(Indentation, AgreesWithCalculixAndHertz) {
  const double E = reference()["young_modulus"], nu = reference()["poisson_ratio"], radius = reference()["radius"];
  const std::vector<double> depths = {0.25e-3, 0.5e-3, 1e-3};
  const Indentation ours(nu, depths, reference()["penalty"]);
  for (std::size_t d = 0; d < depths.size(); ++d) {
    const double by_hertz = hertz(depths[d], E, nu, radius, thickness());
    std::cout << fmt::format("depth {:.2f} mm: {:.5f} N, Hertz {:.5f}", 1e3 * depths[d], ours.forces[d], by_hertz);
    EXPECT_NEAR(ours.forces[d], by_hertz, 0.05 * by_hertz) << depths[d];
    for (const Json& row : reference()["cases"]) {
      const double by_calculix = row["force"][d];
      const std::string law = row["law"], mesh = row["mesh"];
      std::cout << fmt::format(", {} {} {:.5f}", mesh, law, by_calculix);
      // St. Venant-Kirchhoff's law is softer under pressure than the others
      if (law != "stVenantKirchhoff") {
        EXPECT_NEAR(ours.forces[d], by_calculix, 0.05 * by_calculix) << depths[d] << " " << law;
      }
    }
    std::cout << "\n";
  }
}

}  // namespace
