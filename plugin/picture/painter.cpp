// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/painter.hpp"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "picture/gl_program.hpp"
#include "picture/ink.hpp"
#include "picture/lamps.hpp"
#include "picture/shaders.hpp"

namespace hexaplast::output {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr int kNumColours = 256;

// of the maps of depths [texels]
constexpr float kLift = 1.5f;  // that a place is looked at above its surface, so that it shades not itself
constexpr float kSlack = 1;    // by which something must be nearer to the lamp to cast a shadow
constexpr float kSoft = 6;     // radius of the disc that softens the shadows of a single lamp

struct PageVertex {
  Vector3f place;
  Vector4f ink;
};

void declare(unsigned attribute, int count, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(attribute);
  glVertexAttribPointer(attribute, count, GL_FLOAT, GL_FALSE, static_cast<int>(stride),
                        reinterpret_cast<const void*>(offset));
}

template <class T>
void send(unsigned buffer, const std::vector<T>& content, unsigned target = GL_ARRAY_BUFFER) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(content.size() * sizeof(T)), content.data(), GL_STREAM_DRAW);
}

unsigned texture_of(unsigned kind) {
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(kind, texture);
  for (const unsigned filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTexParameteri(kind, filter, GL_LINEAR);
  for (const unsigned wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTexParameteri(kind, wrap, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

Painter::Painter(const Light& light) : light_(light) {
  const auto [lamps, strengths] = lamps_and_strengths(light.num_lamps);
  lamps_ = lamps;
  const bool is_single = light.num_lamps == 1;
  const float texel = 1 / static_cast<float>(light.map_size), soft = is_single ? kSoft : 0;
  // lifted by what softens its shadow, a plane that stands aslant does not shade itself either
  const std::string constants = fmt::format(
      "const int kNumLamps = {}, kNumTaps = {};\nconst float kLift = {:.9f}, kSlack = {:.9f}, kSoft = {:.9f};\n",
      light.num_lamps, is_single ? 12 : 1, 2 * (kLift + soft) * texel, kSlack * texel, soft * texel);
  surface_ = linked(constants + light_shader() + kReceived, kSurfaceVertex, kSurfaceFragment);
  flat_ = linked("", kFlatVertex, kFlatFragment);
  glUseProgram(surface_);
  glUniformMatrix3fv(place_of(surface_, "lamps"), light.num_lamps, GL_FALSE, lamps_.front().data());
  glUniform1fv(place_of(surface_, "strength"), light.num_lamps, strengths.data());
  glUniform3f(place_of(surface_, "no_value"), kNoValue.red, kNoValue.green, kNoValue.blue);
  glUniform1i(place_of(surface_, "shadow"), 1);

  glGenBuffers(1, &numbers_);
  for (Batch* batch : {&vertices_, &places_, &page_}) {
    glGenVertexArrays(1, &batch->array);
    glGenBuffers(1, &batch->buffer);
    glBindVertexArray(batch->array);
    glBindBuffer(GL_ARRAY_BUFFER, batch->buffer);
    if (batch == &vertices_) {
      declare(0, 3, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, place));
      declare(1, 3, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, normal));
      declare(2, 1, sizeof(Geometry::Vertex), offsetof(Geometry::Vertex, value));
    }
    if (batch == &places_) declare(0, 3, sizeof(Vector3f), 0);
    if (batch == &page_) {
      declare(0, 3, sizeof(PageVertex), offsetof(PageVertex, place));
      declare(1, 4, sizeof(PageVertex), offsetof(PageVertex, ink));
    }
  }
  glBindVertexArray(0);

  colours_ = texture_of(GL_TEXTURE_2D);
  send_colours({});

  shadow_ = texture_of(GL_TEXTURE_2D_ARRAY);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT24, light.map_size, light.map_size, light.num_lamps, 0,
               GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &shadow_frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Painter::~Painter() {
  for (const Batch& batch : {vertices_, places_, page_}) {
    glDeleteVertexArrays(1, &batch.array);
    glDeleteBuffers(1, &batch.buffer);
  }
  glDeleteBuffers(1, &numbers_);
  for (const unsigned texture : {colours_, shadow_}) glDeleteTextures(1, &texture);
  glDeleteFramebuffers(1, &shadow_frame_);
  for (const unsigned program : {surface_, flat_}) glDeleteProgram(program);
}

void Painter::send_colours(const std::vector<Colour>& palette) {
  palette_ = palette;
  std::vector<Colour> colours = palette;
  for (int k = 0; palette.empty() && k < kNumColours; ++k) colours.push_back(colour_of((k + 0.5) / kNumColours));
  glBindTexture(GL_TEXTURE_2D, colours_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, static_cast<int>(colours.size()), 1, 0, GL_RGB, GL_FLOAT, colours.data());
}

void Painter::draw_shadows(const Geometry& geometry, const Matrix4f& seen) {
  int frame = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame_);
  glViewport(0, 0, light_.map_size, light_.map_size);
  glDepthFunc(GL_LESS);
  glUseProgram(flat_);
  set(flat_, "nearer", 0);
  const auto cast = [&](const Geometry::Vertices& vertices, bool is_first) {
    const int count = bind(vertices);
    for (int k = 0; k < light_.num_lamps; ++k) {
      if (k > 0) glFinish();  // Mesa's rasteriser lets up to 64 maps wait, each with all of its triangles
      glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, shadow_, 0, k);
      if (is_first) glClear(GL_DEPTH_BUFFER_BIT);
      Matrix4f turn = Matrix4f::Identity();
      turn.topLeftCorner<3, 3>() = Vector3f(1, 1, -1).asDiagonal() * lamps_[static_cast<std::size_t>(k)];
      set(flat_, "clip", Matrix4f(turn * seen));
      glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, nullptr);
    }
  };
  set_clips(flat_, geometry.cut, {});
  cast(geometry.surface, true);
  if (!geometry.walls.empty()) cast(geometry.walls, false);
  if (light_.tools_cast_shadows && !geometry.tools.empty()) cast(geometry.tools, false);
  set_clips(flat_, {}, {});
  if (!geometry.cut_faces.empty() && !geometry.is_hollow) cast(geometry.cut_faces, false);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<unsigned>(frame));
}

void Painter::draw_page(const Drawing& page, int density) {
  std::vector<PageVertex> vertices;
  const auto add = [&](const Drawing::Vertex& vertex, float opacity) {
    const auto& [red, green, blue] = vertex.colour;
    vertices.push_back({{vertex.x, vertex.y, vertex.depth}, {red, green, blue, opacity}});
  };
  for (const Drawing::Triangle& triangle : page.triangles)
    for (const Drawing::Vertex& corner : triangle.corner) add(corner, 1);
  const auto num_corners = static_cast<int>(vertices.size());
  for (const Drawing::Line& line : page.lines)
    for (const Drawing::Vertex& end : {line.from, line.to}) add(end, line.opacity);
  send(page_.buffer, vertices);
  glBindVertexArray(page_.array);

  glUseProgram(flat_);
  Matrix4f clip = Matrix4f::Identity();  // y downwards; depth 0 near, 1 far
  clip.diagonal() << 2 * page.unit / static_cast<float>(page.width), -2 * page.unit / static_cast<float>(page.height),
      2, 1;
  clip.col(3) << -1, 1, -1, 1;
  set(flat_, "clip", clip);
  set(flat_, "nearer", 0);
  set_clips(flat_, {}, {});  // a page without a view is drawn before any view set them
  glUniform1i(place_of(flat_, "is_round"), 0);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glClearColor(kPaper.red, kPaper.green, kPaper.blue, 1);
  glClear(page.view ? GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(0, kPushUnits);
  glDrawArrays(GL_TRIANGLES, 0, num_corners);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (std::size_t k = 0; k < page.lines.size(); ++k) {
    glLineWidth(page.lines[k].width * page.unit * static_cast<float>(density));
    glDepthMask(page.lines[k].opacity < 1 ? GL_FALSE : GL_TRUE);
    glDrawArrays(GL_LINES, num_corners + 2 * static_cast<int>(k), 2);
  }
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
}

int Painter::bind(const Geometry::Vertices& vertices) {
  static_assert(sizeof(Geometry::Vertex) == 7 * sizeof(float), "bytes between its members would differ");
  Geometry::Vertices distinct;  // light is found once for the corners that faces share
  std::vector<unsigned> numbers;
  std::unordered_map<std::string_view, unsigned> number_of;
  for (const Geometry::Vertex& vertex : vertices) {
    const std::string_view bytes(reinterpret_cast<const char*>(&vertex), sizeof(vertex));
    const auto [entry, is_new] = number_of.emplace(bytes, static_cast<unsigned>(distinct.size()));
    if (is_new) distinct.push_back(vertex);
    numbers.push_back(entry->second);
  }
  glBindVertexArray(vertices_.array);
  send(vertices_.buffer, distinct);
  send(numbers_, numbers, GL_ELEMENT_ARRAY_BUFFER);
  return static_cast<int>(numbers.size());
}

void Painter::draw_lines(const Geometry::Places& ends, const Colour& colour, float opacity, float width) {
  // drivers draw no line thinner than a pixel
  glLineWidth(std::max(width, 1.0f));
  draw_places(ends, GL_LINES, colour, opacity * std::min(width, 1.0f));
}

void Painter::draw_places(const Geometry::Places& places, unsigned mode, const Colour& colour, float opacity) {
  if (places.empty()) return;
  send(places_.buffer, places);
  glBindVertexArray(places_.array);
  glVertexAttrib4f(1, colour.red, colour.green, colour.blue, opacity);
  glUniform1i(place_of(flat_, "is_round"), mode == GL_POINTS);
  glDrawArrays(mode, 0, static_cast<int>(places.size()));
}

Image Painter::read(int width, int height) {
  Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const std::size_t row = static_cast<std::size_t>(width) * 3;
  for (int y = 0; y < height; ++y)  // OpenGL counts rows from below
    glReadPixels(0, height - 1 - y, width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                 &image.pixels[static_cast<std::size_t>(y) * row]);
  return image;
}

}  // namespace hexaplast::output
