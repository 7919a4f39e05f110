// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <tuple>

#include "support/files.hpp"

namespace hexaplast::support {

/// What a process left behind.
struct Outcome {
  int code;  ///< exit code; minus the signal that ended it
  std::string out, err;
};

/// Runs the command as its users do, in a directory of its own.
class Command : public testing::Test {
 protected:
  /// A line of shell, in that directory.
  Outcome shell(const std::string& words) {
    const std::string line = "cd '" + directory_.string() + "' && " + words + " > out 2> err < /dev/null";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content(directory_ / "out"),
            content(directory_ / "err")};
  }

  Outcome hexaplast(const std::string& arguments, const std::string& before = "") {
    return shell(before + " '" + HEXAPLAST_COMMAND + "' " + arguments);
  }

  /// The same, which must succeed.
  Outcome succeeds(const std::string& arguments, const std::string& before = "") {
    Outcome outcome = hexaplast(arguments, before);
    EXPECT_EQ(outcome.code, 0) << arguments << "\n" << outcome.err;
    return outcome;
  }

  /// Each of these command lines ends with its code, has its message among its errors, and prints nothing else.
  void expect_refused(std::initializer_list<std::tuple<std::string, int, std::string>> lines) {
    for (const auto& [arguments, code, message] : lines) {
      const Outcome outcome = hexaplast(arguments);
      EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
      EXPECT_NE(outcome.err.find(message), std::string::npos) << arguments << "\n" << outcome.err;
      EXPECT_EQ(outcome.out, "") << arguments;
    }
  }

  void write(const std::string& name, const std::string& text) { std::ofstream(directory_ / name) << text; }

  const Scratch scratch_;
  const std::filesystem::path directory_ = scratch_.path();
};

}  // namespace hexaplast::support
