// SPDX-License-Identifier: LGPL-2.1-or-later
// Prints the best instruction set (lowest bit) that the processor has.
#include <cstdio>

#include "hwy/targets.h"

int main() {
  const long long present = hwy::SupportedTargets() & HWY_TARGETS;
  std::printf("%lldLL", present & -present);
}
