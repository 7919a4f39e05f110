// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "scene/node.hpp"
#include "scene/seen.hpp"

namespace hexaplast {
struct Pose;
}  // namespace hexaplast

/// What pictures of a scene ask of its components. Nothing here takes part in a step.
namespace hexaplast::scene {

/// A surface that is seen and has no mechanics.
class VisualModel : public Component {
 public:
  static constexpr std::string_view kCategory = "VisualModel";
  using Component::Component;

  virtual const PointArray& points() const = 0;  ///< [m] initial positions
  virtual const std::vector<Triangle>& triangles() const = 0;
  virtual const std::vector<Quad>& quads() const = 0;

  /// Whether a mapping makes it follow hexahedra. Known when the scene is ready.
  bool is_carried() const { return is_carried_; }
  void carry() { is_carried_ = true; }

 private:
  bool is_carried_ = false;
};

/// A component that lends its points to a surface that has none.
class GivesPoints {
 public:
  virtual ~GivesPoints() = default;
  virtual const PointArray* points_for(const VisualModel& model) = 0;  ///< null: none for this one
};

/// What is shown.
class VisualStyle : public Component {
 public:
  static constexpr std::string_view kCategory = "VisualStyle";
  using Component::Component;

  virtual std::optional<bool> shows_visual_models() const = 0;  ///< none: not said
  virtual std::optional<bool> shows_behaviour_models() const = 0;
  virtual bool shows_loads() const = 0;  ///< as arrows
};

/// From where.
class Camera : public Component {
 public:
  static constexpr std::string_view kCategory = "Camera";
  using Component::Component;

  virtual const std::optional<Viewpoint>& viewpoint() const = 0;  ///< none: not said
};

/// What goes through an instrument that touches [J].
struct ContactEnergy {
  double work = 0;           ///< that its motion has done so far
  double stored = 0;         ///< in its contacts at the moment
  double friction_loss = 0;  ///< so far
};

/// A component that is also an instrument in the surgeon's hand.
class Instrument {
 public:
  virtual ~Instrument() = default;
  virtual std::optional<Vec3> place(double time) const = 0;  ///< [m] while it holds something
  virtual Pose pose(double time) const = 0;                  ///< along its path

  virtual std::optional<ContactEnergy> contact_energy() const { return std::nullopt; }  ///< none: it does not touch

  /// Its surface, counter-clockwise seen from outside, and where that is [m]; none: it has no shape.
  virtual std::vector<Triangle> shape_triangles() const { return {}; }
  virtual PointArray shape_points(double /*time*/) const { return PointArray(0, 3); }
};

/// A component that is seen as lines.
class ShowsSprings {
 public:
  virtual ~ShowsSprings() = default;
  virtual std::vector<SpringLine> spring_lines() const = 0;  ///< at accepted positions
};

/// A component whose coordinates may be those of a patient: x to the left, y to the back, z to the head (LPS).
class MayBeOfPatient {
 public:
  virtual ~MayBeOfPatient() = default;
  virtual bool is_of_patient() = 0;
};

}  // namespace hexaplast::scene
