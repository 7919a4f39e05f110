// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/cantilever.hpp"

#include <algorithm>
#include <ostream>

#include "support/compare.hpp"
#include "support/golden.hpp"

namespace hexaplast {
namespace {

using support::beam_mesh;
using support::BeamMesh;
using support::Json;
using support::relative_deflection;

Settings element(Bending bending, Volumetric volumetric = Volumetric::kSample) {
  Settings settings;
  settings.bending = bending;
  settings.volumetric = volumetric;
  return settings;
}
const Settings kPublished = element(Bending::kBlended);

// Between full integration (.666 and .514) and the exact answer: what blending gives to bending. Some locking stays at
// .45.
TEST(Cantilever, HasTheStiffnessOfTheBlendedElement) {
  EXPECT_NEAR(relative_deflection(1, 0, kPublished), 0.886, 0.005 * 0.886);
  EXPECT_NEAR(relative_deflection(1, 0.3, kPublished), 0.849, 0.005 * 0.849);
  EXPECT_NEAR(relative_deflection(1, 0.45, kPublished), 0.647, 0.005 * 0.647);
}

TEST(Cantilever, OfCornerGradientsIsFarTooStiff) {
  EXPECT_NEAR(relative_deflection(1, 0, element(Bending::kVertex)), 0.225, 0.005 * 0.225);
  EXPECT_NEAR(relative_deflection(1, 0.45, element(Bending::kVertex)), 0.167, 0.005 * 0.167);
}

// Towards incompressibility trilinear hexahedra stiffen. Blending takes part of it away: the answer lies between the
// fully integrated element and the one with incompatible modes, as CalculiX has them on the same mesh.
TEST(Cantilever, LocksLessThanFullIntegration) {
  const support::Json reference = support::calculix("locking");
  const auto& poisson_ratios = reference["poisson_ratio"];
  ASSERT_EQ(poisson_ratios.size(), 5u);
  for (std::size_t k = 0; k < poisson_ratios.size(); ++k) {
    const double deflection = relative_deflection(2, poisson_ratios[k], kPublished);
    EXPECT_GT(deflection, reference["C3D8"][k].get<double>()) << poisson_ratios[k];
    EXPECT_LT(deflection, reference["C3D8I"][k].get<double>()) << poisson_ratios[k];
  }
}

TEST(Cantilever, ConvergesWithRefinement) {
  EXPECT_NEAR(relative_deflection(2, 0, kPublished), 0.968, 0.005 * 0.968);
  EXPECT_NEAR(relative_deflection(2, 0.45, kPublished), 0.837, 0.005 * 0.837);
}

// ---- forms of the element on all meshes, against those of an independent prototype

using Deflections = std::array<double, 5>;  // at Poisson's ratio 0, .3, .45, .49, .499

struct Beam {
  const char* mesh;
  Deflections published, corner;
};

constexpr Beam kBeams[] = {
    {"cubes", {.968, .949, .837, .675, .441}, {.998, .986, .964, .954, .951}},
    {"one cell thick", {.886, .848, .647, .457, .205}, {.997, .979, .957, .950, .948}},
    {"twice as long", {.760, .780, .687, .519, .266}, {.997, .974, .934, .916, .911}},
    {"five times as long", {.303, .352, .325, .228, .091}, {.983, .934, .841, .797, .786}},
    {"slanted by 27 degrees", {.846, .812, .638, .388, .131}, {.988, .981, .965, .958, .956}},
    {"slanted by 45 degrees", {.618, .566, .378, .199, .077}, {.984, .975, .957, .948, .946}},
    {"trapezoids", {.781, .790, .711, .596, .494}, {.840, .847, .829, .818, .815}},
};

class EveryBeam : public testing::TestWithParam<Beam> {};
INSTANTIATE_TEST_SUITE_P(Cantilever, EveryBeam, testing::ValuesIn(kBeams), [](const auto& test) {
  std::string name = test.param.mesh;
  std::ranges::replace(name, ' ', '_');
  return name;
});
void PrintTo(const Beam& beam, std::ostream* out) { *out << beam.mesh; }

const Json kPoissonRatios = {0.0, 0.3, 0.45, 0.49, 0.499};

void expect_deflections(const BeamMesh& beam, const Settings& settings, const Deflections& expected) {
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const double found = relative_deflection(beam.mesh, beam.weights, kPoissonRatios[k], settings);
    EXPECT_NEAR(found, expected[k], 0.005 * expected[k]) << kPoissonRatios[k];
  }
}

TEST_P(EveryBeam, OfThePublishedElement) {
  expect_deflections(beam_mesh(GetParam().mesh), kPublished, GetParam().published);
}
TEST_P(EveryBeam, OfAssumedStrains) {
  expect_deflections(beam_mesh(GetParam().mesh), element(Bending::kAssumedCorner, Volumetric::kVolumeRatio),
                     GetParam().corner);
}

// Where nodes lie anyhow: beside CalculiX's elements on the same mesh.
TEST(Cantilever, OfUnevenMeshesLocksLessThanThatWithIncompatibleModes) {
  for (const char* name : {"moved by 0.15", "moved by 0.3"}) {
    const BeamMesh beam = beam_mesh(name);
    for (std::size_t k = 0; k < kPoissonRatios.size(); ++k) {
      const double corner = relative_deflection(beam.mesh, beam.weights, kPoissonRatios[k],
                                                element(Bending::kAssumedCorner, Volumetric::kVolumeRatio));
      EXPECT_GT(corner, beam.reference["C3D8"][k].get<double>()) << name << ' ' << kPoissonRatios[k];
      EXPECT_LT(corner, beam.reference["C3D20R"][k].get<double>()) << name << ' ' << kPoissonRatios[k];
      if (k == 4) {
        EXPECT_GT(corner, beam.reference["C3D8I"][k].get<double>()) << name;
      }
    }
  }
}

}  // namespace
}  // namespace hexaplast
