// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base/simd.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "hwy/targets.h"

namespace hexaplast {

namespace {

/// Sets that were compiled and that the machine has, best (lowest bit) first.
std::vector<std::int64_t> available() {
  std::vector<std::int64_t> sets;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1)
    sets.push_back(left & -left);
  if (sets.empty()) throw InputError("this processor has none of the instruction sets that Hexaplast was built for");
  return sets;
}

}  // namespace

std::string simd_target() { return hwy::TargetName(available().front()); }

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const std::int64_t set : available()) names.emplace_back(hwy::TargetName(set));
  return names;
}

void set_simd_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  if (name.empty()) return;
  for (const std::int64_t set : available()) {
    if (name != hwy::TargetName(set)) continue;
    hwy::SetSupportedTargetsForTest(set);
    return;
  }
  throw InputError(fmt::format("instruction set {}: must be one of {}", name, fmt::join(simd_targets(), ", ")));
}

bool simd_has_half() { return (available().front() & (HWY_AVX2 | HWY_AVX3)) != 0; }

}  // namespace hexaplast
