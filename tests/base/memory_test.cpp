// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/memory.hpp"

#include <fstream>

#include "hexaplast/base/error.hpp"
#include "hexaplast/material/material.hpp"
#include "support/compare.hpp"

namespace hexaplast {
namespace {

using support::refuses;

constexpr std::uint64_t kGB = 1'000'000'000;

// The largest grid of a scene, 256 x 256 x 256 at 2.5 kB, takes 41.9 GB.
TEST(Memory, ABodyThatDoesNotFitIsRefused) {
  EXPECT_TRUE(refuses<InputError>([] { require_memory(16'777'216, 2500, 24 * kGB); },
                                  {"16777216 hexahedra", "about 41.9 GB", "the machine has 24 GB"}));
  EXPECT_TRUE(refuses<InputError>([] { require_memory(9'600'001, 2500, 24 * kGB); }, {"9600001 hexahedra"}));
  EXPECT_NO_THROW(require_memory(9'600'000, 2500, 24 * kGB));
  EXPECT_NO_THROW(require_memory(16'777'216, 2500, 48 * kGB));
  EXPECT_NO_THROW(require_memory(1e15, 2500, 0)) << "unknown";
}

// BodyMemory.IsWhatTheGuardCounts measures it.
TEST(Memory, OfABodyDependsOnWhatItIsMadeOf) {
  const Material elastic, yields{.yield_stress = 300, .flow_rate = 2}, turns{.rotation_flow_rate = 1};
  const Settings in_double = published_element();
  Settings mixed = in_double, stretches_alone = in_double;
  mixed.precision = Precision::kMixed;
  stretches_alone.rotation_plasticity = RotationPlasticity::kNone;
  for (const Settings& settings : {in_double, mixed}) {
    const double still = bytes_per_hexahedron({elastic}, settings);
    EXPECT_GT(bytes_per_hexahedron({yields}, settings), still);
    EXPECT_EQ(bytes_per_hexahedron({elastic, turns}, settings), bytes_per_hexahedron({yields}, settings));
  }
  EXPECT_EQ(bytes_per_hexahedron({turns}, stretches_alone), bytes_per_hexahedron({elastic}, in_double));
  EXPECT_LT(bytes_per_hexahedron({yields}, mixed), bytes_per_hexahedron({yields}, in_double));
  Settings centre = mixed;  // cycles of multigrid take its own stiffness, not a simpler one beside it
  centre.bending = Bending::kCentre;
  EXPECT_EQ(bytes_per_hexahedron({elastic}, centre), kMinBytesPerHexahedron);
  EXPECT_GT(bytes_per_hexahedron({elastic}, mixed), kMinBytesPerHexahedron);
}

// Eight tensors of 72 bytes for each stretch that is tracked, seven more where each corner turns by itself; in the
// history, and in the one that a step tries.
TEST(Memory, OfABodyCountsWhatNotEveryHistoryHas) {
  const Material elastic, yields{.yield_stress = 300, .flow_rate = 2};
  Material tears = yields, breaks = elastic;
  tears.fracture_stretch = breaks.fracture_stretch = 2;
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const Settings plain{.precision = precision},
        corners{.rotation_plasticity = RotationPlasticity::kVertex, .precision = precision},
        centre{.rotation_plasticity = RotationPlasticity::kCentre, .precision = precision};
    const double still = bytes_per_hexahedron({elastic}, plain), flows = bytes_per_hexahedron({yields}, plain);
    EXPECT_EQ(bytes_per_hexahedron({breaks}, plain), still + 8 * 72);
    EXPECT_EQ(bytes_per_hexahedron({elastic}, corners), still + 7 * 72);
    EXPECT_EQ(bytes_per_hexahedron({yields, tears}, plain), flows + 2 * 8 * 72);
    EXPECT_EQ(bytes_per_hexahedron({yields}, centre), flows + 2 * 7 * 72);
    EXPECT_EQ(bytes_per_hexahedron({tears}, corners), flows + 2 * 15 * 72);
  }
}

TEST(Memory, IsWhatTheSystemSays) {
  std::ifstream in("/proc/meminfo");
  std::string label;
  double kilobytes = 0;
  in >> label >> kilobytes;
  ASSERT_EQ(label, "MemTotal:");
  EXPECT_NEAR(static_cast<double>(physical_memory()), 1024 * kilobytes, 0.05 * 1024 * kilobytes);
}

}  // namespace
}  // namespace hexaplast
