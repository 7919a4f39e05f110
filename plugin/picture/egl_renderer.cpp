// SPDX-License-Identifier: LGPL-2.1-or-later
// The renderer module on EGL without a surface: a graphics driver, or Mesa's rasteriser where OSMesa is no longer
// packaged.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <algorithm>

#include "picture/gl_renderer.hpp"

namespace hexaplast::output {
namespace {

class EglRenderer final : public GlRenderer {
 public:
  EglRenderer() : display_(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)) {
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr))
      throw RendererUnavailable("EGL gives no display without a surface");
    constexpr EGLint kNone[] = {EGL_NONE};
    if (eglBindAPI(EGL_OPENGL_API)) context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kNone);
    if (context_ == EGL_NO_CONTEXT) {
      eglTerminate(display_);
      throw RendererUnavailable(fmt::format("EGL gives no OpenGL context (error {:#x})", eglGetError()));
    }
  }
  ~EglRenderer() override {
    if (frame_ != 0) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
      glDeleteFramebuffers(1, &frame_);
      glDeleteRenderbuffers(2, buffers_);
    }
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }

 private:
  void begin(int width, int height) override {
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw RendererUnavailable(fmt::format("EGL refuses its context (error {:#x})", eglGetError()));
    if (frame_ == 0) {
      glGenFramebuffers(1, &frame_);
      glGenRenderbuffers(2, buffers_);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, frame_);
    constexpr GLenum kFormats[] = {GL_RGBA8, GL_DEPTH_COMPONENT24},
                     kPlaces[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int k = 0; k < 2; ++k) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffers_[k]);
      glRenderbufferStorage(GL_RENDERBUFFER, kFormats[k], width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, kPlaces[k], GL_RENDERBUFFER, buffers_[k]);
    }
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw RendererUnavailable(fmt::format("EGL refuses a picture of {} x {} samples", width, height));
  }

  void end(int width, int height) override {
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, samples_.data());
    const std::size_t row = static_cast<std::size_t>(width) * 4;  // OpenGL begins with the lowest
    for (int low = 0, high = height - 1; low < high; ++low, --high) {
      const auto lower = samples_.begin() + static_cast<std::ptrdiff_t>(low * row);
      std::swap_ranges(lower, lower + static_cast<std::ptrdiff_t>(row),
                       samples_.begin() + static_cast<std::ptrdiff_t>(high * row));
    }
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  GLuint frame_ = 0, buffers_[2] = {0, 0};  // colour and depth
};

}  // namespace

std::unique_ptr<Renderer> make_renderer() { return std::make_unique<EglRenderer>(); }

}  // namespace hexaplast::output
