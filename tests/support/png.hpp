// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <png.h>

#include <filesystem>

#include "picture/renderer.hpp"

namespace hexaplast::support {

/// Empty where there is no such picture.
inline output::Image read_png(const std::filesystem::path& file) {
  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&read, file.c_str())) return {};
  read.format = PNG_FORMAT_RGB;
  output::Image image{static_cast<int>(read.width), static_cast<int>(read.height),
                      std::vector<std::uint8_t>(PNG_IMAGE_SIZE(read))};
  png_image_finish_read(&read, nullptr, image.pixels.data(), 0, nullptr);
  return image;
}

}  // namespace hexaplast::support
