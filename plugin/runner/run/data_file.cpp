// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/data_file.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "runner/process.hpp"

namespace hexaplast::runner {

DataFile::DataFile(const std::filesystem::path& file, output::Bodies bodies, output::StatePlan plan)
    : path_(file), part_(file) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw output::OutputError(file, "no socket for hexaplast-data", errno);
  socket_ = ends[0];
  try {
    program_ = start_program("hexaplast-data", {std::to_string(part_.descriptor()), file.string()}, ends[1],
                             part_.descriptor());
  } catch (...) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw;
  }
  ::close(ends[1]);
  char ready = 0;
  while (::read(socket_, &ready, 1) < 0 && errno == EINTR) {
  }
  if (ready != '1')  // it has said why
    throw output::OutputError(fmt::format("{}: hexaplast-data has ended with {}", file.string(), wait()));
  states_ = std::make_unique<output::StateStream>(socket_, std::move(bodies), std::move(plan));
}

DataFile::~DataFile() { wait(); }

void DataFile::complete(const output::NamedTexts& attributes) {
  states_->complete(attributes);
  if (const int code = wait(); code != 0)
    throw output::OutputError(fmt::format("{}: hexaplast-data has ended with {}", path_.string(), code));
  part_.commit();
}

int DataFile::wait() {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  int status = 0;
  if (program_ < 0) return 0;
  while (::waitpid(program_, &status, 0) < 0 && errno == EINTR) {
  }
  program_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace hexaplast::runner
