// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast::output {

// The runner exits with 5 on an OutputError.
using hexaplast::OutputError;
using hexaplast::WholeFile;

/// Throws OutputError with the reason where a file cannot be read.
void require_readable(const std::filesystem::path& file);

/// Creates `directory`, or checks that it can be written. Throws OutputError when the place is a file or cannot be
/// written.
void make_directory(const std::filesystem::path& directory);

/// Makes `directory` ready for a new run: creates it, or checks that it can be written and holds no earlier run; with
/// `force` the files of an earlier run (history.csv, removed.csv, opened.csv, frames/frame_N.png,
/// manifest.json, report.html, checkpoint_N.hxc; mesh.pvd and mesh_N.vtu, and the same of surface and instruments) are
/// removed, others stay. Throws OutputError, before anything is changed, when the place is a file, cannot be written,
/// holds an earlier run and `force` is not set, or holds one of which a file is among `inputs`.
void prepare_directory(const std::filesystem::path& directory, bool force, const InputFiles& inputs = {});

/// Makes the directory of a run ready to go on after `step`: removes what was left unfinished, and what only the end of
/// a run or later steps have written (pictures, states and checkpoints of later steps, as far as `is_kept`
/// does not want them). Throws OutputError, before anything is changed, when it cannot be written, or a file of the run
/// is among `inputs`.
void prepare_to_go_on(const std::filesystem::path& directory, long step, const InputFiles& inputs,
                      const std::function<bool(const std::string& name)>& is_kept);

/// Adds the files of a run in its directory, those of its pictures not among them.
void add_files_of_run(const std::filesystem::path& directory, InputFiles& files);

/// 125 of "mesh_000125.vtu".
std::optional<long> number_at_end(const std::filesystem::path& file);

/// Whether a run writes a file of that name into its directory, or a file of that name with .part behind it.
bool is_of_run(std::string_view name);

}  // namespace hexaplast::output
