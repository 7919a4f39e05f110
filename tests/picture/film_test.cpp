// SPDX-License-Identifier: LGPL-2.1-or-later
// Films: what was put in comes out again, and what goes wrong is said.
#include "picture/film.hpp"

#include <png.h>
#include <zlib.h>

#include "hexaplast/base/error.hpp"
#include "support/compare.hpp"
#include "support/output.hpp"
#include "support/png.hpp"

namespace hexaplast {
namespace {

namespace fs = std::filesystem;
using output::Image;
using output::OutputError;
using support::content;
using support::refuses;
using support::Scratch;

/// A picture with a little square that moves over a background of many colours.
Image picture(int moment) {
  Image image{37, 23, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const bool in_square = x >= 3 * moment && x < 3 * moment + 5 && y >= 2 * moment && y < 2 * moment + 4;
      for (int c = 0; c < 3; ++c)
        image.pixels.push_back(in_square ? static_cast<std::uint8_t>(40 * c + moment)
                                         : static_cast<std::uint8_t>((x * x + 7 * y + 50 * c) % 251));
    }
  return image;
}

// An own reading of the format
// -------------------------------------------------------------------------------------------------------------------

std::uint32_t number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

std::string four_bytes(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift));
  return bytes;
}

/// The checksum of chunks.
std::uint32_t checksum(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

struct Chunk {
  std::string type, data;
};

std::vector<Chunk> chunks_of(const std::string& file) {
  EXPECT_EQ(file.substr(0, 8), std::string("\x89PNG\r\n\x1a\n", 8));
  std::vector<Chunk> chunks;
  for (std::size_t at = 8; at < file.size();) {
    const std::uint32_t size = number(file.substr(at, 4));
    const std::string body = file.substr(at + 4, size + 4);
    EXPECT_EQ(number(file.substr(at + 8 + size, 4)), checksum(body)) << body.substr(0, 4);
    chunks.push_back({body.substr(0, 4), body.substr(4)});
    at += size + 12;
  }
  return chunks;
}

/// The pixels of data that stand for a PNG of a size of its own, by libpng.
Image decoded(std::uint32_t width, std::uint32_t height, const std::string& data) {
  const auto chunk = [](const std::string& type, const std::string& bytes) {
    return four_bytes(static_cast<std::uint32_t>(bytes.size())) + type + bytes + four_bytes(checksum(type + bytes));
  };
  const std::string png = std::string("\x89PNG\r\n\x1a\n", 8) +
                          chunk("IHDR", four_bytes(width) + four_bytes(height) + std::string("\x08\x02\0\0\0", 5)) +
                          chunk("IDAT", data) + chunk("IEND", "");
  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&read, png.data(), png.size())) << read.message;
  read.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(width), static_cast<int>(height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(read))};
  EXPECT_TRUE(png_image_finish_read(&read, nullptr, image.pixels.data(), 0, nullptr)) << read.message;
  return image;
}

TEST(AnimatedPng, GivesBackEveryPictureAndItsTime) {
  const Scratch scratch;
  const fs::path file = scratch / "film.png";
  output::Film film(file, 12.5);
  constexpr int kCount = 5;
  for (int k = 0; k < kCount; ++k) film.add(picture(k));
  film.add(picture(kCount - 1));  // nothing moves
  EXPECT_FALSE(fs::exists(file)) << "before it is whole";
  film.finish();

  const std::vector<Chunk> chunks = chunks_of(content(file));
  ASSERT_EQ(chunks[0].type, "IHDR");
  ASSERT_EQ(chunks[1].type, "acTL");
  EXPECT_EQ(number(chunks[1].data.substr(0, 4)), 6u);
  EXPECT_EQ(number(chunks[1].data.substr(4)), 0u) << "for ever";
  EXPECT_EQ(chunks.back().type, "IEND");

  Image canvas{37, 23, std::vector<std::uint8_t>(37 * 23 * 3)};
  std::uint32_t sequence = 0;
  int moment = 0;
  for (std::size_t k = 2; k + 1 < chunks.size(); k += 2, ++moment) {
    const std::string& control = chunks[k].data;
    ASSERT_EQ(chunks[k].type, "fcTL");
    EXPECT_EQ(number(control.substr(0, 4)), sequence++);
    const std::uint32_t width = number(control.substr(4, 4)), height = number(control.substr(8, 4)),
                        left = number(control.substr(12, 4)), top = number(control.substr(16, 4));
    EXPECT_DOUBLE_EQ(number(control.substr(20, 2)) / static_cast<double>(number(control.substr(22, 2))), 0.08);
    EXPECT_EQ(control.substr(24), std::string(2, '\0'));
    std::string data = chunks[k + 1].data;
    if (moment == 0) {
      EXPECT_EQ(chunks[k + 1].type, "IDAT");
    } else {
      EXPECT_EQ(chunks[k + 1].type, "fdAT");
      EXPECT_EQ(number(data.substr(0, 4)), sequence++);
      data.erase(0, 4);
      EXPECT_LE(width, 8u) << "only what has changed";
      EXPECT_LE(height, 6u);
    }
    const Image part = decoded(width, height, data);
    for (std::uint32_t y = 0; y < height; ++y)
      std::copy_n(&part.pixels[3 * width * y], 3 * width, &canvas.pixels[3 * ((top + y) * 37 + left)]);
    EXPECT_EQ(canvas.pixels, picture(std::min(moment, kCount - 1)).pixels) << moment;
  }
  EXPECT_EQ(moment, 6);
}

TEST(AnimatedPng, IsAPictureToWhoKnowsNoAnimation) {
  const Scratch scratch;
  const fs::path file = scratch / "film.apng";
  output::Film film(file, 25);
  for (int k = 0; k < 3; ++k) film.add(picture(k));
  film.finish();
  EXPECT_EQ(support::read_png(file).pixels, picture(0).pixels);
}

TEST(Film, LeavesNothingWhereItIsNotFinished) {
  const Scratch scratch;
  support::put(scratch / "film.png", "older");
  output::Film(scratch / "film.png", 25).add(picture(0));
  EXPECT_EQ(content(scratch / "film.png"), "older");
  EXPECT_FALSE(fs::exists(scratch / "film.png.part"));
  EXPECT_TRUE(refuses<OutputError>([&] { output::Film(scratch / "nowhere" / "film.png", 25); }, {"nowhere"}));
  EXPECT_TRUE(refuses<InputError>([&] { output::Film(scratch / "film.mp4", 25); }, {".png or .apng", "ffmpeg -i"}));
}

}  // namespace
}  // namespace hexaplast
