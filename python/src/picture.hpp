// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "arrays.hpp"
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

/// def: `function` as picture(), with those keywords.
template <class Of, class Function>
void def_picture(Of& of, const Function& function) {
  of.def(
      "picture",
      [function](typename Of::type& self, int width, int height, const py::object& view, const py::object& camera,
                 const std::string& field, const py::object& range) {
        return function(self, PictureOptions{width, height, view, camera, field, range});
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
