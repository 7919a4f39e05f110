// SPDX-License-Identifier: LGPL-2.1-or-later
// Prints the instruction sets that a program on this machine never chooses: all but the baseline, which must be there,
// and the best (lowest bit) that the processor has.
#include <cstdio>

#include "hwy/targets.h"

int main() {
  const long long present = hwy::SupportedTargets() & HWY_TARGETS;
  std::printf("%lldLL", HWY_TARGETS & ~(present & -present) & ~static_cast<long long>(HWY_STATIC_TARGET));
}
