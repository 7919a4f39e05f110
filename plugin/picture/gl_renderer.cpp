// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/gl_renderer.hpp"

#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "formats/text.hpp"
#include "picture/painter.hpp"

namespace hexaplast::output {
namespace {

constexpr int kOversampling = 3;  // per direction: nine samples a pixel
constexpr int kBand = 120;        // [pixels] that are drawn at a time, so that their samples stay in caches

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

  /// unit: [pixels] of the text's place and size
  void draw(const Drawing::Text& text, float unit, Image& image) {
    FT_Set_Char_Size(face_, 0, std::lround(text.size * unit * kUnits), 72, 72);
    const std::u32string letters = decoded(text.words);
    const double fraction = text.align == Drawing::Align::kLeft ? 0 : text.align == Drawing::Align::kCentre ? 0.5 : 1;
    double pen = text.x * unit - fraction * width(letters);
    for (const char32_t letter : letters) {
      // whole pixels move the bitmap, the rest moves the outline, so that letters keep their even distances
      FT_Vector rest{std::lround((pen - std::floor(pen)) * kUnits), 0};
      FT_Set_Transform(face_, nullptr, &rest);
      if (FT_Load_Char(face_, letter, FT_LOAD_NO_HINTING | FT_LOAD_RENDER) != 0) continue;
      const FT_GlyphSlot glyph = face_->glyph;
      blend(glyph->bitmap, static_cast<int>(std::floor(pen)) + glyph->bitmap_left,
            static_cast<int>(std::lround(text.y * unit)) - glyph->bitmap_top, text.colour, image);
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

  /// Code points of UTF-8; a broken byte shows as the replacement sign.
  static std::u32string decoded(std::string_view words) {
    std::u32string letters;
    for (std::size_t length = 0; !words.empty(); words.remove_prefix(std::max<std::size_t>(length, 1))) {
      length = utf8_length(words, 0);
      letters.push_back(length == 0 ? U'\uFFFD' : code_point(words.substr(0, length)));
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

/// Rows of pixels: means of their samples, which are those of the frame that is bound.
void average(int top, int rows, Image& image) {
  constexpr std::size_t kOver = kOversampling, kChannels = 4;
  const std::size_t across = static_cast<std::size_t>(image.width) * kOver * kChannels;
  std::vector<std::uint8_t> samples(across * kOver);
  std::vector<std::uint16_t> sums(across);  // of the samples below one another
  std::uint8_t* pixel = &image.pixels[static_cast<std::size_t>(top) * image.width * 3];
  for (int y = rows - 1; y >= 0; --y) {  // OpenGL counts rows from below
    glReadPixels(0, y * kOversampling, image.width * kOversampling, kOversampling, GL_RGBA, GL_UNSIGNED_BYTE,
                 samples.data());
    for (std::size_t s = 0; s < across; ++s)
      sums[s] = static_cast<std::uint16_t>(samples[s] + samples[across + s] + samples[2 * across + s]);
    for (const std::uint16_t* sum = sums.data(); sum != sums.data() + across; sum += kOver * kChannels)
      for (std::size_t c = 0; c < 3; ++c) {
        const int all = sum[c] + sum[kChannels + c] + sum[2 * kChannels + c];
        *pixel++ =
            static_cast<std::uint8_t>((all + kOversampling * kOversampling / 2) / (kOversampling * kOversampling));
      }
  }
}

/// A frame of OpenGL that is no screen's.
class Frame {
 public:
  Frame() {
    glGenFramebuffers(1, &frame_);
    glGenRenderbuffers(2, buffers_.data());
  }
  ~Frame() {
    glDeleteFramebuffers(1, &frame_);
    glDeleteRenderbuffers(2, buffers_.data());
  }
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;

  /// Binds it. Throws RendererUnavailable when it is too large.
  void bind(int width, int height) {
    glBindFramebuffer(GL_FRAMEBUFFER, frame_);
    if (size_ == std::array{width, height}) return;
    size_ = {};  // until the new one is accepted
    constexpr std::array<GLenum, 2> kFormats{GL_RGBA8, GL_DEPTH24_STENCIL8},
        kTargets{GL_COLOR_ATTACHMENT0, GL_DEPTH_STENCIL_ATTACHMENT};
    for (std::size_t k = 0; k < 2; ++k) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffers_[k]);
      glRenderbufferStorage(GL_RENDERBUFFER, kFormats[k], width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, kTargets[k], GL_RENDERBUFFER, buffers_[k]);
    }
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR)
      throw RendererUnavailable(fmt::format("OpenGL refuses a frame of {} x {} pixels", width, height));
    size_ = {width, height};
  }

 private:
  std::array<int, 2> size_{};  // [pixels]
  unsigned frame_ = 0;
  std::array<unsigned, 2> buffers_{};  // colour, and depth with stencil
};

/// Triangles and lines by OpenGL at thrice the size, averaged down; then text by FreeType.
class GlRenderer final : public Renderer {
 public:
  explicit GlRenderer(Light light) : painter_(light) {}
  ~GlRenderer() override {
    context_->make_current();  // for what is deleted in it
  }

  Image render(const Drawing& drawing) override {
    context_->make_current();
    const int width = drawing.width * kOversampling, height = drawing.height * kOversampling;
    Image image{drawing.width, drawing.height, {}};
    image.pixels.resize(static_cast<std::size_t>(drawing.width) * drawing.height * 3);
    for (int top = 0; top < drawing.height; top += kBand) {
      const int rows = std::min(kBand, drawing.height - top), bottom = (drawing.height - top - rows) * kOversampling;
      frame_.bind(width, std::min(kBand, drawing.height) * kOversampling);
      glViewport(0, -bottom, width, height);
      if (drawing.view)
        painter_.draw(*drawing.view, {0, -bottom, width, height, static_cast<float>(width) / drawing.view->width});
      painter_.draw_page(drawing, kOversampling);
      average(top, rows, image);
    }
    for (const Drawing::Text& text : drawing.texts) (text.bold ? bold_ : regular_).draw(text, drawing.unit, image);
    return image;
  }

 private:
  static std::unique_ptr<Context> current_context() {
    std::unique_ptr<Context> context = make_context();
    context->make_current();
    return context;
  }

  Fonts fonts_ = open_fonts();
  Typeface regular_{fonts_.get(), HEXAPLAST_FONT_DIRECTORY "/DejaVuSans.ttf"};
  Typeface bold_{fonts_.get(), HEXAPLAST_FONT_DIRECTORY "/DejaVuSans-Bold.ttf"};
  std::unique_ptr<Context> context_ = current_context();
  Painter painter_;
  Frame frame_;
};

}  // namespace
}  // namespace hexaplast::output

/// Gives away a new renderer. Its name, set by the build, carries the version of the Renderer interface.
extern "C" __attribute__((visibility("default"))) hexaplast::output::Renderer* HEXAPLAST_RENDER_ENTRY(
    hexaplast::output::Light light) {
  return std::make_unique<hexaplast::output::GlRenderer>(light).release();
}
