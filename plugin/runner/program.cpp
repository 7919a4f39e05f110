// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "record/files.hpp"

namespace hexaplast::runner {
namespace fs = std::filesystem;
namespace {

constexpr const char* kNeeds = "it needs Python with the packages python3-numpy, python3-scipy and python3-h5py";

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

}  // namespace hexaplast::runner
