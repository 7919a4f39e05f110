// SPDX-License-Identifier: LGPL-2.1-or-later
// Clamped beams under a force at their end, beside CalculiX.
#include "support/cantilever.hpp"

#include <gtest/gtest.h>

namespace hexaplast {
namespace {

// Towards incompressibility trilinear hexahedra stiffen. Blending takes part of it away: the answer lies between the
// fully integrated element and the one with incompatible modes, as CalculiX has them on the same mesh. The default
// element locks less than the latter, where nodes lie anyhow.
TEST(Cantilever, LocksLessThanTheElementsOfCalculix) {
  const auto expect_between = [](const char* name, const Settings& settings, const char* below, const char* above,
                                 std::size_t first) {
    constexpr double kPoissonRatios[] = {0.0, 0.3, 0.45, 0.49, 0.499};
    const support::BeamMesh beam = support::beam_mesh(name);
    for (std::size_t k = first; k < std::size(kPoissonRatios); ++k) {
      const double found = support::relative_deflection(beam.mesh, beam.weights, kPoissonRatios[k], settings);
      EXPECT_GT(found, beam.reference[below][k].get<double>()) << name << ' ' << kPoissonRatios[k];
      EXPECT_LT(found, beam.reference[above][k].get<double>()) << name << ' ' << kPoissonRatios[k];
    }
  };
  expect_between("cubes", published_element(), "C3D8", "C3D8I", 0);
  for (const char* name : {"moved by 0.15", "moved by 0.3"}) {
    expect_between(name, {}, "C3D8", "C3D20R", 0);
    expect_between(name, {}, "C3D8I", "C3D20R", 4);
  }
}

}  // namespace
}  // namespace hexaplast
