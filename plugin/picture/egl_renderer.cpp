// SPDX-License-Identifier: LGPL-2.1-or-later
// The renderer module on EGL without a surface: a graphics driver, or Mesa's rasteriser where OSMesa is no longer
// packaged.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include "picture/gl_renderer.hpp"

namespace hexaplast::output {
namespace {

constexpr EGLint kAttributes[] = {
    EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};

class SurfacelessContext final : public Context {
 public:
  SurfacelessContext() : display_(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)) {
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr))
      throw RendererUnavailable("EGL gives no display without a surface");
    if (eglBindAPI(EGL_OPENGL_API))
      context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes);
    if (context_ == EGL_NO_CONTEXT) {
      const EGLint error = eglGetError();
      eglTerminate(display_);
      throw RendererUnavailable(fmt::format("EGL gives no context of OpenGL 3.3 (error {:#x})", error));
    }
  }
  ~SurfacelessContext() override {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }

  void make_current() override {
    // released first: EGL does not see that OSMesa made another context current, and would leave that
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw RendererUnavailable(fmt::format("EGL refuses its context (error {:#x})", eglGetError()));
  }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> make_context() { return std::make_unique<SurfacelessContext>(); }

}  // namespace hexaplast::output
