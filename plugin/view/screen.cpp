// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/screen.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <filesystem>

#include "record/files.hpp"
#include "view/widgets.hpp"

namespace hexaplast::view {
namespace {

constexpr float kFontSize = 15;  // [pixels]

std::string& problem() {
  static std::string text;
  return text;
}

void dress() {
  const std::string font = HEXAPLAST_FONT_DIRECTORY "/DejaVuSans.ttf";
  static constexpr ImWchar kLetters[] = {0x20, 0xFF, 0x2013, 0x2013, 0};  // Latin, and the dash of what has no unit
  if (std::filesystem::exists(font))
    ImGui::GetIO().Fonts->AddFontFromFileTTF(font.c_str(), kFontSize, nullptr, kLetters);
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.WindowBorderSize = 0;
  style.WindowPadding = {14, 12};
  style.FrameRounding = style.GrabRounding = 4;
  style.FramePadding = {8, 4};
  style.ItemSpacing = {8, 7};
  const auto colour = [](ImU32 rgba) { return ImGui::ColorConvertU32ToFloat4(rgba); };
  style.Colors[ImGuiCol_Text] = colour(kInk);
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.968f, 0.972f, 0.98f, 1);
  style.Colors[ImGuiCol_FrameBg] = ImVec4(0.90f, 0.915f, 0.935f, 1);
  style.Colors[ImGuiCol_Button] = ImVec4(0.87f, 0.90f, 0.935f, 1);
  style.Colors[ImGuiCol_CheckMark] = colour(kSteel);
  style.Colors[ImGuiCol_SliderGrab] = ImVec4(0.56f, 0.70f, 0.84f, 1);  // light: the number stands on it
  style.Colors[ImGuiCol_SliderGrabActive] = ImVec4(0.93f, 0.64f, 0.48f, 1);
  style.Colors[ImGuiCol_Header] = ImVec4(0.87f, 0.90f, 0.935f, 1);
}

}  // namespace

Screen::Screen(int width, int height, const std::string& title, GLFWkeyfun on_key) {
  glfwSetErrorCallback([](int, const char* what) { problem() = what; });
  if (!glfwInit()) throw output::OutputError("no window can be opened: " + problem());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SAMPLES, 4);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    glfwTerminate();
    throw output::OutputError("no window can be opened: " + problem());
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);

  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // nothing is left behind
  dress();
  glfwSetKeyCallback(window_, on_key);
  ImGui_ImplGlfw_InitForOpenGL(window_, true);  // calls those that are there already
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Screen::~Screen() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

}  // namespace hexaplast::view
