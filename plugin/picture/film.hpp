// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hexaplast/formats/whole_file.hpp"
#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Why a film cannot be called so; empty: it can.
std::string refusal_of_film(const std::filesystem::path& file);

/// Takes pictures of one size, one after the other, and makes a file of them that appears whole, or not at all: an
/// animated PNG. Browsers play it, other programs show its first picture. It repeats for ever. Of each picture only the
/// rectangle is stored in which it differs from the one before. The chunks are kept in memory until the film is
/// finished, since the file begins with their number.
class Film {
 public:
  /// frames_per_second: > 0. Throws OutputError where the file cannot be created, InputError for a name that is
  /// refused.
  Film(const std::filesystem::path& file, double frames_per_second);

  void add(const Image& image);  ///< Throws OutputError.
  void finish();                 ///< After at least one picture; without it there is no file. Throws OutputError.

 private:
  WholeFile file_;
  double frames_per_second_;
  Image latest_;
  std::uint32_t num_frames_ = 0, num_numbered_ = 0;  // frames; chunks that carry a sequence number
  std::string chunks_;
};

}  // namespace hexaplast::output
