// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "picture/colour_map.hpp"

namespace hexaplast::output {

// What pictures and the live window (picture/painter.cpp), and the viewer of reports (page/viewer.js), draw with.
// Widths and sizes are units of a page of 1280 x 720, and pixels of window and viewer.

inline constexpr Colour kPaper{1, 1, 1};
inline constexpr Colour kInk{0.13f, 0.13f, 0.15f};
inline constexpr Colour kFaint{0.45f, 0.46f, 0.48f};
inline constexpr Colour kOriginal{0.70f, 0.73f, 0.77f};  // outlines of the shape behind
inline constexpr Colour kGhost{0.945f, 0.950f, 0.958f};  // and its surface
inline constexpr Colour kLoad{0.02f, 0.47f, 0.41f};      // arrows of loads
inline constexpr Colour kSteel{0.16f, 0.36f, 0.55f};     // outlines, rings and arrows of instruments
inline constexpr Colour kMetal{0.78f, 0.84f, 0.90f};     // and their surfaces
inline constexpr Colour kEdge{0.20f, 0.16f, 0.19f};
inline constexpr Colour kCage{0.25f, 0.30f, 0.38f};    // edges of hexahedra around embedded surfaces
inline constexpr Colour kSpring{0.36f, 0.42f, 0.16f};  // springs, and what ties places together
inline constexpr Colour kWall{0.62f, 0.16f, 0.15f};    // of cuts
inline constexpr float kWallTint = 0.6f;               // part of it in the colour of walls; the rest is the scale's
inline constexpr Colour kNoValue{0.80f, 0.81f, 0.82f};
inline constexpr std::array kAxes{Colour{0.76f, 0.25f, 0.16f}, Colour{0.20f, 0.50f, 0.22f},
                                  Colour{0.16f, 0.36f, 0.72f}};

inline constexpr float kOutlineWidth = 1.3f;         // of the shape behind, and of instruments
inline constexpr Colour kVeil{0.80f, 0.60f, 0.52f};  // what may be behind it is seen through it
inline constexpr float kVeilOpacity = 0.34f;         // of a body that regions lie in
inline constexpr float kSpringWidth = 1.6f;
inline constexpr float kHaloWidth = 3.6f;  // beside which the shape behind is not seen: it hides its outline
inline constexpr float kSlackWidth = 1.1f, kSlackOpacity = 0.5f;  // of springs that are shorter than at rest
inline constexpr float kCutWidth = 1.6f;                          // of the border of a cut face
inline constexpr float kDotRadius = 3.2f;                         // radius of the mark of a fixed node, at most
inline constexpr float kDotOfEdge = 1 / 6.f;                      // the same in parts of an edge's length
inline constexpr float kRingRadius = 9, kRingWidth = 2.4f, kRimWidth = 2.4f;  // of an instrument without a shape

/// Edges of hexahedra grow fainter with their length, so that on fine meshes they do not cover the colours.
struct EdgeInk {
  static constexpr float kShortest = 4, kLongest = 48;  ///< shorter ones are left out; longer ones are not stronger
  static constexpr float kWidest = 1.2f, kStrongest = 0.75f;
  static constexpr float kCageWidth = 1.1f, kCageOpacity = 0.3f;

  Colour colour;
  float width = 1, opacity = 1;
};

/// length: of an edge, on the page; is_cage: around embedded surfaces. None: the edges are too short.
std::optional<EdgeInk> edge_ink(float length, bool is_cage);

inline constexpr float kCrease = 0.75f;  // cosine of the angle from which an edge is sharp, about 41 degrees

inline constexpr float kLongestArrow = 0.13f;    // in parts of the diagonal of the bodies' box
inline constexpr float kArrowGirth = 0.055f;     // diameter of shafts, in parts of the longest arrow's length
inline constexpr float kArrowHeadLength = 4.2f;  // in parts of the girth
inline constexpr float kArrowHeadWidth = 1.5f;   // radius of its foot
inline constexpr float kRimOfArrows = 1.5f;      // of paper, which sets them off from any colour
inline constexpr float kArrowMaxHead = 0.6f;     // in parts of the arrow's length
inline constexpr int kArrowSides = 16;           // of the shaft
inline constexpr float kArrowPresses = 0.3f;     // sine of the angle to the surface from which a load presses on it

/// A direction in the picture.
struct Direction {
  float right, up, towards;

  Eigen::Vector3f of(const Eigen::Vector3f& x, const Eigen::Vector3f& y, const Eigen::Vector3f& z) const {
    return (right * x + up * y + towards * z).normalized();
  }
};

// The light on bodies is that of a hemisphere. What fraction of it a place receives, pictures find with many lamps
// (painter.hpp), window and viewer with the even part of the sky and one lamp.
inline constexpr Direction kZenith{-0.1f, 0.75f, 0.65f};      // the middle of the hemisphere
inline constexpr Direction kMainLamp{-0.40f, 0.75f, 0.55f};   // around which half of the light gathers
inline constexpr Direction kGleamLamp{-0.43f, 0.80f, 0.42f};  // that moist surfaces mirror
inline constexpr Direction kThingLamp{-0.5f, 1, 1};     // of instruments and arrows, which have a light of their own
inline constexpr float kDarkest = 0.60f, kLit = 0.43f;  // brightness without light, and what all light adds
inline constexpr float kGleam = 0.16f, kGleamExponent = 40;
inline constexpr float kSkyFraction = 0.41f;  // of the even sky, where all light arrives; the rest is the main lamp's

/// The light as functions of GLSL (330 and 300 es), vectors along right, up and towards the viewer: what a normal
/// receives of the even `sky`; `moist` tissue that receives a fraction of the light; `lit_tissue`, the same where a
/// fraction of the main lamp's light arrives; `lit_thing`. Nothing is ever dark, so that colours stay comparable with
/// the colour bar.
std::string light_shader();

}  // namespace hexaplast::output
