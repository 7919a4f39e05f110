// SPDX-License-Identifier: LGPL-2.1-or-later
// A plugin that leaves a file in the working directory as soon as it is loaded, before any of its functions is called.
#include <fstream>

#include "scene/plugin.hpp"

namespace {

const bool has_run = [] {
  std::ofstream("planted_code_has_run") << "by the dynamic loader";
  return true;
}();

}  // namespace

HEXAPLAST_PLUGIN(factory) { static_cast<void>(has_run); }
