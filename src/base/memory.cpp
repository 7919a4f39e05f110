// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/memory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

std::uint64_t physical_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGE_SIZE);
  return pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
}

void require_memory(double num_hexahedra, double bytes_per_hexahedron, std::uint64_t physical) {
  const double needed = num_hexahedra * bytes_per_hexahedron, available = static_cast<double>(physical);
  if (physical > 0 && needed > available)
    throw InputError(
        fmt::format("a body of {:.10g} hexahedra needs about {:.3g} GB of memory, the machine has {:.3g} GB",
                    num_hexahedra, needed / 1e9, available / 1e9));
}

}  // namespace hexaplast
