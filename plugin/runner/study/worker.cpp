// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/worker.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "hexaplast/base/parallel.hpp"
#include "record/files.hpp"
#include "runner/exit_code.hpp"
#include "runner/run/interrupt.hpp"
#include "runner/study/experiment.hpp"

namespace hexaplast::runner {
namespace {

constexpr std::int64_t kNone = -1;        // in place of the number of values: there is no answer
constexpr std::int64_t kMax = 1LL << 32;  // values; more than any curve has

/// False where the other side is gone.
bool write_all(int to, const void* data, std::size_t size) {
  for (const char* at = static_cast<const char*>(data); size > 0;) {
    const ssize_t done = ::send(to, at, size, MSG_NOSIGNAL);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

bool read_all(int from, void* data, std::size_t size) {
  for (char* at = static_cast<char*>(data); size > 0;) {
    const ssize_t done = ::recv(from, at, size, 0);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

bool write_values(int to, const std::optional<std::vector<double>>& values) {
  const std::int64_t count = values ? static_cast<std::int64_t>(values->size()) : kNone;
  return write_all(to, &count, sizeof count) &&
         (!values || write_all(to, values->data(), values->size() * sizeof(double)));
}

/// False where the other side is gone.
bool read_values(int from, std::optional<std::vector<double>>& values) {
  std::int64_t count = 0;
  values.reset();
  if (!read_all(from, &count, sizeof count) || count > kMax) return false;
  if (count < 0) return true;
  values.emplace(static_cast<std::size_t>(count));
  return read_all(from, values->data(), values->size() * sizeof(double));
}

[[noreturn]] void refuse_to_start(int error) {
  throw output::OutputError(fmt::format("a process for evaluations cannot be started: {}", std::strerror(error)));
}

std::vector<std::string> own_arguments() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  return words;
}

}  // namespace

Worker Worker::start(int threads) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) refuse_to_start(errno);
  std::vector<std::string> arguments = own_arguments();
  arguments.insert(arguments.begin() + 2, "--worker");  // behind the command, before a -- that ends options
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  pid_t id = -1;
  const int error = ::posix_spawn(&id, "/proc/self/exe", &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    refuse_to_start(error);
  }
  write_values(ends[0], {{static_cast<double>(threads)}});
  return {id, ends[0]};
}

Worker Worker::at(int socket) {
  struct stat found {};
  if (::fstat(socket, &found) != 0 || !S_ISSOCK(found.st_mode))
    throw UsageError(fmt::format("--asks {}: must be the number of a socket", socket));
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
  return {-1, socket};
}

Worker::Worker(Worker&& other) noexcept
    : id_(std::exchange(other.id_, -1)), socket_(std::exchange(other.socket_, -1)) {}

Worker::~Worker() {
  if (socket_ >= 0) ::close(socket_);
  if (id_ < 0) return;
  ::kill(id_, SIGTERM);
  while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

// A process that has ended is found when the answer is read.
void Worker::ask(const std::vector<double>& question) const { write_values(socket_, question); }

std::optional<std::vector<double>> Worker::answer() const {
  std::optional<std::vector<double>> found;
  if (!read_values(socket_, found)) throw output::OutputError("a process that evaluates has ended by itself");
  return found;
}

void serve(const Answer& answer) {
  std::optional<std::vector<double>> question;
  if (!read_values(STDIN_FILENO, question) || !question || question->empty()) return;
  set_num_threads(static_cast<int>(question->front()));
  while (read_values(STDIN_FILENO, question) && question)
    if (!write_values(STDOUT_FILENO, answer(*question))) return;
}

std::vector<std::optional<std::vector<double>>> ask_all(std::vector<Worker>& workers,
                                                        const std::vector<std::vector<double>>& questions) {
  constexpr std::size_t kIdle = static_cast<std::size_t>(-1);
  std::vector<std::optional<std::vector<double>>> answers(questions.size());
  std::vector<std::size_t> asked(workers.size(), kIdle);
  std::size_t next = 0, num_answers = 0;
  while (num_answers < questions.size()) {
    for (std::size_t w = 0; w < workers.size() && next < questions.size(); ++w) {
      if (asked[w] != kIdle) continue;
      workers[w].ask(questions[next]);
      asked[w] = next++;
    }
    std::vector<pollfd> waited;
    for (std::size_t w = 0; w < workers.size(); ++w)
      waited.push_back({asked[w] == kIdle ? -1 : workers[w].descriptor(), POLLIN, 0});
    constexpr int kPatience = 200;  // [ms] a signal may come just before
    const int found = ::poll(waited.data(), waited.size(), kPatience);
    if (requested_signal() != 0) throw Interrupted();
    for (std::size_t w = 0; found > 0 && w < workers.size(); ++w) {
      if (asked[w] == kIdle || waited[w].revents == 0) continue;
      answers[asked[w]] = workers[w].answer();
      asked[w] = kIdle;
      ++num_answers;
    }
  }
  return answers;
}

}  // namespace hexaplast::runner
