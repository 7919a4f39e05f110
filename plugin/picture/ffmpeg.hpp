// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <optional>
#include <string>

#include "hexaplast/formats/whole_file.hpp"
#include "picture/film.hpp"

namespace hexaplast::output {

/// A film made by ffmpeg: a process that is started with the first picture and reads raw pixels from a pipe.
class Ffmpeg final : public Film {
 public:
  /// Looks for the program. Throws OutputError.
  Ffmpeg(std::filesystem::path file, double frames_per_second);
  ~Ffmpeg() override;

  void add(const Image& image) override;
  void finish() override;

 private:
  void start(int width, int height);
  void wait();  // for its end; throws what it says unless it ended well

  std::filesystem::path file_, program_;
  std::optional<WholeFile> place_;  // what the program writes
  double frames_per_second_;
  pid_t process_ = -1;
  int pipe_ = -1;                  // its standard input
  std::FILE* messages_ = nullptr;  // what it writes to its standard error
};

}  // namespace hexaplast::output
