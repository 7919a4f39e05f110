// SPDX-License-Identifier: LGPL-2.1-or-later
// Against CalculiX (tests/data/calculix/README.md): another code, other elements, other constitutive laws.
#include <algorithm>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include "hexaplast/geometry/sections.hpp"
#include "support/calculix_bar.hpp"
#include "support/compare.hpp"
#include "support/golden.hpp"
#include "support/large_strain.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::calculix;
using support::Json;
using support::row_of;

// Beams
// ---------------------------------------------------------------------------------------------------------------------

constexpr double kWidth = 0.01;  // [m] of the beams' square section

/// Mean deflection of the tip / length of a clamped beam of 0.05 x 0.01 x 0.01 m.
double deflection(double poisson_ratio, int cells_across, double force, int load_steps) {
  const HexMesh mesh = support::block({5 * cells_across, cells_across, cells_across}, kWidth / cells_across);
  const std::vector<int> tip = support::nodes_at(mesh, 0, 5 * kWidth);
  const std::vector<double> weight = support::face_weights(mesh, tip);
  PointArray loads = PointArray::Zero(mesh.num_nodes(), 3);
  for (const int n : tip) loads(n, 2) = force * weight[n];
  Body body(mesh, {Material{.poisson_ratio = poisson_ratio}});
  const PointArray x = support::elastic_equilibrium(body, support::nodes_at(mesh, 0, 0), loads, load_steps);
  double sum = 0;
  for (const int n : tip) sum += x(n, 2) - mesh.positions()(n, 2);
  return sum / tip.size() / (5 * kWidth);
}

// Softer than full integration on the same mesh, stiffer than the quadratic element of the finest one.
TEST(CalculixCantilever, DeflectionLiesBetweenC3D8AndC3D20R) {
  for (const auto& [load, finest, load_steps] : {std::tuple("small", 8, 1), std::tuple("large", 4, 10)})
    for (const double poisson_ratio : {0.3, 0.45}) {
      const double band = poisson_ratio == 0.3 ? 0.05 : 0.10;
      const auto beam = [&](int cells_across, const char* element) {
        return row_of(
            calculix("cantilever"),
            {{"poisson_ratio", poisson_ratio}, {"cells_across", cells_across}, {"element", element}, {"load", load}});
      };
      const Json same = beam(4, "C3D8"), best = beam(finest, "C3D20R");
      const double ours = deflection(poisson_ratio, 4, same["force"], load_steps);
      EXPECT_GT(ours, same["deflection_over_length"]) << load;
      EXPECT_LT(ours, best["deflection_over_length"]) << load;
      EXPECT_GT(ours, (1 - band) * best["deflection_over_length"].get<double>()) << load;
    }
}

/// Twist per length in the middle of a bar of 0.1 x 0.01 x 0.01 m held at one end / Saint-Venant's, which `torque`
/// makes 1 rad/m.
double twist_rate(int cells_across, double torque) {
  const int slices = 10 * cells_across;
  const double length = 10 * kWidth;
  const Vec3 min(-kWidth / 2, -kWidth / 2, 0), max(kWidth / 2, kWidth / 2, length);
  const HexMesh mesh = regular_grid({cells_across, cells_across, slices}, min, max);
  const std::vector<int> end = support::nodes_at(mesh, 2, length);
  const std::vector<double> weight = support::face_weights(mesh, end);
  PointArray loads = PointArray::Zero(mesh.num_nodes(), 3);
  double moment = 0;
  for (const int n : end) moment += weight[n] * mesh.positions().row(n).head<2>().squaredNorm();
  for (const int n : end) {
    loads(n, 0) = -torque / moment * weight[n] * mesh.positions()(n, 1);
    loads(n, 1) = torque / moment * weight[n] * mesh.positions()(n, 0);
  }
  Body body(mesh, {Material{.poisson_ratio = 0.3}}, published_element());
  const PointArray x = support::elastic_equilibrium(body, support::nodes_at(mesh, 2, 0), loads, 1);
  const auto angle = [&](double z) { return section_angle(mesh, support::nodes_at(mesh, 2, z), 2, x); };
  return (angle(0.6 * length) - angle(0.4 * length)) / (0.2 * length);
}

// One cell across cannot warp its section: C3D8 is 16 % too stiff there, the blended element too soft. Both converge.
TEST(CalculixTorsion, ConvergesToSaintVenant) {
  const double torque = row_of(calculix("torsion"), {{"poisson_ratio", 0.3}, {"cells_across", 1}})["torque"];
  double before = 1;
  for (const int cells : {1, 2, 4}) {
    const double ours = twist_rate(cells, torque);
    EXPECT_LT(std::abs(ours - 1), before) << cells;
    before = std::abs(ours - 1);
  }
  EXPECT_LT(before, 0.05);
}

// Bars
// ----------------------------------------------------------------------------------------------------------------------

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr support::Schedule kStatic{.ramp = 1, .hold = 1, .release = 2, .end = 2};

double mean_elongation(const Json& bars, const std::string& name, const char* when) {
  return bars.at(name).at(when).at("mean_elongation");
}

// The corotated law lies between St. Venant-Kirchhoff, which softens, and Mooney-Rivlin fitted to the same constants.
TEST(CalculixBar, ElasticStretchLiesBetweenTwoLaws) {
  const Json bars = calculix("bar");
  for (const auto& [force, name, band] : {std::tuple(0.1, "F0.1", 0.02), std::tuple(0.45, "F0.45", 0.03)}) {
    const double svk = mean_elongation(bars, std::string("stretch_SVK_") + name + "_C3D8", "peak"),
                 rubber = mean_elongation(bars, std::string("stretch_MRmatched_") + name + "_C3D8", "peak");
    const support::BarRun run = support::run_bar(
        {.material = support::calculix_material(kNever, 0), .force = force, .schedule = kStatic, .dt = 0.25});
    EXPECT_EQ(run.unsolved, 0);
    EXPECT_GT(run.peak.mean_elongation, svk);
    EXPECT_LT(run.peak.mean_elongation, rubber);
    EXPECT_NEAR(run.peak.mean_elongation, (svk + rubber) / 2, band * (svk + rubber) / 2);
    EXPECT_NEAR(run.residual.mean_elongation, 0, 1e-9);
  }
}

support::BarCase visco_bar(double yield_stress, double force) {
  support::BarCase bar{.material = support::calculix_material(yield_stress, 5), .force = force};
  bar.settings.rotation_plasticity = RotationPlasticity::kNone;
  return bar;
}

// C3D8 locks: on the same mesh the nearly locking-free C3D8I elongates 55 % more for good, and refining C3D8 once makes
// it 74 % more. Ours lies in between, 19 % above C3D8: beyond the 15 % that were asked for (docs/validation.md).
TEST(CalculixBar, ViscoplasticStretchLiesBetweenC3D8AndC3D8I) {
  for (const auto& [load, name] : {std::pair(support::EndLoad::kCentralStretch, "stretch"),
                                   std::pair(support::EndLoad::kFaceStretch, "stretchface")}) {
    std::map<std::string, Json> elements;
    for (const Json& row : calculix("bar_elements"))
      if (row["load"] == name && row["refine"] == 1) elements[row["element"]] = row;
    support::BarCase bar = visco_bar(100, elements.at("C3D8")["force"]);
    bar.load = load;
    const support::BarRun run = support::run_bar(bar);
    EXPECT_EQ(run.unsolved, 0);
    for (const auto& [ours, when] :
         {std::pair(run.peak.mean_elongation, "peak"), std::pair(run.residual.mean_elongation, "residual")}) {
      EXPECT_GT(ours, elements["C3D8"][when]["mean_elongation"]) << name << " " << when;
      EXPECT_LT(ours, elements["C3D8I"][when]["mean_elongation"]) << name << " " << when;
    }
  }
}

/// A bar of cubes of C3D8I.
Json c3d8i(const std::string& file, const std::string& key, const std::string& value) {
  return row_of(calculix(file), {{key, value}, {"element", "C3D8I"}, {"refine", 1}});
}

/// Elongations beside those of a row, but for these fractions of them.
void expect_elongations(const support::BarRun& run, const Json& row, double band, double band_at_rest) {
  const double peak = row["peak"]["mean_elongation"], residual = row["residual"]["mean_elongation"];
  EXPECT_EQ(run.unsolved, 0);
  EXPECT_NEAR(run.peak.mean_elongation, peak, band * peak);
  EXPECT_NEAR(run.residual.mean_elongation, residual, band_at_rest * residual);
}

// Where nothing locks, what is compared is the law.
TEST(CalculixBar, ViscoplasticStretchWithoutLockingIsThatOfC3D8I) {
  struct Case {
    double yield_stress, force;
    support::EndLoad load;
    Json expected;
  };
  for (const auto& [yield_stress, force, load, expected] :
       {Case{50, 0.05, support::EndLoad::kCentralStretch,
             c3d8i("bar_variants", "case", "stretch_viscoCalib_tau50_nu5_F0.05_C3D8")},
        Case{100, 0.1, support::EndLoad::kCentralStretch,
             c3d8i("bar_variants", "case", "stretch_viscoCalib_tau100_nu5_F0.1_C3D8")},
        Case{100, 0.117, support::EndLoad::kFaceStretch, c3d8i("bar_elements", "load", "stretchface")}}) {
    support::BarCase bar = visco_bar(yield_stress, force);
    bar.load = load;
    bar.dt = 0.1;  // [s] moves what is compared by .3 %
    bar.settings.bending = Bending::kAssumedCorner;
    bar.settings.volumetric = Volumetric::kVolumeRatio;
    const support::BarRun run = support::run_bar(bar);
    expect_elongations(run, expected, 0.01, 0.04);
    EXPECT_NEAR(run.residual.volume_ratio, 1, 0.005) << yield_stress << ' ' << force;
  }
}

// Isolated rest shapes: those of the default element, by the same stress as the reference where it is large.
TEST(CalculixBar, IsolatedRestShapesAreNearC3D8I) {
  const auto run = [](double yield_stress, double flow_rate, double force, support::EndLoad load,
                      support::Schedule schedule, YieldStressMeasure measure) {
    const support::BarRun found = support::run_bar({.material = support::calculix_material(yield_stress, flow_rate),
                                                    .settings = {.recovery = RecoveryMode::kNone,
                                                                 .yield_stress_measure = measure,
                                                                 .rest_shape = RestShape::kIsolated},
                                                    .load = load,
                                                    .force = force,
                                                    .schedule = schedule,
                                                    .dt = 1 / (2 * flow_rate)});
    EXPECT_EQ(found.unsolved, 0);
    EXPECT_NEAR(found.residual.volume_ratio, 1, 2e-4);
    return found;
  };
  expect_elongations(run(100, 5, 0.117, support::EndLoad::kFaceStretch, {}, YieldStressMeasure::kBiot),
                     c3d8i("bar_elements", "load", "stretchface"), 0.03, 0.06);
  expect_elongations(
      run(250, 20, 0.3, support::EndLoad::kFaceStretch, {.ramp = 2, .hold = 5}, YieldStressMeasure::kCauchy),
      c3d8i("bar_variants", "case", "refineface_plast_tau250_F0.3_C3D8_r1"), 0.03, 0.03);

  const support::BarRun twisted = run(100, 20, 0.06, support::EndLoad::kFaceTwist,
                                      {.ramp = 2, .hold = 4, .release = 6, .end = 8}, YieldStressMeasure::kBiot);
  const Json expected = c3d8i("bar_variants", "case", "twistface_plast_tau100_f0.06_C3D8");
  for (const auto& [state, when] : {std::pair(&twisted.peak, "peak"), std::pair(&twisted.residual, "residual")})
    for (std::size_t layer = 1; layer <= 5; ++layer) {  // from the middle, which is held
      const double theirs = support::twist_deg(expected[when], layer);
      EXPECT_NEAR(state->twist_deg[5 + layer], theirs, 0.02 * theirs) << when << ' ' << layer;
    }
}

// Under load the layers are 4 to 8.5 % short, where 8 % were asked for, after release 11 to 17 % (docs/validation.md).
TEST(CalculixBar, FaceTwistUnderLoad) {
  const Json peak = calculix("bar").at("twistface_plast_tau100_f0.06_C3D8").at("peak");
  support::BarCase bar{.material = support::calculix_material(100, 20), .load = support::EndLoad::kFaceTwist};
  bar.force = 0.06;
  bar.schedule = {.ramp = 2, .hold = 4, .release = 6, .end = 8};
  bar.settings.rotation_plasticity = RotationPlasticity::kNone;
  const support::BarRun run = support::run_bar(bar);
  EXPECT_EQ(run.unsolved, 0);
  for (std::size_t layer = 0; layer < 11; ++layer) {
    const double theirs = support::twist_deg(peak, layer);
    EXPECT_NEAR(run.peak.twist_deg[layer], theirs, 0.09 * std::abs(theirs) + 1e-9) << "layer " << layer;
  }
  EXPECT_NEAR(run.residual.volume_ratio, 1, 0.005);
}

// On the same mesh ours is closer to the refined, nearly locking-free C3D8I than C3D8 is.
TEST(CalculixBar, FaceStretchIsCloserToTheRefinedAnswer) {
  const Json bars = calculix("bar");
  const std::string name = "refineface_plast_tau250_F0.3_";
  support::BarCase bar{.material = support::calculix_material(250, 20), .load = support::EndLoad::kFaceStretch};
  bar.force = 0.3;
  bar.schedule = {.ramp = 2, .hold = 5, .release = 6, .end = 8};
  bar.settings.rotation_plasticity = RotationPlasticity::kNone;
  const support::BarRun run = support::run_bar(bar);
  EXPECT_EQ(run.unsolved, 0);
  for (const auto& [ours, when] :
       {std::pair(run.peak.mean_elongation, "peak"), std::pair(run.residual.mean_elongation, "residual")}) {
    const double best = mean_elongation(bars, name + "C3D8I_r2", when);
    EXPECT_LT(std::abs(ours - best), std::abs(mean_elongation(bars, name + "C3D8_r1", when) - best)) << when;
  }
  EXPECT_NEAR(run.residual.volume_ratio, 1, 0.005);
}

// Large strain
// ----------------------------------------------------------------------------------------------------------------------

struct HeldBlock {
  ElasticLaw ours;
  double poisson_ratio, stretch;
  const char* law;  // of CalculiX
  double band;      // about C3D8I: the laws differ in how they resist a change of volume
};

TEST(CalculixRubber, BlockHeldAtBothEndsIsNearC3D8I) {
  const Json reference = calculix("hyperelastic")["block"];
  for (const auto& [our_law, poisson_ratio, stretch, law, band] :
       {HeldBlock{ElasticLaw::kCorotated, 0.49, 1.5, "neoHooke", 0.2},
        HeldBlock{ElasticLaw::kNeoHookean, 0.49, 1.5, "neoHooke", 0.06},
        HeldBlock{ElasticLaw::kNeoHookean, 0.45, 0.6, "neoHooke", 0.09},
        HeldBlock{ElasticLaw::kMooneyRivlin, 0.45, 0.6, "mooneyRivlin", 0.04}}) {
    const double ours = support::held_block(poisson_ratio, stretch, {.law = our_law}).force;
    const double theirs =
        row_of(reference,
               {{"law", law}, {"poisson_ratio", poisson_ratio}, {"element", "C3D8I"}, {"stretch", stretch}})["force"];
    EXPECT_NEAR(ours, theirs, band * std::abs(theirs)) << law << ' ' << poisson_ratio << ' ' << stretch;
  }
}

// The blended element bends 8 % less here.
TEST(CalculixRubber, CantileverBentFarIsThatOfC3D8I) {
  const Json reference = calculix("hyperelastic")["cantilever"];
  for (const auto& [law, name] :
       {std::pair(ElasticLaw::kCorotated, "stVenantKirchhoff"), std::pair(ElasticLaw::kNeoHookean, "neoHooke")})
    for (const auto& [cells, force] : {std::pair(2, 0.0875), std::pair(1, 0.35)}) {
      const double ours = support::large_deflection(0.45, cells, force, {.law = law});
      const double theirs = row_of(
          reference, {{"law", name}, {"poisson_ratio", 0.45}, {"element", "C3D8I"}, {"force", force}})["deflection"];
      EXPECT_NEAR(ours, theirs, 0.005 * theirs) << name << ", cells across: " << cells;
    }
}

// A single cube in uniaxial stress: the equation integrated along its axis alone, at 32 moments.
TEST(CalculixHexahedron, FollowsTheEquationInUniaxialStress) {
  for (const Json& row : calculix("uniaxial")) {
    const Eigen::VectorXd times = support::vector(row["times"]), expected = support::vector(row["stretch_equation"]);
    const std::vector<double> ours =
        support::uniaxial_stretch(support::calculix_material(row["yield_stress"], row["flow_rate"]),
                                  row["nominal_stress"], {times.data(), times.data() + times.size()});
    const double peak = expected.maxCoeff() - 1;
    for (Eigen::Index i = 0; i < times.size(); ++i)
      EXPECT_NEAR(ours[i], expected[i], 0.01 * peak) << "yield stress " << row["yield_stress"] << ", t = " << times[i];
  }
}

}  // namespace
}  // namespace hexaplast
