// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/ffmpeg.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

constexpr int kFilm = 3;  // number of the unfinished film in the program: not its name, which others may exchange

/// The place of a program on the PATH; empty where there is none.
fs::path find_program(const std::string& name) {
  const char* variable = std::getenv("PATH");
  std::string_view places = variable ? variable : "";
  while (!places.empty()) {
    const std::string_view place = places.substr(0, places.find(':'));
    places.remove_prefix(std::min(places.size(), place.size() + 1));
    std::error_code error;
    const fs::path file = fs::path(place.empty() ? "." : place) / name;
    if (fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

/// While it lives, writing to a pipe that nobody reads any more is an error of this thread, not a signal.
class WithoutBrokenPipeSignal {
 public:
  WithoutBrokenPipeSignal() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutBrokenPipeSignal() {
    const timespec at_once{};
    if (::sigismember(&before_, SIGPIPE) == 0)
      while (::sigtimedwait(&pipe_, nullptr, &at_once) == SIGPIPE) continue;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  WithoutBrokenPipeSignal(const WithoutBrokenPipeSignal&) = delete;
  WithoutBrokenPipeSignal& operator=(const WithoutBrokenPipeSignal&) = delete;

 private:
  sigset_t pipe_, before_;
};

/// The last line of what was written to a file that is still open.
std::string last_line(std::FILE* file) {
  std::string text, line;
  std::rewind(file);
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    if (c != '\n') {
      line.push_back(static_cast<char>(c));
      continue;
    }
    if (!line.empty()) text = line;
    line.clear();
  }
  return line.empty() ? text : line;
}

}  // namespace

Ffmpeg::Ffmpeg(fs::path file, double frames_per_second)
    : file_(std::move(file)), program_(find_program("ffmpeg")), frames_per_second_(frames_per_second) {
  if (program_.empty())
    throw OutputError(fmt::format(
        "{}: needs the program ffmpeg, which is not on the PATH; a name that ends in .png makes an animated PNG",
        file_.string()));
  place_.emplace(file_);  // refuses what must not be replaced, and a directory that cannot be written
}

Ffmpeg::~Ffmpeg() {
  if (pipe_ >= 0) ::close(pipe_);
  if (process_ > 0) {
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  if (messages_) std::fclose(messages_);
}

void Ffmpeg::start(int width, int height) {
  std::vector<std::string> words{program_.string(), "-hide_banner", "-loglevel", "error", "-y",
                                 // what comes
                                 "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size",
                                 fmt::format("{}x{}", width, height), "-framerate",
                                 fmt::format("{}", frames_per_second_), "-i", "pipe:0",
                                 // what is made of it: common players want even sizes and halved colours
                                 "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-movflags",
                                 "+faststart", "-f", "mp4", fmt::format("/proc/self/fd/{}", kFilm)};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  messages_ = std::tmpfile();
  if (!messages_ || ::pipe2(ends.data(), O_CLOEXEC) != 0) throw OutputError(file_, "no pipe to ffmpeg", errno);
  pipe_ = ends[1];

  posix_spawn_file_actions_t streams;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawn_file_actions_adddup2(&streams, ends[0], STDIN_FILENO);
  ::posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&streams, ::fileno(messages_), STDERR_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, place_->descriptor(), kFilm);  // last: others may have that number here
  const int error = ::posix_spawn(&process_, program_.c_str(), &streams, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&streams);
  ::close(ends[0]);
  if (error != 0) {
    process_ = -1;
    throw OutputError(fmt::format("{} cannot be started: {}", program_.string(), std::strerror(error)));
  }
}

void Ffmpeg::add(const Image& image) {
  if (process_ < 0) start(image.width, image.height);
  const WithoutBrokenPipeSignal guard;
  const std::uint8_t* data = image.pixels.data();
  for (std::size_t left = image.pixels.size(); left > 0;) {
    const ssize_t written = ::write(pipe_, data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      wait();  // it knows better why it reads no more
      throw OutputError(file_, "ffmpeg takes no more pictures", error);
    }
    data += written;
    left -= static_cast<std::size_t>(written);
  }
}

void Ffmpeg::finish() {
  wait();
  place_->commit();
}

void Ffmpeg::wait() {
  ::close(pipe_);
  pipe_ = -1;
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
  process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  const std::string how = WIFEXITED(status) ? fmt::format("ended with code {}", WEXITSTATUS(status))
                                            : fmt::format("was ended by signal {}", WTERMSIG(status));
  const std::string said = last_line(messages_);
  throw OutputError(fmt::format("{}: ffmpeg {}{}{}", file_.string(), how, said.empty() ? "" : ": ", said));
}

}  // namespace hexaplast::output
