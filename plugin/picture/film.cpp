// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/film.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "picture/animated_png.hpp"
#include "picture/ffmpeg.hpp"

namespace hexaplast::output {

bool is_film_name(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".mp4" || ending == ".png" || ending == ".apng";
}

std::unique_ptr<Film> open_film(const std::filesystem::path& file, double frames_per_second) {
  if (!is_film_name(file))
    throw InputError(fmt::format("{}: a film's name must end in .mp4, .png or .apng", file.string()));
  if (file.extension() == ".mp4") return std::make_unique<Ffmpeg>(file, frames_per_second);
  return std::make_unique<AnimatedPng>(file, frames_per_second);
}

}  // namespace hexaplast::output
