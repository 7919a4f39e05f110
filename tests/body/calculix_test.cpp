// SPDX-License-Identifier: LGPL-2.1-or-later
// Against CalculiX (tests/data/calculix/README.md): another code, other elements, other constitutive laws.
#include <map>
#include <tuple>

#include "hexaplast/geometry/sections.hpp"
#include "support/calculix_bar.hpp"
#include "support/core.hpp"
#include "support/large_strain.hpp"

namespace hexaplast {
namespace {

// Beams
// ---------------------------------------------------------------------------------------------------------------------

constexpr double kWidth = 0.01;  // [m] of the beams' square section

/// Twist per length in the middle of a bar of 0.1 x 0.01 x 0.01 m held at one end / Saint-Venant's, which `torque`
/// makes 1 rad/m.
double twist_rate(int cells_across, double torque) {
  const int slices = 10 * cells_across;
  const double length = 10 * kWidth;
  const Vec3 min(-kWidth / 2, -kWidth / 2, 0), max(kWidth / 2, kWidth / 2, length);
  const HexMesh mesh = regular_grid({cells_across, cells_across, slices}, min, max);
  const std::vector<int> end = nodes_at(mesh, 2, length);
  const std::vector<double> weight = face_weights(mesh, end);
  PointArray loads = PointArray::Zero(mesh.num_nodes(), 3);
  double moment = 0;
  for (const int n : end) moment += weight[n] * mesh.positions().row(n).head<2>().squaredNorm();
  for (const int n : end) {
    loads(n, 0) = -torque / moment * weight[n] * mesh.positions()(n, 1);
    loads(n, 1) = torque / moment * weight[n] * mesh.positions()(n, 0);
  }
  Body body(mesh, {Material{.poisson_ratio = 0.3}}, published_element());
  const PointArray x = elastic_equilibrium(body, nodes_at(mesh, 2, 0), loads, 1);
  const auto angle = [&](double z) { return section_angle(mesh, nodes_at(mesh, 2, z), 2, x); };
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

BarCase visco_bar(double yield_stress, double force) {
  BarCase bar{.material = calculix_material(yield_stress, 5), .force = force};
  bar.settings.rotation_plasticity = RotationPlasticity::kNone;
  return bar;
}

/// A bar of cubes of C3D8I.
Json c3d8i(const std::string& file, const std::string& key, const std::string& value) {
  return row_of(calculix(file), {{key, value}, {"element", "C3D8I"}, {"refine", 1}});
}

/// Elongations beside those of a row, but for these fractions of them.
void expect_elongations(const BarRun& run, const Json& row, double band, double band_at_rest) {
  const double peak = row["peak"]["mean_elongation"], residual = row["residual"]["mean_elongation"];
  EXPECT_EQ(run.unsolved, 0);
  EXPECT_NEAR(run.peak.mean_elongation, peak, band * peak);
  EXPECT_NEAR(run.residual.mean_elongation, residual, band_at_rest * residual);
}

// Where nothing locks, what is compared is the law.
TEST(CalculixBar, ViscoplasticStretchWithoutLockingIsThatOfC3D8I) {
  struct Case {
    double yield_stress, force;
    EndLoad load;
    Json expected;
  };
  for (const auto& [yield_stress, force, load, expected] :
       {Case{50, 0.05, EndLoad::kCentralStretch,
             c3d8i("bar_variants", "case", "stretch_viscoCalib_tau50_nu5_F0.05_C3D8")},
        Case{100, 0.1, EndLoad::kCentralStretch,
             c3d8i("bar_variants", "case", "stretch_viscoCalib_tau100_nu5_F0.1_C3D8")},
        Case{100, 0.117, EndLoad::kFaceStretch, c3d8i("bar_elements", "load", "stretchface")}}) {
    BarCase bar = visco_bar(yield_stress, force);
    bar.load = load;
    bar.dt = 0.1;  // [s] moves what is compared by .3 %
    bar.settings.bending = Bending::kAssumedCorner;
    bar.settings.volumetric = Volumetric::kVolumeRatio;
    const BarRun run = run_bar(bar);
    expect_elongations(run, expected, 0.01, 0.04);
    EXPECT_NEAR(run.residual.volume_ratio, 1, 0.005) << yield_stress << ' ' << force;
  }
}

// Isolated rest shapes: those of the default element, by the same stress as the reference where it is large.
TEST(CalculixBar, IsolatedRestShapesAreNearC3D8I) {
  const auto run = [](double yield_stress, double flow_rate, double force, EndLoad load, Schedule schedule,
                      YieldStressMeasure measure) {
    const BarRun found = run_bar({.material = calculix_material(yield_stress, flow_rate),
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
  expect_elongations(run(100, 5, 0.117, EndLoad::kFaceStretch, {}, YieldStressMeasure::kBiot),
                     c3d8i("bar_elements", "load", "stretchface"), 0.03, 0.06);
  expect_elongations(run(250, 20, 0.3, EndLoad::kFaceStretch, {.ramp = 2, .hold = 5}, YieldStressMeasure::kCauchy),
                     c3d8i("bar_variants", "case", "refineface_plast_tau250_F0.3_C3D8_r1"), 0.03, 0.03);

  const BarRun twisted = run(100, 20, 0.06, EndLoad::kFaceTwist, {.ramp = 2, .hold = 4, .release = 6, .end = 8},
                             YieldStressMeasure::kBiot);
  const Json expected = c3d8i("bar_variants", "case", "twistface_plast_tau100_f0.06_C3D8");
  for (const auto& [state, when] : {std::pair(&twisted.peak, "peak"), std::pair(&twisted.residual, "residual")})
    for (std::size_t layer = 1; layer <= 5; ++layer) {  // from the middle, which is held
      const double theirs = twist_deg(expected[when], layer);
      EXPECT_NEAR(state->twist_deg[5 + layer], theirs, 0.02 * theirs) << when << ' ' << layer;
    }
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
    const double ours = held_block(poisson_ratio, stretch, {.law = our_law}).force;
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
      const double ours = large_deflection(0.45, cells, force, {.law = law});
      const double theirs = row_of(
          reference, {{"law", name}, {"poisson_ratio", 0.45}, {"element", "C3D8I"}, {"force", force}})["deflection"];
      EXPECT_NEAR(ours, theirs, 0.005 * theirs) << name << ", cells across: " << cells;
    }
}

}  // namespace
}  // namespace hexaplast
