// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

namespace hexaplast {

/// [byte] of the machine; 0 where the system does not say.
std::uint64_t physical_memory();

/// [byte] per hexahedron that a body takes at least, whatever it is made of: elastic, in mixed precision. The smallest
/// of what is measured for each kind (material.hpp: bytes_per_hexahedron).
inline constexpr double kMinBytesPerHexahedron = 3300;

/// Throws InputError where a body of so many hexahedra, at so many bytes each, does not fit into a memory of `physical`
/// bytes: the machine would not refuse it, but swap until nothing moves. 0: unknown, everything fits.
void require_memory(double num_hexahedra, double bytes_per_hexahedron = kMinBytesPerHexahedron,
                    std::uint64_t physical = physical_memory());

}  // namespace hexaplast
