// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast check`, as the command line gives it.
struct CheckOptions {
  SceneOptions scene;
  bool json = false;
};

/// Reads, resolves and initialises a scene as a run does, and prints what it means without stepping; logs a warning for
/// what is legal but unwise. Throws what the modules below throw.
void check(const CheckOptions& options);

}  // namespace hexaplast::runner
