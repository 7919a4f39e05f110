// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

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
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::path(testing::TempDir()) / (std::string("hexaplast_") + info->test_suite_name() +
                                                              "_" + info->name() + "_" + std::to_string(getpid()));
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

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

  void write(const std::string& name, const std::string& text) { std::ofstream(directory_ / name) << text; }

  std::filesystem::path directory_;
};

}  // namespace hexaplast::support
