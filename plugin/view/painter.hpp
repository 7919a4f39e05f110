// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "picture/renderer.hpp"
#include "view/camera.hpp"
#include "view/figure.hpp"

namespace hexaplast::view {

/// A rectangle of the window [pixels], from its lower left corner as OpenGL counts.
struct Viewport {
  int left = 0, bottom = 0, width = 1, height = 1;
  float density = 1;  ///< pixels per unit of the camera
};

/// Draws figures with OpenGL 3.3 in the current context, which must outlive it.
class Painter {
 public:
  /// Throws OutputError when the graphics driver refuses a program.
  Painter();
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Fills the viewport. min, max: the values at the ends of the colour scale.
  void draw(const Figure& figure, const Camera& camera, const Viewport& viewport, double min, double max);

  /// What the whole window shows now.
  static output::Image picture(int width, int height);

 private:
  struct Batch {
    unsigned array = 0, buffer = 0;
  };

  void draw_triangles(const std::vector<Figure::Vertex>& corners);
  void draw_lines(const std::vector<Eigen::Vector3f>& ends, const Eigen::Vector4f& colour, float width);
  void draw_places(const std::vector<Eigen::Vector3f>& places, unsigned mode, const Eigen::Vector4f& colour,
                   float point_size = 1);

  unsigned surface_ = 0, flat_ = 0;  // programs
  Batch triangles_, places_;
  unsigned colours_ = 0;                    // texture: the colour scale
  unsigned shadow_ = 0, shadow_frame_ = 0;  // texture: depths from the lamp, and the frame that is drawn to
};

}  // namespace hexaplast::view
