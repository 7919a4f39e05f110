// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/standard_output.hpp"

#include <cstdio>
#include <iostream>

#include "record/files.hpp"

namespace hexaplast::runner {

void flush_standard_output() {
  std::cout.flush();
  if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout))
    throw output::OutputError("standard output cannot be written");
}

}  // namespace hexaplast::runner
