// SPDX-License-Identifier: LGPL-2.1-or-later
// Clamped beams under a force at their end, beside an independent prototype and CalculiX.
#include "support/cantilever.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <ostream>

namespace hexaplast {
namespace {

using support::beam_mesh;
using support::BeamMesh;

const Settings kPublished = published_element(), kDefault,
               kVertex{.bending = Bending::kVertex, .volumetric = Volumetric::kSample};

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

constexpr Deflections kPoissonRatios = {0.0, 0.3, 0.45, 0.49, 0.499};

double deflection(const BeamMesh& beam, std::size_t k, const Settings& settings) {
  return support::relative_deflection(beam.mesh, beam.weights, kPoissonRatios[k], settings);
}

TEST_P(EveryBeam, BendsAsTheElementsOfThePrototype) {
  const BeamMesh beam = beam_mesh(GetParam().mesh);
  for (std::size_t k = 0; k < kPoissonRatios.size(); ++k) {
    EXPECT_NEAR(deflection(beam, k, kPublished), GetParam().published[k], 0.005 * GetParam().published[k])
        << kPoissonRatios[k];
    EXPECT_NEAR(deflection(beam, k, kDefault), GetParam().corner[k], 0.005 * GetParam().corner[k]) << kPoissonRatios[k];
  }
}

TEST(Cantilever, OfCornerGradientsIsFarTooStiff) {
  const BeamMesh beam = beam_mesh("one cell thick");
  EXPECT_NEAR(deflection(beam, 0, kVertex), 0.225, 0.005 * 0.225);
  EXPECT_NEAR(deflection(beam, 2, kVertex), 0.167, 0.005 * 0.167);
}

// Towards incompressibility trilinear hexahedra stiffen. Blending takes part of it away: the answer lies between the
// fully integrated element and the one with incompatible modes, as CalculiX has them on the same mesh. The default
// element locks less than the latter, where nodes lie anyhow.
TEST(Cantilever, LocksLessThanTheElementsOfCalculix) {
  const auto expect_between = [](const char* name, const Settings& settings, const char* below, const char* above,
                                 std::size_t first) {
    const BeamMesh beam = beam_mesh(name);
    for (std::size_t k = first; k < kPoissonRatios.size(); ++k) {
      const double found = deflection(beam, k, settings);
      EXPECT_GT(found, beam.reference[below][k].get<double>()) << name << ' ' << kPoissonRatios[k];
      EXPECT_LT(found, beam.reference[above][k].get<double>()) << name << ' ' << kPoissonRatios[k];
    }
  };
  expect_between("cubes", kPublished, "C3D8", "C3D8I", 0);
  for (const char* name : {"moved by 0.15", "moved by 0.3"}) {
    expect_between(name, kDefault, "C3D8", "C3D20R", 0);
    expect_between(name, kDefault, "C3D8I", "C3D20R", 4);
  }
}

}  // namespace
}  // namespace hexaplast
