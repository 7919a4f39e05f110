// SPDX-License-Identifier: LGPL-2.1-or-later
// What follows --set: refused, or the scene still can be made.
#include "scenes.hpp"
#include "target.hpp"

using namespace hexaplast;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  scene::Scene scene = fuzz::read(fuzz::kSmallScene);
  try {
    scene::override_attribute(scene, fuzz::text_of(data, size));
  } catch (const scene::OverrideError&) {
  }
  return 0;
}
