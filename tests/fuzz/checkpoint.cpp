// SPDX-License-Identifier: LGPL-2.1-or-later
// Checkpoints of a bar that flows and has torn. The first byte chooses: what follows is a file (0), or changes to a
// good file (1), to which the checksums are then made to fit, so that what they guard is reached as well (2). The scene
// refuses what it reads, or goes on from it.
#include "record/checkpoint.hpp"

#include <cstring>
#include <span>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "hexaplast/body.hpp"
#include "scenes.hpp"
#include "target.hpp"

using namespace hexaplast;
using Bytes = std::vector<std::uint8_t>;

namespace {

constexpr std::string_view kBar = R"(<Node dt="0.02" gravity="0 0 -9.81">
  <DefaultAnimationLoop/>
  <EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.01"/>
  <CGLinearSolver iterations="20" warmStart="true"/>
  <RegularGridTopology name="grid" n="2 2 4" max="0.1 0.1 0.3"/>
  <MechanicalObject name="nodes"/>
  <DiagonalMass massDensity="1000"/>
  <HexahedronElastoplasticFEMForceField youngModulus="2e4" poissonRatio="0.3" yieldStress="200" plasticFlowRate="4"
      hardening="0.1" rotationYield="0.01" rotationFlowRate="2" fractureStretch="1.01" restShape="joined"/>
  <FixedProjectiveConstraint indices="12-15"/>
  <LinearMovementProjectiveConstraint indices="0" keyTimes="0 0.1 9" movements="0 0 0  0.01 0 0  0.01 0 0"/>
  <GraspForceField radius="0.12" keyTimes="0 0.3" positions=".1 .05 0  .2 .05 -.1" graspTime="0.02" releaseTime="0.3"
      stiffness="300" maxForce="12"/>
</Node>)";

scene::Scene bar() {
  scene::Scene scene = fuzz::read(kBar);
  scene.init();
  return scene;
}

Bytes good_file() {
  scene::Scene scene = bar();
  bool has_torn = false;
  for (int step = 0; step < 40; ++step) {
    scene.step();
    for (const scene::ForceField* field : scene.root().all<scene::ForceField>())
      has_torn = has_torn || (field->body() && !field->body()->removed().empty());
  }
  fuzz::require(has_torn, "the bar tears");
  const output::CheckpointSection sections[] = {{"scene", [&](Archive& archive) { scene.serialize(archive); }}};
  Bytes bytes;
  output::write_checkpoint(
      [&](const void* data, std::size_t size) {
        const auto* first = static_cast<const std::uint8_t*>(data);
        bytes.insert(bytes.end(), first, first + size);
      },
      0, sections);
  return bytes;
}

/// Four bytes are a change: where (two of them, the greater part last), what kind of change, and a value for it.
void change(Bytes& bytes, const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kLarge[] = {
      0, 1, ~0ull, 1ull << 31, 1ull << 63, 0x7ff0000000000000, 0x7ff8000000000000, 0x3ff0000000000000};
  for (; size >= 4 && !bytes.empty(); data += 4, size -= 4) {
    const std::size_t at = (data[0] + 256u * data[1]) % bytes.size(), left = bytes.size() - at;
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (data[2] % 3) {
      case 0:
        *place = data[3];
        break;
      case 1:
        std::memcpy(&*place, &kLarge[data[3] % std::size(kLarge)], std::min<std::size_t>(left, 8));
        break;
      default:
        bytes.erase(place, place + static_cast<std::ptrdiff_t>(std::min<std::size_t>(left, data[3])));
    }
  }
}

/// Makes the checksums fit, as far as the sizes of the sections lead.
void mend(Bytes& bytes) {
  const auto seal = [&](std::size_t begin, std::size_t end) {
    if (bytes.size() < end + 8) return false;
    StateHash hash;
    hash.add(bytes.data() + begin, end - begin);
    const std::uint64_t checksum = hash.value();
    std::memcpy(bytes.data() + end, &checksum, 8);
    return true;
  };
  std::size_t begin = 0, end = 24;
  while (seal(begin, end)) {
    begin = end + 8;
    if (bytes.size() < begin + 16) return;
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + begin + 8, 8);
    if (size > bytes.size() - begin - 16) return;
    end = begin + 16 + size;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Bytes good = good_file();
  if (size == 0) return 0;
  const int kind = data[0] % 3;
  Bytes bytes = kind == 0 ? Bytes(data + 1, data + size) : good;
  if (kind != 0) change(bytes, data + 1, size - 1);
  if (kind == 2) mend(bytes);

  const std::span<const std::byte> content = std::as_bytes(std::span(bytes));
  try {
    const output::Checkpoint checkpoint("input", {content.begin(), content.end()});
    fuzz::require(kind == 2 || bytes == good, "only what is undamaged is read");
    Archive archive = checkpoint.section("scene");
    scene::Scene scene = bar();
    scene.serialize(archive);
    scene.step();
  } catch (const InputError&) {
  } catch (const NumericalError&) {
  } catch (const scene::SceneError&) {
  }
  return 0;
}
