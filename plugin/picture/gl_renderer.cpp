// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/gl_renderer.hpp"

#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H
#include <GL/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace hexaplast::output {
namespace {

constexpr int kOversampling = 3;     // per direction: nine samples a pixel
constexpr float kPushSlope = 4.0f;   // triangles step back by this much of their slope, so that lines as wide as an
constexpr float kPushUnits = 16.0f;  // element edge lie in front of them over their full width

std::uint8_t byte(float fraction) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(fraction, 0.0f, 1.0f)));
}

/// Letters of one typeface.
class Typeface {
 public:
  Typeface(FT_Library library, const char* file) {
    if (FT_New_Face(library, file, 0, &face_) != 0)
      throw RendererUnavailable(fmt::format("the font {} cannot be read (Debian package fonts-dejavu-core)", file));
  }
  ~Typeface() { FT_Done_Face(face_); }
  Typeface(const Typeface&) = delete;
  Typeface& operator=(const Typeface&) = delete;

  void draw(const Drawing::Text& text, Image& image) {
    FT_Set_Char_Size(face_, 0, std::lround(text.size * kUnits), 72, 72);
    const std::u32string letters = decoded(text.words);
    const double fraction = text.align == Drawing::Align::kLeft ? 0 : text.align == Drawing::Align::kCentre ? 0.5 : 1;
    double pen = text.x - fraction * width(letters);
    for (const char32_t letter : letters) {
      // whole pixels move the bitmap, the rest moves the outline, so that letters keep their even distances
      FT_Vector rest{std::lround((pen - std::floor(pen)) * kUnits), 0};
      FT_Set_Transform(face_, nullptr, &rest);
      if (FT_Load_Char(face_, letter, FT_LOAD_NO_HINTING | FT_LOAD_RENDER) != 0) continue;
      const FT_GlyphSlot glyph = face_->glyph;
      blend(glyph->bitmap, static_cast<int>(std::floor(pen)) + glyph->bitmap_left,
            static_cast<int>(std::lround(text.y)) - glyph->bitmap_top, text.colour, image);
      pen += advance(glyph);
    }
  }

 private:
  static constexpr double kUnits = 64;  // of FreeType per pixel

  static double advance(FT_GlyphSlot glyph) { return static_cast<double>(glyph->linearHoriAdvance) / 65536; }

  double width(const std::u32string& letters) {
    double sum = 0;
    for (const char32_t letter : letters)
      if (FT_Load_Char(face_, letter, FT_LOAD_NO_HINTING) == 0) sum += advance(face_->glyph);
    return sum;
  }

  /// Code points of UTF-8; a broken sequence shows as the replacement sign.
  static std::u32string decoded(const std::string& words) {
    std::u32string letters;
    for (std::size_t i = 0; i < words.size();) {
      const auto first = static_cast<unsigned char>(words[i++]);
      const int more = first < 0x80   ? 0
                       : first < 0xC0 ? -1
                       : first < 0xE0 ? 1
                       : first < 0xF0 ? 2
                       : first < 0xF8 ? 3
                                      : -1;
      char32_t letter = more <= 0 ? first : first & (0x3F >> more);
      int missing = std::max(more, 0);
      for (; missing > 0 && i < words.size() && (words[i] & 0xC0) == 0x80; --missing)
        letter = letter << 6 | (static_cast<unsigned char>(words[i++]) & 0x3F);
      letters.push_back(more < 0 || missing > 0 ? U'\uFFFD' : letter);
    }
    return letters;
  }

  static void blend(const FT_Bitmap& mask, int left, int top, const Colour& colour, Image& image) {
    const std::array<float, 3> ink{colour.red, colour.green, colour.blue};
    for (int row = 0; row < static_cast<int>(mask.rows); ++row)
      for (int column = 0; column < static_cast<int>(mask.width); ++column) {
        const int x = left + column, y = top + row;
        if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
        const float cover = static_cast<float>(mask.buffer[row * mask.pitch + column]) / 255;
        std::uint8_t* pixel = &image.pixels[(static_cast<std::size_t>(y) * image.width + x) * 3];
        for (int c = 0; c < 3; ++c) pixel[c] = byte(static_cast<float>(pixel[c]) / 255 * (1 - cover) + ink[c] * cover);
      }
  }

  FT_Face face_ = nullptr;
};

using Fonts = std::unique_ptr<std::remove_pointer_t<FT_Library>, decltype(&FT_Done_FreeType)>;

Fonts open_fonts() {
  FT_Library library = nullptr;
  if (FT_Init_FreeType(&library) != 0) throw RendererUnavailable("FreeType cannot be started");
  return {library, &FT_Done_FreeType};
}

void emit(const Drawing::Vertex& vertex, float opacity) {
  glColor4f(vertex.colour.red, vertex.colour.green, vertex.colour.blue, opacity);
  glVertex3f(vertex.x, vertex.y, vertex.depth);
}

/// The mean of each pixel's samples.
Image averaged(const std::vector<std::uint8_t>& samples, int width, int height) {
  Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  const std::size_t row_of_samples = static_cast<std::size_t>(width) * kOversampling * 4;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int j = 0; j < kOversampling; ++j)
          for (int i = 0; i < kOversampling; ++i)
            sum += samples[(y * kOversampling + j) * row_of_samples + (x * kOversampling + i) * 4ul + c];
        constexpr int kCount = kOversampling * kOversampling;
        image.pixels[(static_cast<std::size_t>(y) * width + x) * 3 + c] =
            static_cast<std::uint8_t>((sum + kCount / 2) / kCount);
      }
  return image;
}

}  // namespace

struct GlRenderer::Letters {
  Fonts fonts = open_fonts();
  Typeface regular{fonts.get(), HEXAPLAST_FONT_DIRECTORY "/DejaVuSans.ttf"};
  Typeface bold{fonts.get(), HEXAPLAST_FONT_DIRECTORY "/DejaVuSans-Bold.ttf"};
};

GlRenderer::GlRenderer() : letters_(std::make_unique<Letters>()) {}
GlRenderer::~GlRenderer() = default;

Image GlRenderer::render(const Drawing& drawing) {
  const int width = drawing.width * kOversampling, height = drawing.height * kOversampling;
  samples_.resize(static_cast<std::size_t>(width) * height * 4);
  begin(width, height);
  glViewport(0, 0, width, height);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glOrtho(0, drawing.width, drawing.height, 0, 0, -1);  // y downwards; depth 0 near, 1 far
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_DITHER);
  glClearColor(drawing.background.red, drawing.background.green, drawing.background.blue, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(kPushSlope, kPushUnits);
  glBegin(GL_TRIANGLES);
  for (const Drawing::Triangle& triangle : drawing.triangles)
    for (const Drawing::Vertex& corner : triangle.corner) emit(corner, 1);
  glEnd();

  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);

  for (const Drawing::Line& line : drawing.lines) {
    glLineWidth(line.width * kOversampling);
    glDepthMask(line.opacity < 1 ? GL_FALSE : GL_TRUE);
    glBegin(GL_LINES);
    emit(line.from, line.opacity);
    emit(line.to, line.opacity);
    glEnd();
  }
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  end(width, height);

  Image image = averaged(samples_, drawing.width, drawing.height);
  for (const Drawing::Text& text : drawing.texts) (text.bold ? letters_->bold : letters_->regular).draw(text, image);
  return image;
}

}  // namespace hexaplast::output

/// Gives away a new renderer. Its name, set by the build, carries the version of the Renderer interface.
extern "C" __attribute__((visibility("default"))) hexaplast::output::Renderer* HEXAPLAST_RENDER_ENTRY() {
  return hexaplast::output::make_renderer().release();
}
