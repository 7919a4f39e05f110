// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/renderer.hpp"

#include <dlfcn.h>

namespace hexaplast::output {
namespace fs = std::filesystem;

namespace {

std::unique_ptr<Renderer> load_module(const fs::path& file, Light light) {
  // The module stays loaded for the life of the process: its graphics library keeps threads that cannot be unloaded.
  void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) throw RendererUnavailable(std::string("the renderer cannot be loaded: ") + ::dlerror());
  void* symbol = ::dlsym(module, HEXAPLAST_RENDER_ENTRY);
  if (!symbol) throw RendererUnavailable(file.string() + ": belongs to another version of Hexaplast");
  return std::unique_ptr<Renderer>(reinterpret_cast<Renderer* (*)(Light)>(symbol)(light));
}

}  // namespace

std::unique_ptr<Renderer> load_renderer(const fs::path& directory, Backend backend, Light light) {
  const fs::path osmesa = directory / HEXAPLAST_RENDER_MODULE, egl = directory / HEXAPLAST_EGL_RENDER_MODULE;
  if (backend == Backend::kEgl) return load_module(egl, light);
  try {
    return load_module(osmesa, light);
  } catch (const RendererUnavailable& reason) {
    if (backend == Backend::kOsmesa) throw;
    try {
      return load_module(egl, light);
    } catch (const RendererUnavailable&) {
      throw reason;  // the one that people expect to be there
    }
  }
}

std::unique_ptr<Renderer> load_renderer(Backend backend, Light light) {
  Dl_info here{};
  if (::dladdr(reinterpret_cast<void*>(&colour_of), &here) == 0 || !here.dli_fname)
    throw RendererUnavailable("the renderer cannot be found: the place of this library is not known");
  return load_renderer(fs::absolute(here.dli_fname).parent_path() / HEXAPLAST_RENDER_DIRECTORY, backend, light);
}

}  // namespace hexaplast::output
