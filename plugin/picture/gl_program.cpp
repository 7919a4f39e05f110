// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/gl_program.hpp"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <array>
#include <utility>

#include "picture/renderer.hpp"
#include "picture/shaders.hpp"

namespace hexaplast::output {

using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

namespace {

unsigned compiled(unsigned kind, const std::string& text) {
  const unsigned shader = glCreateShader(kind);
  const char* start = text.c_str();
  glShaderSource(shader, 1, &start, nullptr);
  glCompileShader(shader);
  int is_good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
  if (is_good) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<int>(log.size()), nullptr, log.data());
  throw RendererUnavailable(fmt::format("the graphics driver refuses a program: {}", log.data()));
}

}  // namespace

unsigned linked(const std::string& common, const std::string& vertex, const std::string& fragment) {
  const unsigned program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair{GL_VERTEX_SHADER, kClip + common + vertex}, {GL_FRAGMENT_SHADER, common + fragment}}) {
    const unsigned shader = compiled(kind, kVersion + text);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  int is_good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &is_good);
  if (!is_good) throw RendererUnavailable("the graphics driver cannot link a program");
  return program;
}

int place_of(unsigned program, const char* uniform) { return glGetUniformLocation(program, uniform); }

void set(unsigned program, const char* uniform, const Matrix4f& matrix) {
  glUniformMatrix4fv(place_of(program, uniform), 1, GL_FALSE, matrix.data());
}

void set(unsigned program, const char* uniform, const Vector4f& vector) {
  glUniform4fv(place_of(program, uniform), 1, vector.data());
}

void set(unsigned program, const char* uniform, float number) { glUniform1f(place_of(program, uniform), number); }

void set_clips(unsigned program, const std::optional<Plane>& cut, const Eigen::AlignedBox3f& room) {
  Vector4f plane(0, 0, 0, 1);
  if (cut) plane << cut->normal.cast<float>(), static_cast<float>(cut->offset);
  set(program, "cut", plane);
  constexpr float kFar = 1e30f;
  const Vector3f low = room.isEmpty() ? Vector3f(-kFar, -kFar, -kFar) : room.min(),
                 high = room.isEmpty() ? Vector3f(kFar, kFar, kFar) : room.max();
  glUniform3fv(place_of(program, "low"), 1, low.data());
  glUniform3fv(place_of(program, "high"), 1, high.data());
}

}  // namespace hexaplast::output
