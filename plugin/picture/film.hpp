// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Takes pictures of one size, one after the other, and makes a file of them that appears whole, or not at all.
class Film {
 public:
  virtual ~Film() = default;  ///< without finish(): leaves no file

  virtual void add(const Image& image) = 0;  ///< Throws OutputError.
  virtual void finish() = 0;                 ///< After at least one picture. Throws OutputError.
};

/// Whether a film can be called so: .mp4, .png or .apng.
bool is_film_name(const std::filesystem::path& file);

/// A film that shows `frames_per_second` (> 0) pictures. Its name says what it is:
///
///   .mp4          made by ffmpeg, a program that must be on the PATH
///   .png, .apng   animated PNG: browsers play it, other programs show its first picture
///
/// Throws OutputError where ffmpeg is missing or the file cannot be created, InputError for another name.
std::unique_ptr<Film> open_film(const std::filesystem::path& file, double frames_per_second);

}  // namespace hexaplast::output
