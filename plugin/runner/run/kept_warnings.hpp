// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace hexaplast::runner {

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
