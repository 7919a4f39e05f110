// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace hexaplast::runner {

/// Gathers the runs of one sweep from the directories of its shards into `out`, which then holds what one process that
/// had carried out all of them would have left: the same table, picture and data sets. `out` may hold what was gathered
/// before; shards may still be at work. Data sets and messages of runs are links to the same files, or copies on
/// another file system. Returns the exit code of the sweep, or 5 where runs are missing. Throws OutputError where the
/// directories are not of one sweep, or have different results of a run.
int merge_sweep(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& out, bool force);

}  // namespace hexaplast::runner
