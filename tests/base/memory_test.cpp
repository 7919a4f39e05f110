// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/memory.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/material/material.hpp"
#include "support/compare.hpp"

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using support::refuses;

constexpr std::uint64_t kGB = 1'000'000'000;

// The largest grid of a scene, 256 x 256 x 256 at 2.5 kB, takes 41.9 GB.
TEST(Memory, ABodyThatDoesNotFitIsRefused) {
  EXPECT_TRUE(refuses<InputError>([] { require_memory(16'777'216, 2500, 24 * kGB); },
                                  {"16777216 hexahedra", "about 41.9 GB", "the machine or its container has 24 GB"}));
  EXPECT_TRUE(refuses<InputError>([] { require_memory(9'600'001, 2500, 24 * kGB); }, {"9600001 hexahedra"}));
  EXPECT_NO_THROW(require_memory(9'600'000, 2500, 24 * kGB));
  EXPECT_NO_THROW(require_memory(16'777'216, 2500, 48 * kGB));
  EXPECT_NO_THROW(require_memory(1e15, 2500, 0)) << "unknown";
}

// What is kept counts, and each part alone would fit.
TEST(Memory, IsGrantedAsLongAsTheSumFits) {
  GrantedMemory body = grant_memory("a body", 6e9, 10 * kGB);
  const GrantedMemory contact = grant_memory("a contact", 4e9, 10 * kGB);
  EXPECT_TRUE(refuses<InputError>(
      [] { static_cast<void>(grant_memory("another contact", 1e9, 10 * kGB)); },
      {"another contact needs about 1 GB", "the machine or its container has 10 GB, of which 10 GB are taken"}));
  EXPECT_TRUE(refuses<InputError>([] { require_memory(1000, 2500, 10 * kGB); }, {"1000 hexahedra"}));
  body.reset();
  const GrantedMemory other = grant_memory("another body", 6e9, 10 * kGB);
}

/// Of a file system with this /proc/self/cgroup and these limits.
std::uint64_t available_with(const std::string& groups,
                             const std::vector<std::pair<std::string, std::string>>& limits) {
  const fs::path root = fs::temp_directory_path() / ("memory_test_" + std::to_string(::getpid()));
  const auto write = [&](const fs::path& path, const std::string& text) {
    fs::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text << "\n";
  };
  write("proc/self/cgroup", groups);
  for (const auto& [path, limit] : limits) write("sys/fs/cgroup/" + path, limit);
  const std::uint64_t available = available_memory(root);
  fs::remove_all(root);
  return available;
}

// As Linux writes them down (cgroups(7)): a container has the least of the limits of its groups.
TEST(Memory, IsNoMoreThanAControlGroupMayTake) {
  const std::uint64_t all = physical_memory();
  EXPECT_EQ(available_with("0::/", {}), all);
  EXPECT_EQ(available_with("0::/", {{"memory.max", "max"}}), all);
  EXPECT_EQ(available_with("0::/", {{"memory.max", "1500000"}}), 1500000u);
  EXPECT_EQ(available_with("0::/jobs/a", {{"jobs/a/memory.max", "max"}, {"jobs/memory.max", "2000000"}}), 2000000u);
  EXPECT_EQ(available_with("0::/jobs/a", {{"jobs/a/memory.max", "1000000"}, {"jobs/memory.max", "2000000"}}), 1000000u);
  const std::string v1 = "5:cpu,cpuacct:/docker/7\n4:memory:/docker/7\n0::/";
  EXPECT_EQ(available_with(v1, {{"memory/docker/7/memory.limit_in_bytes", "3000000"}}), 3000000u);
  EXPECT_EQ(available_with(v1, {{"memory/memory.limit_in_bytes", "4000000"}}), 4000000u) << "its own namespace";
  EXPECT_EQ(available_with(v1, {{"memory/memory.limit_in_bytes", "9223372036854771712"}}), all) << "none";
  EXPECT_EQ(available_with(v1, {{"cpu/docker/7/memory.limit_in_bytes", "1"}}), all);
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
