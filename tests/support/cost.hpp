// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fcntl.h>
#include <sys/resource.h>

#include <vector>

#include "support/command.hpp"

namespace hexaplast::support {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr double kMegabytesMore = 300;  // sanitizers have a shadow of the memory
#else
inline constexpr double kMegabytesMore = 0;
#endif

/// What a run of the command cost.
struct Cost {
  int code;          ///< exit code; -1: it did not exit
  double megabytes;  ///< most memory held
};

/// Runs the command with the given words; its messages go to a file.
inline Cost cost_of(std::vector<std::string> words, const std::filesystem::path& messages) {
  words.insert(words.begin(), HEXAPLAST_COMMAND);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // not by posix_spawn: the child would be charged with the most memory that the test has ever held
  const pid_t child = fork();
  if (child < 0) return {-1, 0};
  if (child == 0) {
    ::dup2(::open("/dev/null", O_WRONLY), 1);
    ::dup2(::open(messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
    ::execv(HEXAPLAST_COMMAND, arguments.data());
    std::_Exit(99);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          1024e-6 * static_cast<double>(usage.ru_maxrss)};  // that is in KiB
}

/// Files made to hurt: refused with a message, and in little memory.
class Hostile : public Command {
 protected:
  /// The command refuses the file with that content, in so many megabytes and so many times its size.
  void expect_bounded(const std::vector<std::string>& words, const std::string& file, const std::string& bytes,
                      const std::string& message, double megabytes = 100, double sizes = 1) {
    write(file, bytes);
    const Cost cost = cost_of(words, directory_ / "err");
    EXPECT_EQ(cost.code, 3) << message;
    EXPECT_TRUE(has(read("err"), message));
    EXPECT_LT(cost.megabytes, megabytes + kMegabytesMore + 1e-6 * sizes * static_cast<double>(bytes.size())) << message;
  }
};

}  // namespace hexaplast::support
