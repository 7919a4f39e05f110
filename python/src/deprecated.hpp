// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

namespace hexaplast::python {

/// A DeprecationWarning; throws where the caller turns warnings into errors.
inline void warn_deprecated(const char* old_name, const char* name) {
  const std::string message = fmt::format("{} is deprecated: use {}", old_name, name);
  if (PyErr_WarnEx(PyExc_DeprecationWarning, message.c_str(), 1) != 0) throw pybind11::error_already_set();
}

}  // namespace hexaplast::python
