// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <vector>

#include "picture/ink.hpp"
#include "picture/renderer.hpp"

namespace hexaplast::output {

/// A rectangle of the frame [pixels], from its lower left corner as OpenGL counts.
struct Viewport {
  int left = 0, bottom = 0, width = 1, height = 1;
  float density = 1;  ///< pixels per unit of the page
};

/// Draws with OpenGL 3.3 (core) into the frame that is bound, in the current context, which must outlive it.
class Painter {
 public:
  /// Throws RendererUnavailable when the graphics driver refuses a program.
  explicit Painter(Light light);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Empties the frame, and draws a view in a part of it.
  void draw(const View& view, const Viewport& viewport);

  /// Draws what lies in the plane of a picture: over its view, which is drawn, or on empty paper. density: samples per
  /// pixel and direction.
  void draw_page(const Drawing& page, int density);

  /// The lower left part of the frame that is bound.
  static Image read(int width, int height);

 private:
  struct Batch {
    unsigned array = 0, buffer = 0;
  };

  /// How a surface is lit.
  enum Lit { kUnlit, kTissue, kThing };

  // Triangles step back by this and by what they slope over half a line, so that lines lie in front over their full
  // width.
  static constexpr float kPushUnits = 16;

  void send_colours(const std::vector<Colour>& palette);
  void draw_shadow(const Geometry& geometry, const Eigen::Matrix4f& seen);

  // layers of a view, in their order
  void draw_behind(const Geometry& geometry, float density);
  void draw_body(const View& view, bool has_lines);
  void draw_tools(const View& view);
  void draw_marks(const View& view, const std::optional<EdgeInk>& edges, float density);
  void draw_veil(const Geometry& geometry);

  void draw_lit(const Geometry::Vertices& vertices, Lit how, const Colour* paint, float opacity_of_paint = 1);
  void draw_arrows(const Geometry::Vertices& arrows, const Colour& colour, float scale);
  void draw_within(const Geometry& geometry, std::initializer_list<const Geometry::Vertices*> closed,
                   const Eigen::AlignedBox3f& room, const std::function<void()>& draw_cap);
  void draw_corners(const Geometry::Vertices& vertices);
  void draw_lines(const Geometry::Places& ends, const Colour& colour, float opacity, float width);
  void draw_places(const Geometry::Places& places, unsigned mode, const Colour& colour, float opacity = 1);

  Light light_;
  unsigned surface_ = 0, flat_ = 0;  // programs
  Batch vertices_, places_, page_;
  unsigned numbers_ = 0;                    // of those of vertices_ that are drawn
  unsigned colours_ = 0;                    // texture: the colour scale, or
  std::vector<Colour> palette_;             // of a view
  unsigned shadow_ = 0, shadow_frame_ = 0;  // texture: depths from the lamp, and the frame that is drawn to
};

}  // namespace hexaplast::output
