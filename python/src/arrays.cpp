// SPDX-License-Identifier: LGPL-2.1-or-later
#include "arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>

namespace hexaplast::python {
namespace {

std::string text_of(py::handle object) { return py::str(object); }

/// An array whose dtype is of one of the `kinds` (numpy's letters). An empty one has no numbers of a wrong kind.
py::array array_of(const char* name, py::handle given, std::string_view kinds, const char* what) {
  py::array array = py::array::ensure(given);
  if (!array) throw py::type_error(fmt::format("{}: no array of {}", name, what));
  if (array.size() > 0 && kinds.find(array.dtype().kind()) == std::string_view::npos)
    throw py::type_error(fmt::format("{}: dtype {}, must be {}", name, text_of(array.dtype()), what));
  return array;
}

[[noreturn]] void refuse_shape(const char* name, const py::array& array, const std::string& allowed) {
  throw py::value_error(fmt::format("{}: shape {}, must be {}", name, text_of(array.attr("shape")), allowed));
}

using IntegerArray = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

RealArray array_of_points(const char* name, py::handle given, Eigen::Index num_rows, const std::string& allowed) {
  const py::array array = array_of(name, given, "fiu", "real numbers");
  if (array.ndim() != 2 || array.shape(1) != 3 || (num_rows >= 0 && array.shape(0) != num_rows))
    refuse_shape(name, array, allowed);
  return RealArray(array);
}

}  // namespace

RealArray points(const char* name, py::handle given) { return array_of_points(name, given, -1, "(n, 3)"); }

RealArray points(const char* name, py::handle given, Eigen::Index num_rows) {
  return array_of_points(name, given, num_rows, fmt::format("({}, 3)", num_rows));
}

std::vector<int> indices(const char* name, py::handle given, int count) {
  const py::array array = array_of(name, given, "iub", "integers, or booleans as a mask");
  if (array.ndim() != 1) refuse_shape(name, array, "(n,)");
  std::vector<int> found;
  if (array.size() > 0 && array.dtype().kind() == 'b') {
    if (array.shape(0) != count) refuse_shape(name, array, fmt::format("({},) for a mask", count));
    const py::array_t<bool, py::array::c_style | py::array::forcecast> mask(array);
    for (int i = 0; i < count; ++i)
      if (mask.data()[i]) found.push_back(i);
    return found;
  }
  const IntegerArray numbers(array);
  found.reserve(static_cast<std::size_t>(numbers.size()));
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const std::int64_t number = numbers.data()[i];
    if (number < 0 || number >= count)
      throw py::value_error(fmt::format("{}[{}] = {} must lie in [0, {})", name, i, number, count));
    found.push_back(static_cast<int>(number));
  }
  return found;
}

std::vector<Hexahedron> hexahedra(const char* name, py::handle given) {
  const py::array array = array_of(name, given, "iu", "integers");
  if (array.ndim() != 2 || array.shape(1) != kCorners) refuse_shape(name, array, "(m, 8)");
  const IntegerArray numbers(array);
  std::vector<Hexahedron> found(static_cast<std::size_t>(numbers.shape(0)));
  for (std::size_t e = 0; e < found.size(); ++e)
    for (int a = 0; a < kCorners; ++a) {
      const std::int64_t node = numbers.data()[e * kCorners + static_cast<std::size_t>(a)];
      if (node < 0 || node > std::numeric_limits<int>::max())
        throw py::value_error(fmt::format("{}[{}, {}] = {} is no node's number", name, e, a, node));
      found[e][static_cast<std::size_t>(a)] = static_cast<int>(node);
    }
  return found;
}

py::array ShownField::view(const PointArray& present) {
  if (!shown_) shown_ = std::make_shared<PointArray>(present);
  using Kept = std::shared_ptr<PointArray>;
  const py::capsule keeper(new Kept(shown_), [](void* memory) { delete static_cast<Kept*>(memory); });
  return python::view(*shown_, keeper);
}

void ShownField::refresh(const PointArray& present) {
  if (shown_ && shown_.use_count() == 1) shown_.reset();
  if (!shown_) return;
  if (shown_->rows() == present.rows())
    *shown_ = present;
  else
    shown_.reset();
}

py::array taken(PointArray field) {
  auto kept = std::make_unique<PointArray>(std::move(field));
  const PointArray& values = *kept;
  const py::capsule owner(kept.release(), [](void* memory) { delete static_cast<PointArray*>(memory); });
  return py::array_t<double>({values.rows(), values.cols()}, values.data(), owner);
}

py::array_t<int> cells_of(const std::vector<Hexahedron>& hexahedra) {
  py::array_t<int> cells({static_cast<py::ssize_t>(hexahedra.size()), static_cast<py::ssize_t>(kCorners)});
  std::copy_n(reinterpret_cast<const int*>(hexahedra.data()), cells.size(), cells.mutable_data());
  return cells;
}

}  // namespace hexaplast::python
