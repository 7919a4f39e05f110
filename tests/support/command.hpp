// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "support/csv.hpp"
#include "support/files.hpp"

namespace hexaplast::support {

/// What a process left behind.
struct Outcome {
  int code;  ///< exit code; minus the signal that ended it
  std::string out, err;
};

/// As one word of a shell.
inline std::string quoted(const std::string& text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return all + "'";
}

/// Runs the command as its users do, in a directory of its own.
class Command : public testing::Test {
 protected:
  using Outcome = support::Outcome;
  using Json = nlohmann::json;

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

  /// The same, which must end with this code and have that message among its errors.
  Outcome fails(const std::string& arguments, int code, const std::string& message, const std::string& before = "") {
    Outcome outcome = hexaplast(arguments, before);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_TRUE(has(outcome.err, message)) << arguments;
    return outcome;
  }

  /// Each of these command lines ends with its code, has its message among its errors, and prints nothing else.
  void expect_refused(std::initializer_list<std::tuple<std::string, int, std::string>> lines) {
    for (const auto& [arguments, code, message] : lines)
      EXPECT_EQ(fails(arguments, code, message).out, "") << arguments;
  }

  void write(const std::string& name, const std::string& text) { put(directory_ / name, text); }
  std::string read(const std::string& name) const { return content(directory_ / name); }
  Json json(const std::string& name) const { return Json::parse(read(name)); }
  Json manifest(const std::string& run = "run") const { return json(run + "/manifest.json"); }
  Csv history(const std::string& run = "run") const { return Csv(read(run + "/history.csv")); }
  bool is_there(const std::string& name) const { return std::filesystem::exists(directory_ / name); }

  /// The line of a summary that has it.
  static std::string hash_in(const Outcome& outcome) {
    const std::size_t at = outcome.out.find("state hash");
    return at == outcome.out.npos ? outcome.err : outcome.out.substr(at, outcome.out.find('\n', at) - at);
  }

  const Scratch scratch_;
  const std::filesystem::path directory_ = scratch_.path();
};

}  // namespace hexaplast::support
