// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_take_steps THREADS STEPS [PATH.ATTRIBUTE=VALUE...] SCENE...: takes time steps of scenes and goes on from a
// state that was put down half way, which must end alike. For sanitizers: it needs no more of the program than the
// library and the components.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "hexaplast/base/parallel.hpp"
#include "support/scene.hpp"

using namespace hexaplast;

namespace {

scene::Scene ready(const char* file, const std::vector<std::string>& assignments) {
  scene::Scene scene = scene::read_scene(file, support::factory(), support::plugins());
  for (const std::string& assignment : assignments) scene::override_attribute(scene, assignment);
  scene.init();
  return scene;
}

void take_steps(scene::Scene& scene, int count) {
  for (int step = 0; step < count; ++step) scene.step();
}

std::vector<std::byte> put_down(scene::Scene& scene) {
  std::vector<std::byte> bytes;
  Archive archive([&](const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
  });
  scene.serialize(archive);
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s THREADS STEPS [PATH.ATTRIBUTE=VALUE...] SCENE...\n", argv[0]);
    return 2;
  }
  set_num_threads(std::atoi(argv[1]));
  const int num_steps = std::atoi(argv[2]), half = num_steps / 2;
  std::vector<std::string> assignments;
  for (int i = 3; i < argc; ++i) {
    if (std::strchr(argv[i], '=')) {
      assignments.emplace_back(argv[i]);
      continue;
    }
    scene::Scene straight = ready(argv[i], assignments);
    take_steps(straight, half);
    const std::vector<std::byte> half_way = put_down(straight);
    take_steps(straight, num_steps - half);

    scene::Scene resumed = ready(argv[i], assignments);
    Archive archive{std::span<const std::byte>(half_way)};
    resumed.serialize(archive);
    take_steps(resumed, num_steps - half);

    const bool is_alike = put_down(resumed) == put_down(straight);
    std::printf("%s: %d steps%s\n", argv[i], num_steps, is_alike ? "" : ", and others after it was resumed");
    std::fflush(stdout);
    if (!is_alike) return 1;
    straight.reset();
    take_steps(straight, 1);
  }
}
