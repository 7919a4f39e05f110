// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "hexaplast/base/types.hpp"

/// numpy arrays on their way in and out. What comes in is checked here once, with messages that name the argument:
/// TypeError for what holds no numbers of the right kind, ValueError for a wrong shape or an index out of range.
namespace hexaplast::python {

namespace py = pybind11;

/// Real numbers in C order; a copy only where the caller gives something else.
using RealArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Three columns; any number of rows, or `num_rows`.
RealArray points(const char* name, py::handle given);
RealArray points(const char* name, py::handle given, Eigen::Index num_rows);

/// The same numbers as the library takes them; valid as long as the array.
inline Eigen::Map<const PointArray> as_points(const RealArray& array) { return {array.data(), array.shape(0), 3}; }

/// Node (or hexahedron) numbers below `count`: integers, or a mask of `count` booleans.
std::vector<int> indices(const char* name, py::handle given, int count);

/// Integers, eight columns. Whether nodes of these numbers exist is for HexMesh to say.
std::vector<Hexahedron> hexahedra(const char* name, py::handle given);

/// Read-only array on memory that `owner` keeps where it is; the array keeps the owner alive.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, py::handle owner) {
  py::array_t<T> array(std::move(shape), data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}
inline py::array view(const PointArray& field, py::handle owner) {
  return view(field.data(), {field.rows(), field.cols()}, owner);
}

template <class T>
py::array view(const std::vector<T>& values, py::handle owner) {
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, owner);
}
template <class T>
py::array view(const std::vector<std::array<T, kCorners>>& values, py::handle owner) {
  return view(reinterpret_cast<const T*>(values.data()), {static_cast<py::ssize_t>(values.size()), kCorners}, owner);
}

/// A property: the read-only array on what `get` finds in an object, which it keeps alive.
template <class Self, class Get>
auto view_of(Get get) {
  return [get](py::object self) { return view(std::invoke(get, self.cast<Self&>()), self); };
}

/// A nodal field as read-only arrays that follow it: brought up to date after every change, while somebody has one.
/// Where nodes have been split, or joined again, the arrays that were taken before keep what they last showed.
class ShownField {
 public:
  py::array view(const PointArray& present);
  void refresh(const PointArray& present);
  bool is_shown() const { return shown_ != nullptr; }

 private:
  std::shared_ptr<PointArray> shown_;
};

/// An array that takes over what a function returned.
py::array taken(PointArray field);

/// (m, 8)
py::array_t<int> cells_of(const std::vector<Hexahedron>& hexahedra);

}  // namespace hexaplast::python
