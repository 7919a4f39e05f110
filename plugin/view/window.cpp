// SPDX-License-Identifier: LGPL-2.1-or-later
// The window module: GLFW for the window and the mouse, Dear ImGui for what is written and moved by hand, OpenGL for
// the body.
#include "view/window.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "picture/painter.hpp"
#include "picture/png_file.hpp"
#include "view/screen.hpp"
#include "view/window_state.hpp"

namespace hexaplast::view {
namespace {

constexpr float kLeftWidth = 330, kRightWidth = 340;  // [pixels] of the panels
constexpr double kLateFrame = 0.1;                    // [s] that a frame lasts at least, where steps are late
constexpr double kFirstRoom = 2;                      // clicks of the wheel: tissue will be drawn out

class Window {
 public:
  explicit Window(WindowCall& call)
      : options_(call.options),
        is_asked_to_end_(call.is_asked_to_end),
        state_(call),
        screen_(options_.width, options_.height, "Hexaplast – " + state_.session.title(), &Window::on_key) {
    glfwSetWindowUserPointer(screen_.window(), this);
    if (options_.steps)
      state_.session.advance(*options_.steps);
    else if (options_.is_running)
      state_.session.run();
  }

  /// Until it is closed.
  void show() {
    while (!state_.session.take(state_.now)) glfwWaitEventsTimeout(0.01);
    state_.figure.update(state_.now, state_.look, state_.strongest);
    while (!glfwWindowShouldClose(screen_.window()) && !is_asked_to_end_()) {
      glfwPollEvents();
      state_.take(glfwGetTime());
      draw_frame();
      if (std::exchange(state_.wants_picture, false)) write_picture(next_picture());
      if (is_over()) {
        // the panels take a second frame to find their sizes
        draw_frame();
        if (options_.picture) write_picture(*options_.picture);
        break;
      }
      glfwSwapBuffers(screen_.window());
      leave_time_for_steps();
    }
    state_.session.release();
    state_.session.pause();
  }

 private:
  bool is_over() const {
    const Snapshot& now = state_.now;
    return options_.steps && !now.is_running && (now.step >= *options_.steps || !now.failure.empty());
  }

  /// Frames are dropped before steps are: drawing takes processors that late steps need.
  void leave_time_for_steps() {
    const double now = glfwGetTime(), rest = last_frame_ + kLateFrame - now;
    if (state_.now.is_late && rest > 0) glfwWaitEventsTimeout(rest);
    last_frame_ = glfwGetTime();
  }

  static void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
    if (action != GLFW_PRESS || ImGui::GetIO().WantTextInput) return;
    static_cast<Window*>(glfwGetWindowUserPointer(window))->press(key, modifiers);
  }

  void press(int key, int modifiers) {
    Look& look = state_.look;
    switch (key) {
      case GLFW_KEY_SPACE:
        return state_.toggle_running();
      case GLFW_KEY_S:
        return state_.session.advance(1);
      case GLFW_KEY_R:
        return state_.reset();
      case GLFW_KEY_F:
        return state_.fit();
      case GLFW_KEY_P:
        state_.wants_picture = true;
        return;
      case GLFW_KEY_1:
      case GLFW_KEY_2:
      case GLFW_KEY_3:
      case GLFW_KEY_4:
      case GLFW_KEY_5:
        state_.hand.tool = static_cast<Tool>(key - GLFW_KEY_1);
        return;
      case GLFW_KEY_U:
        return state_.undo();
      case GLFW_KEY_X:
      case GLFW_KEY_Y:
      case GLFW_KEY_Z:
        if (key == GLFW_KEY_Z && modifiers & GLFW_MOD_CONTROL) return state_.undo();
        state_.cut_axis = state_.cut_axis == key - GLFW_KEY_X ? -1 : key - GLFW_KEY_X;
        return;
      case GLFW_KEY_W:
        look.shows_edges = !look.shows_edges;
        return;
      case GLFW_KEY_G:
        return state_.show_ghost(look.ghost == Ghost::kNone ? Ghost::kInitial : Ghost::kNone);
      case GLFW_KEY_Q:
        glfwSetWindowShouldClose(screen_.window(), GLFW_TRUE);
        return;
      default:
        return;
    }
  }

  void draw_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    state_.left = kLeftWidth;
    state_.width = std::max(size.x - kLeftWidth - kRightWidth, 50.0f);
    state_.height = std::max(size.y, 50.0f);
    state_.camera.resize(static_cast<int>(state_.width), static_cast<int>(state_.height));
    if (!is_fitted_) {
      state_.fit();
      state_.camera.zoom(-kFirstRoom);
    }
    is_fitted_ = true;

    panel("controls", 0, kLeftWidth, [this] { draw_controls(state_); });
    panel("plots", size.x - kRightWidth, kRightWidth, [this] { draw_plots(state_); });
    follow_mouse(state_);
    draw_overlay(state_);
    ImGui::Render();

    int pixels_across = 0, pixels_down = 0;
    glfwGetFramebufferSize(screen_.window(), &pixels_across, &pixels_down);
    const float density = size.x > 0 ? static_cast<float>(pixels_across) / size.x : 1;
    output::View view = state_.figure.view(state_.camera, state_.scale);
    view.strip = kBarStrip;
    painter_.draw(view, {static_cast<int>(state_.left * density), 0, static_cast<int>(state_.width * density),
                         pixels_down, density});
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }

  template <class Draw>
  void panel(const char* name, float left, float width, const Draw& draw) {
    ImGui::SetNextWindowPos({left, 0});
    ImGui::SetNextWindowSize({width, state_.height});
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    draw();
    ImGui::End();
  }

  std::filesystem::path next_picture() const {
    for (int number = 1;; ++number) {
      const auto file = options_.picture_folder / fmt::format("{}_{:03}.png", state_.session.title(), number);
      if (!std::filesystem::exists(file)) return file;
    }
  }

  void write_picture(const std::filesystem::path& file) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(screen_.window(), &width, &height);
    output::write_png(file, output::Painter::read(width, height));
    state_.message = file.string() + " written";
  }

  WindowOptions options_;
  std::function<bool()> is_asked_to_end_;
  WindowState state_;
  Screen screen_;
  output::Painter painter_{output::Light::kLamp};
  bool is_fitted_ = false;
  double last_frame_ = 0;  // [s]
};

}  // namespace
}  // namespace hexaplast::view

/// Opens the window and returns when it is closed. The name, set by the build, carries the version of WindowCall.
extern "C" __attribute__((visibility("default"))) void HEXAPLAST_WINDOW_ENTRY(hexaplast::view::WindowCall& call) {
  hexaplast::view::Window(call).show();
}
