// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/memory.hpp"

#include <fstream>

#include "hexaplast/base/error.hpp"
#include "support/compare.hpp"

namespace hexaplast {
namespace {

using support::refuses;

constexpr std::uint64_t kGB = 1'000'000'000;

// The largest grid of a scene, 256 x 256 x 256 at 2.5 kB, takes 41.9 GB.
TEST(Memory, ABodyThatDoesNotFitIsRefused) {
  EXPECT_TRUE(refuses<InputError>([] { require_memory(16'777'216, 24 * kGB); },
                                  {"16777216 hexahedra", "about 41.9 GB", "the machine has 24 GB"}));
  EXPECT_TRUE(refuses<InputError>([] { require_memory(9'600'001, 24 * kGB); }, {"9600001 hexahedra"}));
  EXPECT_NO_THROW(require_memory(9'600'000, 24 * kGB));
  EXPECT_NO_THROW(require_memory(16'777'216, 48 * kGB));
  EXPECT_NO_THROW(require_memory(1e15, 0)) << "unknown";
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
