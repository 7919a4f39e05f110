// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "parts/option.hpp"

namespace hexaplast::support {

/// "radius: is not given; damping: -1 must be >= 0": the options that a call refuses, and why; or "nothing".
template <class Call>
std::string refused(const Call& call) {
  std::string all;
  try {
    call();
  } catch (const parts::OptionError& error) {
    for (const auto& [attribute, reason] : error.reasons())
      all += (all.empty() ? "" : "; ") + attribute + ": " + reason;
  }
  return all.empty() ? "nothing" : all;
}

}  // namespace hexaplast::support
