// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/film.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

// Animated PNG: a PNG file with an acTL chunk in front and, for every picture, an fcTL chunk and its data; those of the
// first picture are the PNG's own IDAT, those of the others fdAT. All numbers are big-endian.

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

const fs::path& named(const fs::path& file) {
  if (const std::string refusal = refusal_of_film(file); !refusal.empty()) throw InputError(refusal);
  return file;
}

}  // namespace

std::string refusal_of_film(const fs::path& file) {
  const fs::path ending = file.extension();
  if (ending == ".png" || ending == ".apng") return "";
  return fmt::format(
      "{}: a film's name must end in .png or .apng; others are made of it by ffmpeg -i film.png -pix_fmt yuv420p "
      "film.mp4",
      file.string());
}

Film::Film(const fs::path& file, double frames_per_second)
    : file_(named(file)), frames_per_second_(frames_per_second) {}

void Film::add(const Image& image) {
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

void Film::finish() {
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

}  // namespace hexaplast::output
