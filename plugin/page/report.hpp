// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "record/manifest.hpp"

namespace hexaplast::output {

inline constexpr std::string_view kReportName = "report.html";

/// Writes report.html into the directory of a run: one file that needs nothing else, with what the manifest says, the
/// curves of history.csv, what removed.csv lists, and at most eight of the pictures in frames. Throws OutputError.
void write_report(const std::filesystem::path& directory, const Manifest& run);

}  // namespace hexaplast::output
