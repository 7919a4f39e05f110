// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <string>

#include "hexaplast/formats/whole_file.hpp"
#include "picture/film.hpp"

namespace hexaplast::output {

/// A film as animated PNG, repeated for ever. Of each picture only the rectangle is stored in which it differs from the
/// one before. The chunks are kept in memory until the film is finished, since the file begins with their number.
class AnimatedPng final : public Film {
 public:
  AnimatedPng(const std::filesystem::path& file, double frames_per_second);

  void add(const Image& image) override;
  void finish() override;

 private:
  WholeFile file_;
  double frames_per_second_;
  Image latest_;
  std::uint32_t num_frames_ = 0, num_numbered_ = 0;  // frames; chunks that carry a sequence number
  std::string chunks_;
};

}  // namespace hexaplast::output
