// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
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

// Not posix_spawn, which cannot ask for the signal: a run whose sweep has been killed must not go on beside the one
// that takes the sweep up again. Between fork and exec only what is safe after a fork is called.
Process::Process(const std::vector<std::string>& arguments, const std::filesystem::path& messages) {
  std::vector<char*> words = {const_cast<char*>("hexaplast")};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const auto refuse = [&](int error) {
    throw output::OutputError(
        fmt::format("a run with messages in {} cannot be started: {}", messages.string(), std::strerror(error)));
  };
  ::unlink(messages.c_str());  // not emptied: other names of that file keep it
  const int log = ::open(messages.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (log < 0) refuse(errno);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);

  // a signal that comes before the new program is there ends the run, and is not taken by what it has of this one
  sigset_t all, before;
  ::sigfillset(&all);
  ::sigprocmask(SIG_BLOCK, &all, &before);
  const pid_t parent = ::getpid();
  id_ = ::fork();
  if (id_ == 0) {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    ::sigprocmask(SIG_SETMASK, &before, nullptr);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(kSignalled + SIGKILL);  // it was too late for the signal
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execve("/proc/self/exe", words.data(), environ);
    ::_exit(kInputOutput);
  }
  const int error = errno;
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  ::close(log);
  ::close(nothing);
  if (id_ < 0) refuse(error);
  descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, id_, 0));
}

void Process::forget() {
  id_ = -1;
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

Process::~Process() {
  if (id_ < 0) return;
  send(SIGTERM);
  while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
  forget();
}

Process::Process(Process&& other) noexcept
    : id_(std::exchange(other.id_, -1)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      exit_code_(other.exit_code_) {}

std::optional<int> Process::exit_code() {
  if (id_ < 0) return exit_code_;
  int status = 0;
  if (::waitpid(id_, &status, WNOHANG) != id_) return {};
  forget();
  exit_code_ = exit_code_of(status);
  return exit_code_;
}

void Process::send(int signal) {
  if (id_ >= 0) ::kill(id_, signal);
}

}  // namespace hexaplast::runner
