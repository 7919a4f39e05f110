// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "record/files.hpp"
#include "runner/exit_code.hpp"

namespace hexaplast::runner {
namespace {

int exit_code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : kSignalled + WTERMSIG(status); }

}  // namespace

Process::Process(const std::vector<std::string>& arguments, const std::filesystem::path& messages) {
  std::vector<char*> words = {const_cast<char*>("hexaplast")};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::unlink(messages.c_str());  // not emptied: other names of that file keep it
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, messages.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0666);
  const int error = ::posix_spawn(&id_, "/proc/self/exe", &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0)
    throw output::OutputError(
        fmt::format("a run with messages in {} cannot be started: {}", messages.string(), std::strerror(error)));
}

Process::~Process() {
  if (id_ < 0) return;
  send(SIGTERM);
  while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

Process::Process(Process&& other) noexcept : id_(std::exchange(other.id_, -1)), exit_code_(other.exit_code_) {}

std::optional<int> Process::exit_code() {
  if (id_ < 0) return exit_code_;
  int status = 0;
  if (::waitpid(id_, &status, WNOHANG) != id_) return {};
  id_ = -1;
  exit_code_ = exit_code_of(status);
  return exit_code_;
}

void Process::send(int signal) {
  if (id_ >= 0) ::kill(id_, signal);
}

}  // namespace hexaplast::runner
