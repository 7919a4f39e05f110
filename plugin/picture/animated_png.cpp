// SPDX-License-Identifier: LGPL-2.1-or-later
// Animated PNG: a PNG file with an acTL chunk in front and, for every picture, an fcTL chunk and its data; those of the
// first picture are the PNG's own IDAT, those of the others fdAT. All numbers are big-endian.
#include "picture/animated_png.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hexaplast::output {
namespace {

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

struct Rectangle {
  int left = 0, top = 0, width = 1, height = 1;
};

/// Where two pictures of one size differ; where they do not, one pixel.
Rectangle difference(const Image& before, const Image& now) {
  int left = now.width, right = -1, top = now.height, bottom = -1;
  for (int y = 0; y < now.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * now.width * kBytes;
    const auto first = now.pixels.begin() + static_cast<std::ptrdiff_t>(row), last = first + now.width * kBytes;
    const auto from = std::mismatch(first, last, before.pixels.begin() + static_cast<std::ptrdiff_t>(row)).first;
    if (from == last) continue;
    const auto to = std::mismatch(std::make_reverse_iterator(last), std::make_reverse_iterator(first),
                                  before.pixels.rbegin() +
                                      static_cast<std::ptrdiff_t>(now.pixels.size() - row - now.width * kBytes))
                        .first;
    left = std::min(left, static_cast<int>(from - first) / kBytes);
    right = std::max(right, static_cast<int>(to.base() - first - 1) / kBytes);
    top = std::min(top, y);
    bottom = y;
  }
  if (right < 0) return {};
  return {left, top, right - left + 1, bottom - top + 1};
}

/// The pixels of a rectangle as the data of a PNG.
std::string compressed(const Image& image, const Rectangle& part) {
  std::string rows;
  rows.reserve(static_cast<std::size_t>(part.height) * (part.width * kBytes + 1));
  for (int y = part.top; y < part.top + part.height; ++y) {
    const std::uint8_t* row = &image.pixels[(static_cast<std::size_t>(y) * image.width + part.left) * kBytes];
    rows.push_back(kFilterSub);
    for (int i = 0; i < part.width * kBytes; ++i)
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

}  // namespace

AnimatedPng::AnimatedPng(const std::filesystem::path& file, double frames_per_second)
    : file_(file), frames_per_second_(frames_per_second) {}

void AnimatedPng::add(const Image& image) {
  const bool is_first = num_frames_ == 0;
  const Rectangle part = is_first ? Rectangle{0, 0, image.width, image.height} : difference(latest_, image);
  const auto delay = std::clamp(std::lround(kTick / frames_per_second_), 1L, 65535L);
  const auto number = [](int value) { return big_endian(static_cast<std::uint32_t>(value)); };
  chunks_ += chunk("fcTL", big_endian(num_numbered_++) + number(part.width) + number(part.height) + number(part.left) +
                               number(part.top) + big_endian(static_cast<std::uint32_t>(delay), 2) +
                               big_endian(kTick, 2) + std::string(2, '\0'));  // left as it is, then written over
  const std::string data = compressed(image, part);
  chunks_ += is_first ? chunk("IDAT", data) : chunk("fdAT", big_endian(num_numbered_++) + data);
  ++num_frames_;
  latest_ = image;
}

void AnimatedPng::finish() {
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
