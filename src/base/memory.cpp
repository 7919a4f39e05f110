// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/memory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <limits>
#include <string>

#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

/// What the file says; unlimited where there is none, or another word ("max").
std::uint64_t limit_in(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t limit = 0;
  return in >> limit ? limit : kUnlimited;
}

/// The least of the limits of a group and of those that it is in.
std::uint64_t limit_of(const fs::path& mount, const fs::path& group, const char* file) {
  std::uint64_t limit = limit_in(mount / file);  // in a container that does not see the groups above, the only one
  for (fs::path at = group.relative_path(); !at.empty(); at = at.parent_path())
    limit = std::min(limit, limit_in(mount / at / file));
  return limit;
}

/// By /proc/self/cgroup: lines of number:controllers:group.
std::uint64_t limit_of_groups(const fs::path& root) {
  std::uint64_t limit = kUnlimited;
  std::ifstream in(root / "proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
    const fs::path group = line.substr(second + 1), mount = root / "sys/fs/cgroup";
    if (controllers == ",,") limit = std::min(limit, limit_of(mount, group, "memory.max"));
    if (controllers.find(",memory,") != std::string::npos)
      limit = std::min(limit, limit_of(mount / "memory", group, "memory.limit_in_bytes"));
  }
  return limit;
}

}  // namespace

std::uint64_t physical_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGE_SIZE);
  return pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
}

std::uint64_t available_memory(const fs::path& root) {
  const std::uint64_t physical = physical_memory(), limit = limit_of_groups(root);
  return physical == 0 && limit == kUnlimited ? 0 : std::min(physical > 0 ? physical : kUnlimited, limit);
}

GrantedMemory grant_memory(std::string_view what, double bytes, std::uint64_t available) {
  static std::atomic<double> granted = 0;  // [byte] of all that is kept: each part alone would fit
  const double others = granted.fetch_add(bytes);
  GrantedMemory grant(&granted, [bytes](const void*) { granted.fetch_sub(bytes); });
  if (available > 0 && others + bytes > static_cast<double>(available))
    throw InputError(fmt::format("{} needs about {:.3g} GB of memory, the machine or its container has {:.3g} GB{}",
                                 what, bytes / 1e9, static_cast<double>(available) / 1e9,
                                 others > 0 ? fmt::format(", of which {:.3g} GB are taken", others / 1e9) : ""));
  return grant;
}

void require_memory(double num_hexahedra, double bytes_per_hexahedron, std::uint64_t available) {
  static_cast<void>(grant_memory(fmt::format("a body of {:.10g} hexahedra", num_hexahedra),
                                 num_hexahedra * bytes_per_hexahedron, available));
}

}  // namespace hexaplast
