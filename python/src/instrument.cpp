// SPDX-License-Identifier: LGPL-2.1-or-later
#include "instrument.hpp"

#include <fmt/format.h>

#include "body.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::python {
namespace {

/// Finite real numbers.
RealArray numbers_of(const char* name, py::handle given) {
  const RealArray array = RealArray::ensure(given);
  if (!array) throw py::type_error(fmt::format("{}: no array of real numbers", name));
  if (!Eigen::Map<const Eigen::VectorXd>(array.data(), array.size()).allFinite())
    throw InputError(fmt::format("{}: must be finite", name));
  return array;
}

[[noreturn]] void refuse_shape(const char* name, const RealArray& array, const char* allowed) {
  throw py::value_error(
      fmt::format("{}: shape {}, must be {}", name, py::str(array.attr("shape")).cast<std::string>(), allowed));
}

}  // namespace

Vec3 vector_from(const char* name, py::handle given) {
  const RealArray array = numbers_of(name, given);
  if (array.ndim() != 1 || array.size() != 3) refuse_shape(name, array, "(3,)");
  return Vec3::Map(array.data());
}

py::array array_of(const Vec3& vector) { return py::array_t<double>(3, vector.data()); }

py::array array_of(const Pose& pose) {
  Eigen::Matrix<double, 7, 1> numbers;
  numbers << pose.position, pose.orientation.coeffs();
  return py::array_t<double>(7, numbers.data());
}

Pose pose_from(py::handle given, const Pose& present) {
  const RealArray array = numbers_of("pose", given);
  const Eigen::Map<const Eigen::VectorXd> numbers(array.data(), array.size());
  if (array.ndim() == 1 && array.size() == 3) return {numbers, present.orientation};
  if (array.ndim() == 1 && array.size() == 7) {
    const Eigen::Quaterniond turn(Eigen::Vector4d(numbers.tail<4>()));
    if (!(turn.norm() > 0)) throw InputError("pose: the quaternion is 0 0 0 0, must have a length");
    return {numbers.head<3>(), turn.normalized()};
  }
  if (array.ndim() == 2 && array.shape(0) == 4 && array.shape(1) == 4) {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> motion(array.data());
    const Mat3 turn = motion.topLeftCorner<3, 3>();
    if (!turn.isUnitary(1e-6) || !(turn.determinant() > 0) || motion.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
      throw InputError("pose: the matrix is no rigid motion");
    return {motion.topRightCorner<3, 1>(), Eigen::Quaterniond(turn).normalized()};
  }
  refuse_shape("pose", array, "(3,), (7,) or (4, 4)");
}

void add_instrument(py::module_& module) {
  module.def("_require_jaws", [](Instrument& left, Instrument& right) {
    if (!left.touches() || !right.touches())
      throw InputError("forceps: a jaw must be an InstrumentContactForceField, which touches");
    if (&left.taken() != &right.taken()) throw InputError("forceps: the jaws are of two simulations");
  });
  module.def(  // (4, 4)
      "_motion",
      [](py::handle given, py::handle present) {
        const Pose pose = pose_from(given, pose_from(present, {}));
        Eigen::Matrix<double, 4, 4, Eigen::RowMajor> motion = Eigen::Matrix4d::Identity();
        motion.topLeftCorner<3, 3>() = pose.orientation.toRotationMatrix();
        motion.topRightCorner<3, 1>() = pose.position;
        return py::array_t<double>({4, 4}, motion.data());
      },
      py::arg("pose"), py::arg("present") = py::make_tuple(0, 0, 0));
  py::class_<Instrument, std::shared_ptr<Instrument>>(module, "Instrument",
                                                      "A rigid instrument that touches, moved from outside")
      .def_property("pose", in_turn([](Instrument& i) { return array_of(i.pose()); }),
                    in_turn([](Instrument& i, py::handle pose) { i.set_pose(pose_from(pose, i.pose())); }),
                    "Where it is: (7,) position [m] and orientation, a quaternion x y z w. Set to (3,), (7,) or a "
                    "matrix (4, 4), it\n"
                    "moves there steadily within the next step, and stays there")
      .def_property_readonly(
          "target", in_turn([](Instrument& i) { return array_of(i.target()); }),
          "(7,) the pose that was set since the latest step, which the next one reaches; if none was, the present pose")
      .def_property_readonly("force", in_turn([](Instrument& i) { return i.force(); }),
                             "(3,) [N] of the body on it, in the latest step");
}

}  // namespace hexaplast::python
