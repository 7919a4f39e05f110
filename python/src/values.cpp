// SPDX-License-Identifier: LGPL-2.1-or-later
#include "values.hpp"

#include <fmt/format.h>

namespace hexaplast::python {
namespace {

template <class Number>
py::array array_of(const std::vector<Number>& numbers, attributes::Type type) {
  const py::array_t<Number> array(static_cast<py::ssize_t>(numbers.size()), numbers.data());
  const auto in_rows_of = [&](py::ssize_t columns) {
    return py::array_t<Number>(array).reshape(std::vector<py::ssize_t>{-1, columns});
  };
  switch (type) {
    case attributes::Type::kVectors3:
      return in_rows_of(3);
    case attributes::Type::kBoxes:
      return in_rows_of(6);
    case attributes::Type::kHexahedra:
      return in_rows_of(8);
    default:
      return array;
  }
}

}  // namespace

std::string scene_text(const char* what, py::handle value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::hasattr(value, "__iter__")) {
    std::string text;
    for (const py::handle entry : value) text += (text.empty() ? "" : " ") + scene_text(what, entry);
    return text;
  }
  if (PyIndex_Check(value.ptr())) return py::str(py::int_(py::reinterpret_borrow<py::object>(value)));
  if (PyNumber_Check(value.ptr()))
    return py::repr(py::float_(py::reinterpret_borrow<py::object>(value))).cast<std::string>();
  throw py::type_error(
      fmt::format("{}: {} is no number, text, or sequence of them", what, py::repr(value).cast<std::string>()));
}

py::object python_value(scene::Data& data) {
  const attributes::Type type = data.attribute().type;
  if (type == attributes::Type::kLink && !data.link().empty()) return py::str(data.link());
  const auto convert = [&](const auto& content) -> py::object {
    using Content = std::decay_t<decltype(content)>;
    if constexpr (std::is_same_v<Content, std::monostate>)
      return py::none();
    else if constexpr (std::is_arithmetic_v<Content> || std::is_same_v<Content, std::string>)
      return py::cast(content);
    else
      return array_of(content, type);
  };
  return std::visit(convert, data.value());
}

}  // namespace hexaplast::python
