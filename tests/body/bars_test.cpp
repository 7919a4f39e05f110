// SPDX-License-Identifier: LGPL-2.1-or-later
// The six bars from the initial to the settled state: permanent elongation and twist within 2 % of the reference
// values, volume kept, halves alike.
#include "hexaplast/geometry/sections.hpp"
#include "support/bar.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

struct Preset {
  const char* name;
  BarLoad load;
  const char* strength;
  const char* golden_file;
  const char* golden_key;
  double expected;  ///< permanent elongation [-] or twist [degrees] after 5 s
};

void PrintTo(const Preset& bar, std::ostream* out) { *out << bar.name; }

class Bar : public testing::TestWithParam<Preset> {
 protected:
  MovingBody simulation = support::bar(GetParam().load, GetParam().strength);
  const HexMesh& mesh = simulation.body.mesh();
  const EndSections ends = end_sections(mesh);

  const PointArray& plastic_rest() const { return simulation.body.state().history.plastic_rest_positions; }
  bool is_stretched() const { return GetParam().load == BarLoad::kStretch; }

  /// Permanent elongation [-] or twist [degrees] of the whole bar.
  double permanent() const {
    return is_stretched() ? elongation(ends, plastic_rest()) : twist(mesh, ends, plastic_rest()) * kDegrees;
  }

  double volume_error() const { return simulation.body.volume(plastic_rest()) / simulation.body.initial_volume() - 1; }

  /// Mean elongation of the central faces of the two ends: where the load acts.
  double face_elongation(const PointArray& at) const {
    double sum = 0;
    for (const int i : {5, 6, 9, 10}) sum += (at(160 + i, 2) - at(i, 2)) / 4;
    return sum / ends.length - 1;
  }
};

TEST_P(Bar, FollowsTheReferenceAndKeepsItsShapeAfterwards) {
  const Json rows = golden(GetParam().golden_file)[GetParam().golden_key]["rows"];
  ASSERT_EQ(rows.size(), 20u);
  const auto peak = [&](const char* key) {
    double max = 0;
    for (const Json& row : rows) max = std::max(max, std::abs(row[key].get<double>()));
    return max;
  };

  for (const Json& row : rows) {
    for (int k = 0; k < kBarSteps / 20; ++k) {
      const FlowReport report = simulation.step();
      ASSERT_EQ(report.skipped, 0);
      ASSERT_LT(std::abs(volume_error()), 0.01) << "at " << simulation.time() << " s";
    }
    ASSERT_NEAR(simulation.time(), row["t"].get<double>(), 1e-9);
    const auto expect = [&](const char* key, double actual, double tolerance) {
      EXPECT_NEAR(actual, row[key].get<double>(), tolerance * peak(key)) << key << " at " << simulation.time() << " s";
    };
    expect("elong_mat", elongation(ends, plastic_rest()), 0.01);
    expect("elong_world", elongation(ends, simulation.positions), 0.02);
    expect("elong_face", face_elongation(simulation.positions), 0.02);
    if (is_stretched()) continue;
    expect("twist_mat", twist(mesh, ends, plastic_rest()) * kDegrees, 0.01);
    expect("twist_world", twist(mesh, ends, simulation.positions) * kDegrees, 0.02);
  }

  EXPECT_NEAR(permanent(), GetParam().expected, 0.02 * GetParam().expected);
  EXPECT_LT(std::abs(volume_error()), 0.001);

  // the load is the same on both sides of the clamp, so the shape is too
  for (int slice = 0; slice <= 5; ++slice) {
    const std::vector<int> lower = nodes_at(mesh, 2, slice * 0.1), upper = nodes_at(mesh, 2, (10 - slice) * 0.1);
    const double below = section_angle(mesh, lower, 2, plastic_rest()),
                 above = section_angle(mesh, upper, 2, plastic_rest());
    EXPECT_NEAR(above + below, 0, 1e-6 / kDegrees) << "slice " << slice;
    double length_below = 0, length_above = 0;
    for (const int n : lower) length_below += (0.5 - plastic_rest()(n, 2)) / lower.size();
    for (const int n : upper) length_above += (plastic_rest()(n, 2) - 0.5) / upper.size();
    EXPECT_NEAR(length_above, length_below, 1e-9) << "slice " << slice;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Presets, Bar,
    testing::Values(Preset{"StretchHigh", BarLoad::kStretch, "high", "bar_stretch", "high", 0.6795},
                    Preset{"StretchMedium", BarLoad::kStretch, "medium", "bar_stretch", "medium", 0.2301},
                    Preset{"StretchLow", BarLoad::kStretch, "low", "bar_stretch", "low", 0.0307},
                    Preset{"TwistHigh", BarLoad::kTwist, "high", "bar_twist_objective", "objective-high", 110.5},
                    Preset{"TwistMedium", BarLoad::kTwist, "medium", "bar_twist_objective", "objective-medium", 29.2},
                    Preset{"TwistLow", BarLoad::kTwist, "low", "bar_twist_objective", "objective-low", 4.5}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace hexaplast
