// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

namespace hexaplast {

/// [byte] of the machine; 0 where the system does not say.
std::uint64_t physical_memory();

/// Throws InputError where a body of so many hexahedra, at 2.5 kB each (docs/reliability.md), does not fit into a
/// memory of `physical` bytes: the machine would not refuse it, but swap until nothing moves. 0: unknown, everything
/// fits.
void require_memory(double num_hexahedra, std::uint64_t physical = physical_memory());

}  // namespace hexaplast
