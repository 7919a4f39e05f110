// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast describe SCENE`, which hexaplast-sweep and hexaplast-fit ask before their first run; it is not shown.
CLI::App* add_describe(CLI::App& app, SceneOptions& options);

/// Reads a request (JSON) from standard input, and prints what it needs to know of the scene (JSON):
///
///   version, simd, scene_hash; steps: those of RunSettings, or null; inputs: device and inode of each file that is
///   read vary: [{option, attribute, values}]  -> attributes: [{unit}]; every value is checked free: [{option,
///   attribute, limits}]  -> free: [{unit, given}]; given: the value of the scene, null if not one number curve:
///   {steps, pulls, assignments}   -> curve: {dt, bodies, ends, probes: [{name, unit}], pulls}: of the scene with
///                                           the assignments, initialised; pulls: per step [N], if asked for
///
/// Throws what reading a scene throws, and UsageError.
void describe(const SceneOptions& options);

}  // namespace hexaplast::runner
