// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "record/files.hpp"

namespace hexaplast::runner {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNeeds =
    "it needs Python with the packages python3-numpy, python3-scipy, python3-h5py and python3-matplotlib";

fs::path this_command() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown);
}

std::vector<char*> words_of(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  return words;
}

[[noreturn]] void refuse(const fs::path& program, int error) {
  // a script that is there: its interpreter is not
  const std::string reason = error == ENOENT ? "/usr/bin/python3 is missing" : std::strerror(error);
  throw output::OutputError(fmt::format("{}: cannot be started: {}; {}", program.string(), reason, kNeeds));
}

volatile std::sig_atomic_t requested = 0;

void note(int signal) {
  // A second one ends the program at once: the step may be a long one.
  if (requested != 0) std::_Exit(128 + signal);
  requested = signal;
}

}  // namespace

fs::path find_program(const std::string& name) {
  std::vector<fs::path> places = {this_command().parent_path()};
  if (const char* list = std::getenv("PATH")) {
    const std::string_view path = list;
    for (std::size_t begin = 0; begin <= path.size();) {
      const std::size_t end = std::min(path.find(':', begin), path.size());
      if (end > begin) places.emplace_back(path.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  for (const fs::path& place : places)
    if (const fs::path program = place / name; ::access(program.c_str(), X_OK) == 0 && !fs::is_directory(program))
      return program;
  throw output::OutputError(
      fmt::format("{} is neither beside {} nor on PATH; {}", name, this_command().string(), kNeeds));
}

void become_program(const std::string& name, const std::vector<std::string>& arguments) {
  const fs::path program = find_program(name);
  ::setenv("HEXAPLAST_COMMAND", this_command().c_str(), 1);
  ::execv(program.c_str(), words_of(program, arguments).data());
  refuse(program, errno);
}

int start_program(const std::string& name, const std::vector<std::string>& arguments, int descriptor, int kept) {
  const fs::path program = find_program(name);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, descriptor, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, descriptor, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, kept, kept);  // to itself: stays open in the program
  pid_t id = -1;
  const int error = ::posix_spawn(&id, program.c_str(), &files, nullptr, words_of(program, arguments).data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) refuse(program, error);
  return id;
}

void watch_signals() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGPIPE, SIG_IGN);
}

int requested_signal() { return requested; }

void end_with(int parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) std::_Exit(128 + SIGKILL);  // it was too late for the signal
}

DirectoryLock::DirectoryLock(const std::filesystem::path& directory)
    : descriptor_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw output::OutputError(directory, "cannot be opened", errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int reason = errno;
  if (reason == EWOULDBLOCK) {
    ::close(descriptor_);
    throw output::OutputError(
        fmt::format("{}: another run or sweep is at work there: wait for its end, or end it", directory.string()));
  }
  spdlog::warn("warning: {}: cannot be locked ({}): nothing keeps a second run out", directory.string(),
               std::strerror(reason));
}

DirectoryLock::~DirectoryLock() { ::close(descriptor_); }

}  // namespace hexaplast::runner
