// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

namespace hexaplast {

/// [byte] of the machine; 0 where the system does not say.
std::uint64_t physical_memory();

/// [byte] that this process may take: of the machine, or less where it is in a container or another control group
/// (cgroup v1 or v2) with a limit. 0 where the system does not say. root: of the file system.
std::uint64_t available_memory(const std::filesystem::path& root = "/");

/// [byte] per hexahedron that a body takes at least, whatever it is made of: elastic, in mixed precision. The smallest
/// of what is measured for each kind (material.hpp: bytes_per_hexahedron).
inline constexpr double kMinBytesPerHexahedron = 3000;

/// Throws InputError where a body of so many hexahedra, at so many bytes each, does not fit into a memory of
/// `available` bytes beside what is granted already: the machine would not refuse it, but swap until nothing moves, and
/// a container would be killed. 0: unknown, everything fits.
void require_memory(double num_hexahedra, double bytes_per_hexahedron = kMinBytesPerHexahedron,
                    std::uint64_t available = available_memory());

/// Memory that counts as taken in this process while it is kept.
using GrantedMemory = std::shared_ptr<const void>;

/// The same of anything, which is granted that memory. what: begins the message, "... needs about". By any thread.
[[nodiscard]] GrantedMemory grant_memory(std::string_view what, double bytes,
                                         std::uint64_t available = available_memory());

}  // namespace hexaplast
