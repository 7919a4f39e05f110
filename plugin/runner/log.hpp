// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <spdlog/sinks/sink.h>

#include <memory>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// Writes messages to standard error, each on a line of its own. What they repeat of files, names and values cannot
/// steer the terminal (printable).
std::shared_ptr<spdlog::sinks::sink> make_terminal_log();

/// Remembers every warning that is logged during its life, also while the log shows errors alone. Each once: what a run
/// says again and again it need not keep again and again.
class KeptWarnings {
 public:
  KeptWarnings();
  ~KeptWarnings();
  KeptWarnings(const KeptWarnings&) = delete;
  KeptWarnings& operator=(const KeptWarnings&) = delete;

  std::vector<std::string> texts() const;

 private:
  class Sink;
  std::shared_ptr<Sink> sink_;
};

}  // namespace hexaplast::runner
