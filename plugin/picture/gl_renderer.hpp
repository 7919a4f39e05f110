// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Triangles and lines by OpenGL at three times the size, averaged down; then text by FreeType. Where OpenGL draws is
/// the back end's: each is a module of its own with this in it.
class GlRenderer : public Renderer {
 public:
  ~GlRenderer() override;
  Image render(const Drawing& drawing) override;

 protected:
  GlRenderer();  ///< Throws RendererUnavailable when the fonts cannot be read.

  /// Makes a frame of this size current. Throws RendererUnavailable when it cannot.
  virtual void begin(int width, int height) = 0;

  /// Leaves the frame in `samples_`.
  virtual void end(int width, int height) = 0;

  std::vector<std::uint8_t> samples_;  ///< RGBA, the rows from top to bottom

 private:
  struct Letters;
  std::unique_ptr<Letters> letters_;
};

/// The back end of the module that it is linked into. Throws RendererUnavailable.
std::unique_ptr<Renderer> make_renderer();

}  // namespace hexaplast::output
