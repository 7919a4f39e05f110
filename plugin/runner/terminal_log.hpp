// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <spdlog/sinks/sink.h>

#include <memory>

namespace hexaplast::runner {

/// Writes messages to standard error, each on a line of its own. What they repeat of files, names and values cannot
/// steer the terminal (printable).
std::shared_ptr<spdlog::sinks::sink> make_terminal_log();

}  // namespace hexaplast::runner
