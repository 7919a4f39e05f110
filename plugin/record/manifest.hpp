// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "picture/camera.hpp"

namespace hexaplast::output {

/// An attribute of a component as it was in a run.
struct AttributeRecord {
  std::string name;
  std::string value;  ///< as a scene would write it, a link as "@path"; long lists are described, not written
  std::string unit = {};
  std::string help = {};
};

/// A node or component of a scene, with the attributes whose values are not the default ones.
struct ComponentRecord {
  std::string path;  ///< "/bar/material"
  std::string class_name;
  std::string help = {};
  std::vector<AttributeRecord> attributes = {};
};

/// A column of history.csv that the scene asks for.
struct ProbeRecord {
  std::string name, unit;
};

/// A line of the summary: "plastic twist", "+1.2 deg".
struct Figure {
  std::string label, value;
};

/// How far a run has come.
enum class RunState { kRunning, kFinished, kInterrupted, kFailed };
std::string_view describe(RunState state);  ///< "running", "finished", "interrupted", "failed"

/// What must be known of a run to judge it and to repeat it.
struct Manifest {
  std::string version = {};               ///< of the program
  std::vector<std::string> command = {};  ///< words of the command line
  std::string working_directory = {};     ///< where it was given
  std::string title = {};                 ///< the scene's name
  std::string heading = {};               ///< what the scene says of itself, in a line; may be empty
  std::string description = {};           ///< and in a paragraph

  /// What stands over its pictures.
  const std::string& caption() const { return heading.empty() ? title : heading; }

  std::string scene_file = {};
  std::string scene_hash = {};  ///< XXH64 of the scene as carried out: includes and overrides are in it
  std::vector<std::string> overrides = {};
  std::vector<ComponentRecord> components = {};
  std::vector<ProbeRecord> probes = {};
  std::optional<PictureRecord> pictures = {};  ///< none: written by an earlier version

  int threads = 1;
  std::string simd = {};           ///< instruction set of the kernels
  std::string precision = {};      ///< of the body's products; empty: there is no body
  std::string motion_solver = {};  ///< class of the solver of motion
  std::string linear_solver = {};  ///< class of its linear solver; empty: there is none
  std::string processor = {};
  int cores = 1;                   ///< that the machine offers, counting hardware threads
  std::uint64_t memory_bytes = 0;  ///< of the machine

  std::string started = {};  ///< UTC, as in 2026-01-31T12:00:00Z
  double dt = 0;             ///< [s]
  long steps_asked = 0;

  RunState state = RunState::kRunning;
  std::string exit_reason = {};  ///< a sentence; empty while it runs
  double duration = 0;           ///< [s] wall time
  long steps_done = 0;
  std::string state_hash = {};             ///< of the latest accepted step; empty while the run goes on
  std::vector<Figure> summary = {};        ///< of the same step: what the command prints when all goes well
  std::vector<std::string> warnings = {};  ///< as they were logged
};

inline constexpr std::string_view kManifestName = "manifest.json";

/// Writes manifest.json into the directory of a run, whole; one that is there is replaced. Throws OutputError.
void write_manifest(const std::filesystem::path& directory, const Manifest& manifest);

/// What write_manifest wrote (of components: paths, classes, names and values); empty where there is none. Throws
/// OutputError for a file that it did not write.
std::optional<Manifest> read_manifest(const std::filesystem::path& directory);

}  // namespace hexaplast::output
