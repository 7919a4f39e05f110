// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "arrays.hpp"
#include "body.hpp"
#include "picture/bodies.hpp"
#include "picture/gallery.hpp"

namespace hexaplast::python {

/// A moment of bodies in motion.
struct Moment {
  output::Bodies bodies;
  std::string title;
  double dt;  ///< [s]
  long step;
  double time;  ///< [s]
  const PointArray &positions, &velocities;
  const output::BoundaryConditions& conditions;
};

/// The keywords of picture().
struct PictureOptions {
  int width, height;  ///< [pixels]
  py::object view, camera;
  std::string field;
  py::object range;
};

/// (height, width, 3). Throws InputError and py::type_error for options that cannot be, RendererUnavailable.
py::array picture_of(const Moment& moment, output::Staging staging, const PictureOptions& options);

/// What simulations and scenes have alike.
template <class Motion>
py::class_<Motion>& def_motion(py::class_<Motion>& of) {
  of.def_property_readonly("dt", &Motion::dt, "[s]")
      .def_property_readonly("time", &Motion::time, "[s]")
      .def_property_readonly("num_steps", &Motion::num_steps, "steps so far")
      .def_property_readonly("kinetic_energy", in_turn([](Motion& m) { return m.kinetic_energy(); }), "[J]")
      .def_property_readonly("elastic_energy", in_turn([](Motion& m) { return m.elastic_energy(); }), "[J]")
      .def("record", &Motion::record,
           "From now on, states are kept for show(): of all steps at most 60, at equal distances. reset, load and\n"
           "a Simulation's set_state begin anew")
      .def("_page", &Motion::page)
      .def("copy", &copy_of, "Another one, with bodies of its own in the same state; it records nothing")
      .def("__copy__", &copy_of);
  return of.def(
      "picture",
      [](Motion& self, int width, int height, const py::object& view, const py::object& camera,
         const std::string& field, const py::object& range) {
        return self.picture({width, height, view, camera, field, range});
      },
      py::arg("width") = 640, py::arg("height") = 360, py::kw_only(), py::arg("view") = py::none(),
      py::arg("camera") = py::none(), py::arg("field") = "plastic_strain", py::arg("range") = py::none(),
      "(height, width, 3) of uint8: a picture of the present state, as `hexaplast render` makes it. view: from where,\n"
      "front, back, left, right, top, bottom or a direction (3,); the distance is fitted to what is shown. camera:\n"
      "(place, target, angle), (3,) [m] twice and the field of view [deg]; so that pictures can be compared. field: "
      "what\n"
      "the colours show; range: (min, max) of them. Forces are those of the latest step; where a scene was loaded or "
      "copied, contact shows\n"
      "none before the next one. RuntimeError where there is no renderer");
}

}  // namespace hexaplast::python
