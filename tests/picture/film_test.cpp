// SPDX-License-Identifier: LGPL-2.1-or-later
// Films: what was put in comes out again, and what goes wrong is said.
#include "picture/film.hpp"

#include <png.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cstdlib>

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
  const auto film = output::open_film(file, 12.5);
  constexpr int kCount = 5;
  for (int k = 0; k < kCount; ++k) film->add(picture(k));
  film->add(picture(kCount - 1));  // nothing moves
  EXPECT_FALSE(fs::exists(file)) << "before it is whole";
  film->finish();

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
  const auto film = output::open_film(file, 25);
  for (int k = 0; k < 3; ++k) film->add(picture(k));
  film->finish();
  EXPECT_EQ(support::read_png(file).pixels, picture(0).pixels);
}

TEST(Film, LeavesNothingWhereItIsNotFinished) {
  const Scratch scratch;
  support::put(scratch / "film.png", "older");
  output::open_film(scratch / "film.png", 25)->add(picture(0));
  EXPECT_EQ(content(scratch / "film.png"), "older");
  EXPECT_FALSE(fs::exists(scratch / "film.png.part"));
  EXPECT_TRUE(refuses<OutputError>([&] { output::open_film(scratch / "nowhere" / "film.png", 25); }, {"nowhere"}));
  EXPECT_TRUE(refuses<InputError>([&] { output::open_film(scratch / "film.gif", 25); }, {".mp4, .png or .apng"}));
}

/// A PATH on which ffmpeg is a script of ours.
class FfmpegFilm : public testing::Test {
 protected:
  FfmpegFilm() : path_(std::getenv("PATH")) {}
  ~FfmpegFilm() override { ::setenv("PATH", path_.c_str(), 1); }

  void install(const std::string& script) {
    support::put(scratch_ / "ffmpeg", "#!/bin/sh\n" + script);
    ::chmod((scratch_ / "ffmpeg").c_str(), 0755);
    ::setenv("PATH", (scratch_ / "").c_str(), 1);
  }

  const Scratch scratch_;
  std::string path_;
};

TEST_F(FfmpegFilm, HandsOverRawPictures) {
  // the last word is the file to write; names with blanks and signs stay whole
  install("for word; do echo \"$word\" >> '" + (scratch_ / "words").string() + "'; last=$word; done\n" +
          "/bin/cat > \"$last\"\n");
  const fs::path file = scratch_ / "a film; $(touch x) 'of' 2.mp4";
  const auto film = output::open_film(file, 12.5);
  std::string pixels;
  for (int k = 0; k < 3; ++k) {
    film->add(picture(k));
    pixels.append(reinterpret_cast<const char*>(picture(k).pixels.data()), picture(k).pixels.size());
  }
  film->finish();
  EXPECT_EQ(content(file), pixels);
  const std::string words = content(scratch_ / "words");
  for (const char* words_in_order :
       {"-f\nrawvideo\n-pixel_format\nrgb24\n-video_size\n37x23\n-framerate\n12.5\n-i\n", "-f\nmp4\n"})
    EXPECT_NE(words.find(words_in_order), std::string::npos) << words;
}

// Somebody else's link under the name of the unfinished film leads nowhere: the program is handed the file, not a name.
TEST_F(FfmpegFilm, IsWrittenIntoItsOwnFileAlone) {
  install("for last; do :; done\n/bin/cat > \"$last\"\n");
  const fs::path file = scratch_ / "film.mp4", part = scratch_ / "film.mp4.part", victim = scratch_ / "victim";
  support::put(victim, "mine");
  const auto film = output::open_film(file, 25);
  fs::remove(part);
  fs::create_symlink(victim, part);
  film->add(picture(0));
  EXPECT_TRUE(refuses<OutputError>([&] { film->finish(); }, {"film.mp4.part", "has been taken away"}));
  EXPECT_EQ(content(victim), "mine");
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(FfmpegFilm, SaysWhatFfmpegSays) {
  install("/bin/cat > /dev/null\necho first >&2\necho 'Unknown encoder' >&2\nexit 7\n");
  const fs::path file = scratch_ / "film.mp4";
  const auto film = output::open_film(file, 25);
  film->add(picture(0));
  EXPECT_TRUE(refuses<OutputError>([&] { film->finish(); }, {"film.mp4", "ffmpeg ended with code 7: Unknown encoder"}));
  EXPECT_FALSE(fs::exists(file));
}

// The pipe breaks while pictures are still coming: no signal, but the reason.
TEST_F(FfmpegFilm, SurvivesItsEarlyEnd) {
  install("echo 'no space' >&2\nexit 3\n");
  const auto film = output::open_film(scratch_ / "film.mp4", 25);
  const Image large{1000, 1000, std::vector<std::uint8_t>(3'000'000, 99)};
  EXPECT_TRUE(refuses<OutputError>(
      [&] {
        for (int k = 0; k < 10; ++k) film->add(large);
      },
      {"ffmpeg ended with code 3: no space"}));
}

TEST_F(FfmpegFilm, IsRefusedWhereThereIsNone) {
  ::setenv("PATH", (scratch_ / "empty").c_str(), 1);
  EXPECT_TRUE(refuses<OutputError>([&] { output::open_film(scratch_ / "film.mp4", 25); }, {"ffmpeg", "PATH", ".png"}));
}

// The program itself, where it is installed.
TEST(Ffmpeg, MakesAFilm) {
  if (std::system("command -v ffmpeg > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  const Scratch scratch;
  const auto film = output::open_film(scratch / "film.mp4", 25);
  for (int k = 0; k < 5; ++k) film->add(picture(k));
  film->finish();
  EXPECT_EQ(content(scratch / "film.mp4").substr(4, 4), "ftyp");
}

}  // namespace
}  // namespace hexaplast
