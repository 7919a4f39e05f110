// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <string>
#include <type_traits>

#include "runner/exit_code.hpp"

namespace hexaplast::runner {

/// Logs an error and returns the code.
int report(ExitCode code, const std::string& message);

/// Carries out a subcommand, which returns an exit code, and turns what it throws into a message about `subject` and an
/// exit code.
int report_errors(const std::string& subject, const std::function<int()>& action);

/// The same for one that returns nothing: 0 where it throws nothing.
template <class Action>
requires std::is_void_v<std::invoke_result_t<Action>>
int report_errors(const std::string& subject, const Action& action) {
  return report_errors(subject, std::function<int()>([&] {
                         action();
                         return static_cast<int>(kOk);
                       }));
}

}  // namespace hexaplast::runner
