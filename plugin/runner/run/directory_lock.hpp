// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

namespace hexaplast::runner {

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
