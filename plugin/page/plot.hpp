// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>

namespace hexaplast::output {

/// Draws how a run went over time, from its history.csv, as one SVG picture: the first four charts that show something,
/// of elongation, twist, volume error, yielded hexahedra, energy and what comes behind. Throws OutputError.
void write_plot(const std::filesystem::path& file, const std::filesystem::path& history, const std::string& title,
                int num_elements);

}  // namespace hexaplast::output
