// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/png_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast::output {

void write_png(const std::filesystem::path& file, const Image& image) {
  png_image form{};
  form.version = PNG_IMAGE_VERSION;
  form.width = static_cast<png_uint_32>(image.width);
  form.height = static_cast<png_uint_32>(image.height);
  form.format = PNG_FORMAT_RGB;
  form.flags = PNG_IMAGE_FLAG_FAST;  // drawings are flat: more effort costs time and gains little
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(form), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&form, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr))
    throw OutputError(fmt::format("{}: libpng cannot encode the picture: {}", file.string(), form.message));
  WholeFile out(file);
  out.write(bytes.data(), size);
  out.commit();
}

}  // namespace hexaplast::output
