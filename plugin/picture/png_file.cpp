// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/png_file.hpp"

#include <png.h>

#include <csetjmp>

#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast::output {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(png_structp png, png_bytep data, png_size_t count) {
  auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), data, data + count);
}

/// libpng leaves by longjmp: nothing that needs a destructor may live in this function.
bool encode(const Image& image, Bytes& bytes) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_compression_level(png, 1);  // drawings are flat: higher levels cost time and gain little
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_IHDR(png, info, image.width, image.height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) png_write_row(png, image.pixels.data() + 3l * image.width * y);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image) {
  Bytes bytes;
  if (!encode(image, bytes)) throw OutputError(file.string() + ": libpng cannot encode the picture");
  WholeFile out(file);
  out.write(bytes.data(), bytes.size());
  out.commit();
}

}  // namespace hexaplast::output
