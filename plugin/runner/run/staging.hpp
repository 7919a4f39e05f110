// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "picture/gallery.hpp"
#include "record/manifest.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

/// How pictures show a scene: its embedded surfaces, its camera, and what of it.
output::Staging staging_of(Simulation& simulation);

/// What the command line says of it. Throws UsageError for a region that is not there.
void stage(const PictureOptions& options, output::Staging& staging);

/// What of that a manifest keeps, and the way back.
output::PictureRecord record_of(const output::Staging& staging);
void restore(const output::PictureRecord& record, output::Staging& staging);

}  // namespace hexaplast::runner
