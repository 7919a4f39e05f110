// SPDX-License-Identifier: LGPL-2.1-or-later
// The renderer module that needs no graphics driver: Mesa's rasteriser in memory.
#include <GL/osmesa.h>
#include <fmt/format.h>

#include <type_traits>

#include "picture/gl_renderer.hpp"

namespace hexaplast::output {
namespace {

constexpr int kDepthBits = 24;

class OsmesaRenderer final : public GlRenderer {
 public:
  OsmesaRenderer() : context_(OSMesaCreateContextExt(OSMESA_RGBA, kDepthBits, 0, 0, nullptr), &OSMesaDestroyContext) {
    if (!context_) throw RendererUnavailable("OSMesa gives no drawing context");
  }

 private:
  void begin(int width, int height) override {
    if (!OSMesaMakeCurrent(context_.get(), samples_.data(), GL_UNSIGNED_BYTE, width, height))
      throw RendererUnavailable(fmt::format("OSMesa refuses a picture of {} x {} samples", width, height));
    OSMesaPixelStore(OSMESA_Y_UP, 0);
  }
  void end(int, int) override { glFinish(); }

  std::unique_ptr<std::remove_pointer_t<OSMesaContext>, decltype(&OSMesaDestroyContext)> context_;
};

}  // namespace

std::unique_ptr<Renderer> make_renderer() { return std::make_unique<OsmesaRenderer>(); }

}  // namespace hexaplast::output
