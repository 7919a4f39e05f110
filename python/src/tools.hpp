// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "body.hpp"
#include "hexaplast/moving_body.hpp"
#include "instrument.hpp"
#include "parts/grasp.hpp"
#include "parts/instrument.hpp"
#include "picture/boundary_conditions.hpp"

/// What touches or holds the body of a simulation, moved from outside.
namespace hexaplast::python {

/// Goes within a step to where it is set, or on with its velocity.
class Tool {
 public:
  /// arguments: whose arrays may change afterwards, which does not concern copies of this.
  Tool(std::shared_ptr<Body> body, const Pose& start, const py::dict& arguments, std::vector<std::string> made_with)
      : made_with_(std::move(made_with)),
        body_(std::move(body)),
        arguments_(py::module_::import("copy").attr("deepcopy")(arguments)),
        start_(start),
        now_(start),
        target_(start) {}
  virtual ~Tool() = default;

  std::atomic_flag& body_taken() { return body_->taken(); }
  const py::dict& arguments() const { return arguments_; }  ///< that it was made with

  const Pose& now() const { return now_; }
  const Pose& goal() const { return target_; }
  void go_to(const Pose& pose);
  const Vec3& velocity() const { return velocity_; }  ///< [m/s]
  void set_velocity(const Vec3& velocity);

  virtual parts::Force& acting() = 0;

  /// Where simulations list it, then "radius = 0.05" and the like: all that it was made with.
  const std::vector<std::string>& made_with() const { return made_with_; }

  void begin_step(double dt);
  void end_step();
  virtual void reset();
  virtual void serialize(Archive& archive);  ///< besides what its force remembers

  /// As pictures show it.
  virtual output::Instrument shown() const = 0;

 protected:
  virtual void prescribe(const Pose& from, const Pose& to) = 0;

 private:
  std::vector<std::string> made_with_;
  std::shared_ptr<Body> body_;
  py::dict arguments_;
  Pose start_, now_, target_, next_;
  Vec3 velocity_ = Vec3::Zero();
};

/// A solid that touches.
class SolidTool final : public Instrument, public Tool {  // pybind11 wants the one that it knows first
 public:
  SolidTool(std::shared_ptr<Body> body, const Pose& start, parts::InstrumentOptions options, const py::dict& arguments);

  std::atomic_flag& taken() override { return body_taken(); }
  Pose pose() const override { return now(); }
  void set_pose(const Pose& pose) override { go_to(pose); }
  Pose target() const override { return goal(); }
  bool touches() const override { return true; }
  py::object force() const override { return array_of(part_.contact().force()); }
  Vec3 torque() const { return part_.contact().torque(); }
  int num_touching() const { return part_.contact().num_touching(); }
  bool is_active() const { return part_.is_active(); }
  void set_active(bool is_active);

  parts::Force& acting() override { return part_; }
  void reset() override;
  void serialize(Archive& archive) override;
  output::Instrument shown() const override;

 private:
  void prescribe(const Pose& from, const Pose& to) override { part_.prescribe(from, to); }

  parts::Instrument part_;
};

/// Forceps that hold nodes.
class Grip final : public Tool {
 public:
  Grip(std::shared_ptr<Body> body, const Vec3& position, parts::GraspOptions options, const py::dict& arguments);

  std::atomic_flag& taken() { return body_taken(); }
  bool is_closed() const { return is_closed_; }
  void set_closed(bool is_closed) { is_closed_ = is_closed; }
  const parts::Grasp& part() const { return part_; }

  parts::Force& acting() override { return part_; }
  void reset() override;
  void serialize(Archive& archive) override;
  output::Instrument shown() const override;

 private:
  void prescribe(const Pose& from, const Pose& to) override { part_.prescribe(from.position, to.position, is_closed_); }

  parts::Grasp part_;
  bool is_closed_ = false;
};

/// From the keywords of add_instrument and add_grip. Throw what the parts throw.
std::shared_ptr<SolidTool> make_solid_tool(std::shared_ptr<Body> body, const py::dict& arguments);
std::shared_ptr<Grip> make_grip(std::shared_ptr<Body> body, const py::dict& arguments);

/// "instruments[0]", "grips[0]": where a simulation lists them.
std::vector<std::string> names_of(const std::vector<std::shared_ptr<Tool>>& tools);

/// What tools have to say since the last call, with their names.
std::vector<std::string> take_warnings(const std::vector<std::shared_ptr<Tool>>& tools);

/// All of them as Python's warnings; then throws the first one that Python makes an exception of.
void warn(const std::vector<std::string>& warnings);

void add_tools(py::module_& module);  // SolidTool, Grip

}  // namespace hexaplast::python
