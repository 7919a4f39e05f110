// SPDX-License-Identifier: LGPL-2.1-or-later
// The renderer module that needs no graphics driver: Mesa's rasteriser in memory.
#include <GL/osmesa.h>

#include <array>
#include <cstdint>
#include <type_traits>

#include "picture/gl_renderer.hpp"

namespace hexaplast::output {
namespace {

constexpr int kAttributes[] = {
    OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0};

class MemoryContext final : public Context {
 public:
  MemoryContext() : context_(OSMesaCreateContextAttribs(kAttributes, nullptr), &OSMesaDestroyContext) {
    if (!context_) throw RendererUnavailable("OSMesa gives no drawing context");
  }

  void make_current() override {
    if (!OSMesaMakeCurrent(context_.get(), pixel_.data(), GL_UNSIGNED_BYTE, 1, 1))
      throw RendererUnavailable("OSMesa refuses its context");
  }

 private:
  std::array<std::uint8_t, 4> pixel_{};  // frames are made by the renderer
  std::unique_ptr<std::remove_pointer_t<OSMesaContext>, decltype(&OSMesaDestroyContext)> context_;
};

}  // namespace

std::unique_ptr<Context> make_context() { return std::make_unique<MemoryContext>(); }

}  // namespace hexaplast::output
