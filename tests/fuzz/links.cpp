// SPDX-License-Identifier: LGPL-2.1-or-later
// A link from every node: it leads somewhere, or says where it stopped.
#include "scene/links.hpp"

#include "scenes.hpp"
#include "target.hpp"

using namespace hexaplast;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static scene::Scene scene = fuzz::read(fuzz::kSmallScene);
  const auto follow = [&](auto& follow_below, scene::Node& node) -> void {
    const scene::PathResult found = scene::resolve_path(node, fuzz::text_of(data, size));
    fuzz::require((found.target == nullptr) == !found.problem.empty(), "a target or a problem");
    for (const auto& child : node.children()) follow_below(follow_below, *child);
  };
  follow(follow, scene.root());
  return 0;
}
