// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "runner/study/sweep_table.hpp"

namespace hexaplast::runner {

/// Draws elongation and, where there is any, twist over the first factor, in a small plot for every combination of the
/// others' values. `labels`: per factor, with its unit. Returns warnings, e.g. that there would be too many plots.
/// Throws OutputError.
std::vector<std::string> draw_sweep(const std::filesystem::path& file, const std::string& title,
                                    const SweepTable& table, std::span<const std::string> labels);

}  // namespace hexaplast::runner
