// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <atomic>

#include "arrays.hpp"
#include "hexaplast/contact/instrument_contact.hpp"

namespace hexaplast::python {

/// A rigid instrument that is moved from outside: of a scene, or of a simulation.
class Instrument {
 public:
  virtual ~Instrument() = default;
  virtual std::atomic_flag& taken() = 0;
  virtual Pose pose() const = 0;
  virtual void set_pose(const Pose& pose) = 0;
  virtual Pose target() const = 0;       ///< that was set since the latest step; if none was, the present one
  virtual bool touches() const = 0;      ///< `force` is that of the body on it
  virtual py::object force() const = 0;  ///< (3,) [N]
};

/// (7,) position [m] and quaternion x y z w.
py::array array_of(const Pose& pose);

/// (3,) position; (7,) with a quaternion x y z w; (4, 4) rigid motion of the instrument's frame. What is not given is
/// that of `present`.
Pose pose_from(py::handle given, const Pose& present);

/// (3,) finite numbers.
Vec3 vector_from(const char* name, py::handle given);
py::array array_of(const Vec3& vector);

void add_instrument(py::module_& module);  // Instrument

}  // namespace hexaplast::python
