// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// This program once more, in a process of its own that reads and prints nothing; its messages go to a new file.
class Process {
 public:
  /// arguments: without the program's name. Throws OutputError where `messages` cannot be written or the system starts
  /// no more processes.
  Process(const std::vector<std::string>& arguments, const std::filesystem::path& messages);
  ~Process();  ///< ends it, if it still runs, and waits for it
  Process(Process&& other) noexcept;
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// What can be waited for until it has ended; -1: it has.
  int descriptor() const { return descriptor_; }

  /// Its exit code, 128 plus the signal that ended it; empty: it still runs.
  std::optional<int> exit_code();

  /// Sends it a signal, if it still runs.
  void send(int signal);

 private:
  void forget();  // it has ended

  pid_t id_;  // -1: it has ended
  int descriptor_ = -1;
  int exit_code_ = 0;
};

}  // namespace hexaplast::runner
