// SPDX-License-Identifier: LGPL-2.1-or-later
// A scene as read, before its components build anything: their sizes are limited elsewhere, but may be large.
#include "hexaplast/base/error.hpp"
#include "scenes.hpp"
#include "target.hpp"

using namespace hexaplast;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    fuzz::read(fuzz::text_of(data, size));
  } catch (const scene::SceneError&) {
  } catch (const scene::PluginError&) {
  }
  return 0;
}
