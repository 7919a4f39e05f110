// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <initializer_list>
#include <optional>
#include <vector>

#include "hexaplast/geometry/plane_cut.hpp"
#include "picture/camera.hpp"
#include "picture/colour_map.hpp"

namespace hexaplast::output {

/// The triangles, lines and points that show a moment, for pictures and for the live window: three vertices a triangle,
/// two ends a line, in space [m]. What each list is drawn with stands in ink.hpp.
struct Geometry {
  struct Vertex {
    Eigen::Vector3f place;   ///< [m]
    Eigen::Vector3f normal;  ///< unit vector
    float value = 0;         ///< of the quantity shown; infinite: it has none
    float light = 1;         ///< that it receives, in pictures
  };

  /// One corner after the other of triangles or lines, which may share vertices.
  struct Vertices {
    std::vector<Vertex> distinct;
    std::vector<unsigned> corners;

    std::size_t size() const { return corners.size(); }
    bool empty() const { return corners.empty(); }
    const Vertex& operator[](std::size_t corner) const { return distinct[corners[corner]]; }
    auto begin() const { return distinct.begin(); }
    auto end() const { return distinct.end(); }
    unsigned number(const Vertex& added) {
      distinct.push_back(added);
      return static_cast<unsigned>(distinct.size() - 1);
    }
    void add(std::initializer_list<Vertex> vertices) {
      for (const Vertex& vertex : vertices) corners.push_back(number(vertex));
    }
  };
  using Places = std::vector<Eigen::Vector3f>;

  Vertices surface;        ///< of the body or what is embedded in it, in the colours of the scale
  Vertices walls;          ///< of what blades and tears have opened, the same, tinted
  Vertices cut_faces;      ///< where the body is cut through, the same: as far as it lies within the surface
  bool is_hollow = false;  ///< the surface is embedded, and not the hexahedra' own
  bool is_closed = true, are_tools_closed = true;  ///< surfaces: only these have an inside where they are cut
  Vertices veil;                                   ///< of a body that what is shown lies in
  Places edges, cut_edges, cut_outline;
  Places halo;            ///< outlines of the surface, beside which the shape behind is not seen
  float edge_length = 0;  ///< [m] mean of the hexahedra that are left
  bool is_cage = false;   ///< the edges stand around embedded surfaces
  Places ghost, ghost_outline;
  Vertices tools;
  Places tool_outline, tool_cut_outline;
  Vertices load_arrows, tool_arrows;  ///< those of instruments are seen also where they lie within the tissue
  Places taut_springs, slack_springs;
  Places fixed;  ///< points

  std::optional<Plane> cut;  ///< what lies above it is left out, but for cut faces, their lines and arrows of tools
  Eigen::AlignedBox3f room;  ///< [m] in which instruments and springs are shown; empty: everywhere
};

/// A geometry, from where it is seen, and which values its colours stand for.
struct View {
  Geometry geometry;
  Camera camera;                     ///< fitted to a page
  float width, height;               ///< of that page, in its units
  double min = 0, max = 0;           ///< values at the ends of the scale; equal: all have the colour of its beginning
  float strip = 0;                   ///< of the page at its lower border that stays empty, for the colour bar
  std::vector<Colour> palette = {};  ///< from the one end to the other, each flat; empty: those of the scale
};

}  // namespace hexaplast::output
