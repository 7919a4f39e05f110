// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace hexaplast::runner {

/// A call of the command.
struct Call {
  std::vector<std::string> words;  ///< of the command line
  int exit_code = 0;               ///< of the subcommand
};

// Each defines a subcommand, which is carried out when the command line names it.
void add_run(CLI::App& app, Call& call);
void add_view(CLI::App& app, Call& call);
void add_element(CLI::App& app, Call& call);
void add_mesh(CLI::App& app, Call& call);
void add_check(CLI::App& app, Call& call);
void add_compare(CLI::App& app, Call& call);
void add_list(CLI::App& app, Call& call);
void add_bench(CLI::App& app, Call& call);
void add_resume(CLI::App& app, Call& call);
void add_render(CLI::App& app, Call& call);
void add_describe(CLI::App& app, Call& call);  ///< hidden: what hexaplast-sweep and hexaplast-fit ask of a scene

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

/// The finite numbers of a text between separators; empty where it is anything else.
std::vector<double> numbers_in(std::string_view text, char separator);

/// Passes on what has been printed so far. Throws OutputError when it cannot be written, as on a full disk.
void flush_standard_output();

}  // namespace hexaplast::runner
