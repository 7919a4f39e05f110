// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "picture/colour_map.hpp"
#include "picture/geometry.hpp"

namespace hexaplast::output {

/// sRGB pixels, 3 bytes each, rows from top to bottom.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< height x width x 3
};

/// What a picture consists of: bodies in space, and before them what is drawn in the plane of the image, in units of a
/// page: x to the right, y downwards, from its upper left corner.
struct Drawing {
  struct Vertex {
    float x = 0, y = 0;
    float depth = 0;  ///< in [0, 1]; the smaller is nearer and hides what lies behind it in the plane
    Colour colour;    ///< blended between the vertices
  };
  struct Triangle {
    Vertex corner[3];  ///< in any order: both sides are seen
  };
  struct Line {
    Vertex from, to;
    float width = 1;
    float opacity = 1;  ///< below 1, what lies behind shines through; such a line is seen, and hides nothing
  };
  enum class Align { kLeft, kCentre, kRight };
  struct Text {
    float x = 0, y = 0;  ///< the reference point on the base line
    float size = 16;     ///< of the font's em square
    Align align = Align::kLeft;
    bool bold = false;
    Colour colour;
    std::string words;  ///< UTF-8, one line
  };

  int width = 0;                          ///< [pixels]
  int height = 0;                         ///< [pixels]
  float unit = 1;                         ///< [pixels] of all coordinates, widths and sizes
  std::shared_ptr<const View> view = {};  ///< null: nothing stands behind the rest
  std::vector<Triangle> triangles;
  std::vector<Line> lines;  ///< at equal depth in front of the triangles
  std::vector<Text> texts;  ///< over everything else
};

/// The light on bodies: that of a hemisphere, as far as they do not keep it from each other.
enum class Light {
  kVertices,  ///< what the vertices of a view say that they receive (light_up)
  kLamp       ///< an even sky without shadows, and the main lamp, which lights every pixel
};

/// No pictures can be made here; the message says what is missing.
class RendererUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Turns drawings into anti-aliased pixels. Equal drawings give equal pixels.
class Renderer {
 public:
  virtual ~Renderer() = default;

  /// Throws RendererUnavailable when the back end refuses the size or runs out of memory.
  virtual Image render(const Drawing& drawing) = 0;
};

/// How a renderer is come by; asked once, when the first picture is wanted. Throws RendererUnavailable.
using RendererSource = std::function<std::unique_ptr<Renderer>()>;

/// Where OpenGL draws.
enum class Backend {
  kAny,     ///< OSMesa, and EGL where that is missing
  kOsmesa,  ///< Mesa's rasteriser in memory
  kEgl      ///< EGL without a surface: a graphics driver, or Mesa's rasteriser
};

/// An off-screen renderer (OpenGL and FreeType), loaded from a module so that nothing else depends on its libraries.
/// directory: where the modules lie. Throws RendererUnavailable with the loader's reason.
std::unique_ptr<Renderer> load_renderer(const std::filesystem::path& directory, Backend backend = Backend::kAny,
                                        Light light = Light::kVertices);

/// The same from its place beside this library.
std::unique_ptr<Renderer> load_renderer(Backend backend = Backend::kAny, Light light = Light::kVertices);

}  // namespace hexaplast::output
