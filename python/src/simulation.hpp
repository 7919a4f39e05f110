// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <string>

#include "body.hpp"
#include "hexaplast/moving_body.hpp"
#include "motion_record.hpp"
#include "picture.hpp"
#include "tools.hpp"

namespace hexaplast::python {

/// What a simulation is made with besides its body.
struct Arguments {
  double density = 1000, dt = 0.01;
  std::array<double, 3> gravity = {};
  double rayleigh_mass = 0, rayleigh_stiffness = 0;
  std::string solver = "cg";
  double tolerance = 1e-6;
  int iterations = 1000;
  std::string preconditioner = "auto";
  bool reactions = false;

  Motion motion() const;
  std::unique_ptr<LinearSolver> linear_solver() const;  ///< null: the library's own choice

  py::tuple state() const;
  static Arguments from(const py::tuple& state);
};

/// A body in motion, and the Python object of that body.
class Simulation {
 public:
  Simulation(std::shared_ptr<Body> body, Arguments arguments);
  ~Simulation() { body_->leave_simulation(); }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  MovingBody& get() { return *moving_; }
  const PointArray& positions() const { return moving_->positions; }
  const PointArray& velocities() const { return moving_->velocities; }
  py::array shown_positions() { return shown_positions_.view(positions()); }
  py::array shown_velocities() { return shown_velocities_.view(velocities()); }
  const std::shared_ptr<Body>& body() const { return body_; }
  std::atomic_flag& taken() { return body_->taken(); }
  int num_nodes() const { return moving_->body.mesh().num_nodes(); }
  double dt() const { return moving_->dt(); }
  double time() const { return moving_->time(); }
  long num_steps() const { return moving_->steps(); }
  double kinetic_energy() const;
  double elastic_energy() const { return moving_->body.energy(positions()); }
  const Arguments& arguments() const { return arguments_; }

  /// [N] of supports, in the latest step. Throws InputError where they are not measured.
  py::array shown_reactions();

  /// With the keywords of Python.
  std::shared_ptr<SolidTool> add_instrument(const py::dict& arguments);
  std::shared_ptr<Grip> add_grip(const py::dict& arguments);
  template <class Kind>
  std::vector<std::shared_ptr<Kind>> all() const {
    std::vector<std::shared_ptr<Kind>> found;
    for (const std::shared_ptr<Tool>& tool : tools_)
      if (auto one = std::dynamic_pointer_cast<Kind>(tool)) found.push_back(one);
    return found;
  }

  /// Of tools, since the last call.
  std::vector<std::string> take_warnings() const { return python::take_warnings(tools_); }

  /// Nodal forces [N] from Python, none where they are not given; `name` is that of the argument.
  PointArray forces_from(const char* name, const py::object& given) const;

  /// One step under such forces. For who has taken the simulation; needs no lock of Python.
  void advance(const PointArray& forces, RunReport& report);

  /// Steps under constant forces.
  RunReport run(long steps, const py::object& forces);

  /// Brings what is shown of it up to date.
  void refresh();

  /// Joints of the body.
  std::vector<int> open(const std::vector<int>& joints);

  void set_state(py::handle positions, py::handle velocities);
  void reset();
  void record();
  std::string page();
  py::array picture(const PictureOptions& options);
  py::bytes save() const;
  void load(const py::bytes& data);

 private:
  output::BoundaryConditions conditions() const;
  std::shared_ptr<MotionRecord> new_record() const;
  void begin_record();
  template <class Make>
  auto add(const Make& make, const py::dict& arguments);

  /// Of each tool: where it is listed, and what it was made with.
  std::vector<std::vector<std::string>> names_of_tools() const;

  Arguments arguments_;
  std::shared_ptr<Body> body_;
  std::shared_ptr<PointArray> forces_;
  std::shared_ptr<MovingBody> moving_;
  std::vector<std::shared_ptr<Tool>> tools_;  // whose forces moving_ has
  PointArray reactions_ = PointArray(0, 3);
  ShownField shown_positions_, shown_velocities_, shown_reactions_;
  std::shared_ptr<MotionRecord> record_;  // null: not wanted
};

}  // namespace hexaplast::python
