// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/film.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

// Animated PNG: a PNG file with an acTL chunk in front and, for every picture, an fcTL chunk and its data; those of the
// first picture are the PNG's own IDAT, those of the others fdAT. All numbers are big-endian.
// ---------------------------------------------------------------------------------------------------------------------

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr int kBytes = 3;              // of a pixel
constexpr char kFilterSub = 1;         // bytes are differences to the pixel on the left
constexpr int kCompression = 6;        // of zlib
constexpr std::uint16_t kTick = 1000;  // delays are told in parts of a second

std::string big_endian(std::uint32_t number, int bytes = 4) {
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) text.push_back(static_cast<char>(number >> shift & 0xFF));
  return text;
}

std::string chunk(std::string_view type, std::string_view data) {
  const std::string body = fmt::format("{}{}", type, data);
  const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(crc));
}

/// Where two pictures of one size differ [pixels]; where they do not, one pixel.
Eigen::AlignedBox2i difference(const Image& before, const Image& now) {
  Eigen::AlignedBox2i box;
  const std::uint8_t *old_pixel = before.pixels.data(), *pixel = now.pixels.data();
  for (int y = 0; y < now.height; ++y)
    for (int x = 0; x < now.width; ++x, old_pixel += kBytes, pixel += kBytes)
      if (!std::equal(pixel, pixel + kBytes, old_pixel)) box.extend(Eigen::Vector2i(x, y));
  return box.isEmpty() ? Eigen::AlignedBox2i(Eigen::Vector2i(0, 0)) : box;
}

/// The pixels of a rectangle as the data of a PNG.
std::string compressed(const Image& image, const Eigen::AlignedBox2i& part) {
  std::string rows;
  const int left = part.min().x(), width = part.max().x() - left + 1;
  for (int y = part.min().y(); y <= part.max().y(); ++y) {
    const std::uint8_t* row = &image.pixels[(static_cast<std::size_t>(y) * image.width + left) * kBytes];
    rows.push_back(kFilterSub);
    for (int i = 0; i < width * kBytes; ++i)
      rows.push_back(static_cast<char>(row[i] - (i < kBytes ? 0 : row[i - kBytes])));
  }
  uLongf size = ::compressBound(rows.size());
  std::string packed(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
                  rows.size(), kCompression) != Z_OK)
    throw OutputError("zlib cannot compress a picture");
  packed.resize(size);
  return packed;
}

/// Repeats for ever. Of each picture only the rectangle is stored in which it differs from the one before. The chunks
/// are kept in memory until the film is finished, since the file begins with their number.
class AnimatedPng final : public Film {
 public:
  AnimatedPng(const fs::path& file, double frames_per_second) : file_(file), frames_per_second_(frames_per_second) {}

  void add(const Image& image) override {
    const bool is_first = num_frames_ == 0;
    const Eigen::AlignedBox2i whole(Eigen::Vector2i(0, 0), Eigen::Vector2i(image.width - 1, image.height - 1));
    const Eigen::AlignedBox2i part = is_first ? whole : difference(latest_, image);
    const auto delay = std::clamp(std::lround(kTick / frames_per_second_), 1L, 65535L);
    const auto number = [](int value) { return big_endian(static_cast<std::uint32_t>(value)); };
    chunks_ += chunk("fcTL", big_endian(num_numbered_++) + number(part.sizes().x() + 1) + number(part.sizes().y() + 1) +
                                 number(part.min().x()) + number(part.min().y()) +
                                 big_endian(static_cast<std::uint32_t>(delay), 2) + big_endian(kTick, 2) +
                                 std::string(2, '\0'));  // left as it is, then written over
    const std::string data = compressed(image, part);
    chunks_ += is_first ? chunk("IDAT", data) : chunk("fdAT", big_endian(num_numbered_++) + data);
    ++num_frames_;
    latest_ = image;
  }

  void finish() override {
    const std::string shape =
        big_endian(static_cast<std::uint32_t>(latest_.width)) + big_endian(static_cast<std::uint32_t>(latest_.height));
    constexpr std::string_view kEightBitRgb("\x08\x02\x00\x00\x00", 5);
    file_.write(kSignature);
    file_.write(chunk("IHDR", shape + std::string(kEightBitRgb)));
    file_.write(chunk("acTL", big_endian(num_frames_) + big_endian(0)));  // 0: for ever
    file_.write(chunks_);
    file_.write(chunk("IEND", ""));
    file_.commit();
  }

 private:
  WholeFile file_;
  double frames_per_second_;
  Image latest_;
  std::uint32_t num_frames_ = 0, num_numbered_ = 0;  // frames; chunks that carry a sequence number
  std::string chunks_;
};

// ffmpeg: a process that is started with the first picture and reads raw pixels
// ---------------------------------------------------------------------------------------------------------------------

constexpr int kFilm = 3;  // number of the unfinished film in the program: not its name, which others may exchange

/// The last line of what was written to a file that is still open.
std::string last_line(std::FILE* file) {
  std::string last;
  std::array<char, 1024> line;
  std::rewind(file);
  while (std::fgets(line.data(), line.size(), file))
    if (line[0] != '\n') last = line.data();
  return last.substr(0, last.find('\n'));
}

class Ffmpeg final : public Film {
 public:
  Ffmpeg(fs::path file, double frames_per_second) : file_(std::move(file)), frames_per_second_(frames_per_second) {
    if (std::system("command -v ffmpeg > /dev/null 2>&1") != 0)
      throw OutputError(fmt::format(
          "{}: needs the program ffmpeg, which is not on the PATH; a name that ends in .png makes an animated PNG",
          file_.string()));
    place_.emplace(file_);  // refuses what must not be replaced, and a directory that cannot be written
  }
  ~Ffmpeg() override {
    if (pipe_ >= 0) ::close(pipe_);
    if (process_ > 0) {
      ::kill(process_, SIGTERM);
      ::waitpid(process_, nullptr, 0);
    }
    if (messages_) std::fclose(messages_);
  }

  void add(const Image& image) override {
    if (process_ < 0) start(image.width, image.height);
    const std::uint8_t* data = image.pixels.data();
    for (std::size_t left = image.pixels.size(); left > 0;) {
      const ssize_t sent = ::send(pipe_, data, left, MSG_NOSIGNAL);  // when nobody reads any more: an error, no signal
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) {
        const int error = errno;
        wait();  // it knows better why it reads no more
        throw OutputError(file_, "ffmpeg takes no more pictures", error);
      }
      data += sent;
      left -= static_cast<std::size_t>(sent);
    }
  }

  void finish() override {
    wait();
    place_->commit();
  }

 private:
  void start(int width, int height) {
    std::vector<std::string> words{"ffmpeg", "-hide_banner", "-loglevel", "error", "-y",
                                   // what comes
                                   "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size",
                                   fmt::format("{}x{}", width, height), "-framerate",
                                   fmt::format("{}", frames_per_second_), "-i", "pipe:0",
                                   // what is made of it: common players want even sizes and halved colours
                                   "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p",
                                   "-movflags", "+faststart", "-f", "mp4", fmt::format("/proc/self/fd/{}", kFilm)};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);

    std::array<int, 2> ends{};
    messages_ = std::tmpfile();
    if (!messages_ || ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
      throw OutputError(file_, "no pipe to ffmpeg", errno);
    pipe_ = ends[1];

    posix_spawn_file_actions_t streams;
    ::posix_spawn_file_actions_init(&streams);
    ::posix_spawn_file_actions_adddup2(&streams, ends[0], STDIN_FILENO);
    ::posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&streams, ::fileno(messages_), STDERR_FILENO);
    ::posix_spawn_file_actions_adddup2(&streams, place_->descriptor(),
                                       kFilm);  // last: others may have that number here
    const int error = ::posix_spawnp(&process_, words[0].c_str(), &streams, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&streams);
    ::close(ends[0]);
    if (error != 0) {
      process_ = -1;
      throw OutputError(fmt::format("ffmpeg cannot be started: {}", std::strerror(error)));
    }
  }

  /// For its end; throws what it says unless it ended well.
  void wait() {
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

  fs::path file_;
  std::optional<WholeFile> place_;  // what the program writes
  double frames_per_second_;
  pid_t process_ = -1;
  int pipe_ = -1;                  // its standard input
  std::FILE* messages_ = nullptr;  // what it writes to its standard error
};

}  // namespace

bool is_film_name(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".mp4" || ending == ".png" || ending == ".apng";
}

std::unique_ptr<Film> open_film(const fs::path& file, double frames_per_second) {
  if (!is_film_name(file))
    throw InputError(fmt::format("{}: a film's name must end in .mp4, .png or .apng", file.string()));
  if (file.extension() == ".mp4") return std::make_unique<Ffmpeg>(file, frames_per_second);
  return std::make_unique<AnimatedPng>(file, frames_per_second);
}

}  // namespace hexaplast::output
