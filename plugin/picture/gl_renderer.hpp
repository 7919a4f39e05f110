// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>

#include "picture/renderer.hpp"

namespace hexaplast::output {

/// Where OpenGL draws pictures. Each back end is a module of its own, with the renderer (gl_renderer.cpp) in it.
class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;  ///< OpenGL 3.3, core. Throws RendererUnavailable.
};

/// The back end of the module that it is linked into. Throws RendererUnavailable.
std::unique_ptr<Context> make_context();

}  // namespace hexaplast::output
