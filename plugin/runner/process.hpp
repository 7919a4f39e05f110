// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// A program in Python that belongs to the command (hexaplast-sweep, hexaplast-fit, hexaplast-data): the first of that
/// name beside the command, or on PATH. Throws OutputError where there is none, with the packages that it needs.
std::filesystem::path find_program(const std::string& name);

/// Replaces this process by the program: with its exit code, signals and streams. It finds this command by the
/// environment variable HEXAPLAST_COMMAND. Throws OutputError where it cannot be started.
[[noreturn]] void become_program(const std::string& name, const std::vector<std::string>& arguments);

/// Starts the program with `descriptor` as its standard input and output. Its other files are closed, but for `kept`.
/// Returns the number of the process. Throws OutputError.
int start_program(const std::string& name, const std::vector<std::string>& arguments, int descriptor, int kept);

/// From now on SIGINT and SIGTERM are noted instead of ending the program, and writing to a closed pipe is an error of
/// that write alone.
void watch_signals();

/// Number of the signal that asked the run to end; 0: none did.
int requested_signal();

/// Kills this process when the thread of `parent` ends that has started it, in whatever way.
void end_with(int parent);

/// Keeps other runs and sweeps out of the directory that one of them writes, while it lives. The system takes it back
/// when the program ends, however it ends, and no file is left for it. Programs that it starts do not keep it.
class DirectoryLock {
 public:
  /// Throws OutputError when somebody else has the directory. Where the file system knows no locks, a warning is logged
  /// and nobody is kept out.
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace hexaplast::runner
