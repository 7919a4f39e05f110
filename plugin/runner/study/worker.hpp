// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <vector>

namespace hexaplast::runner {

/// Somebody who is asked for numbers again and again.
class Worker {
 public:
  /// This program once more, with the same arguments and --worker. threads: that it is to use. Throws OutputError where
  /// the system starts no more processes.
  static Worker start(int threads);

  /// Whoever is at the other end of a socket that this process has been given, and answers as serve() does. Throws
  /// UsageError where it is none.
  static Worker at(int socket);

  ~Worker();  ///< ends it: the other side finds that nobody asks any more
  Worker(Worker&& other) noexcept;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void ask(const std::vector<double>& question) const;  ///< it has answered the question before

  /// What can be waited for until the answer is there.
  int descriptor() const { return socket_; }

  /// Waits for the answer. Throws OutputError where the process has ended instead.
  std::optional<std::vector<double>> answer() const;

 private:
  Worker(pid_t id, int socket) : id_(id), socket_(socket) {}

  pid_t id_ = -1;  // -1: none of ours
  int socket_ = -1;
};

/// Answers to questions, none where there is no answer.
using Answer = std::function<std::optional<std::vector<double>>(const std::vector<double>&)>;

/// What the other side does, on standard input and output: sets the number of threads, answers until nobody asks any
/// more. What `answer` throws passes through.
void serve(const Answer& answer);

/// The answers to questions, in their order, by workers at the same time. Throws Interrupted (experiment.hpp) on a
/// signal, OutputError.
std::vector<std::optional<std::vector<double>>> ask_all(std::vector<Worker>& workers,
                                                        const std::vector<std::vector<double>>& questions);

}  // namespace hexaplast::runner
