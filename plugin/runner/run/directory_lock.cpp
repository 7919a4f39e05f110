// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/directory_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "record/files.hpp"

namespace hexaplast::runner {

DirectoryLock::DirectoryLock(const std::filesystem::path& directory)
    : descriptor_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw output::OutputError(directory, "cannot be opened", errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int reason = errno;
  if (reason == EWOULDBLOCK) {
    ::close(descriptor_);
    throw output::OutputError(
        fmt::format("{}: another run or sweep is at work there: wait for its end, or end it", directory.string()));
  }
  spdlog::warn("warning: {}: cannot be locked ({}): nothing keeps a second run out", directory.string(),
               std::strerror(reason));
}

DirectoryLock::~DirectoryLock() { ::close(descriptor_); }

}  // namespace hexaplast::runner
