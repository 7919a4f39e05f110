// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/type/types.h>

#include <vector>

namespace sofa::helper::visual {

/// Keeps what it is told to draw, where a test reads it.
class DrawTool {
 public:
  struct Triangles {
    std::vector<type::Vec3> corners;
    std::vector<type::RGBAColor> colours;  // one per corner
  };
  struct Lines {
    std::vector<type::Vec3> ends;
    type::RGBAColor colour;
  };

  class StateLifeCycle {
   public:
    explicit StateLifeCycle(int& open) : open_(open) { ++open_; }
    ~StateLifeCycle() { --open_; }
    StateLifeCycle(const StateLifeCycle&) = delete;

   private:
    int& open_;
  };

  StateLifeCycle makeStateLifeCycle() { return StateLifeCycle(open_states); }
  void setPolygonMode(int, bool wireframe) { is_wireframe = wireframe; }
  void enableLighting() { is_lit = true; }
  void drawTriangles(const std::vector<type::Vec3>& corners, const std::vector<type::RGBAColor>& colours) {
    triangles.push_back({corners, colours});
  }
  void drawTriangles(const std::vector<type::Vec3>& corners, const type::RGBAColor& colour) {
    triangles.push_back({corners, std::vector<type::RGBAColor>(corners.size(), colour)});
  }
  void drawLines(const std::vector<type::Vec3>& ends, float, const type::RGBAColor& colour) {
    lines.push_back({ends, colour});
  }
  void drawPoints(const std::vector<type::Vec3>& places, float, const type::RGBAColor& colour) {
    points.push_back({places, colour});
  }
  void disableLighting() { is_lit = false; }

  std::vector<Triangles> triangles;
  std::vector<Lines> lines, points;
  int open_states = 0;
  bool is_wireframe = false, is_lit = false;
};

}  // namespace sofa::helper::visual

namespace sofa::core::visual {

struct DisplayFlags {
  bool show_force_fields = true, show_wire_frame = false, show_visual_models = true;
  bool getShowForceFields() const { return show_force_fields; }
  bool getShowWireFrame() const { return show_wire_frame; }
  bool getShowVisualModels() const { return show_visual_models; }
};

class VisualParams {
 public:
  const DisplayFlags& displayFlags() const { return flags; }
  helper::visual::DrawTool* drawTool() const { return &tool; }

  DisplayFlags flags;
  mutable helper::visual::DrawTool tool;
};

}  // namespace sofa::core::visual
