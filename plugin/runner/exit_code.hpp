// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace hexaplast::runner {

/// What the command tells its caller. Fixed: scripts rely on it.
enum ExitCode : int {
  kOk = 0,
  kUsage = 2,        ///< the command line does not make sense
  kScene = 3,        ///< scene or mesh rejected
  kNumerical = 4,    ///< the computation failed
  kInputOutput = 5,  ///< a file cannot be read or written
  kPlugin = 6,       ///< a plugin cannot be used
  kSignalled = 128   ///< plus the number of the signal: 130 SIGINT, 143 SIGTERM
};

/// The command line does not make sense for this scene.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& what, std::string hint = {})
      : std::runtime_error(what), hint_(std::move(hint)) {}
  const std::string& hint() const { return hint_; }

 private:
  std::string hint_;
};

}  // namespace hexaplast::runner
