// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "arrays.hpp"
#include "scene/object.hpp"

/// Values of a scene's attributes as Python has them.
namespace hexaplast::python {

/// As a scene file has it: numbers with all their digits, several with blanks between them. Throws TypeError, naming
/// `what`.
std::string scene_text(const char* what, py::handle value);

/// A number, text, or array of its own: (3,) of three numbers, (n, 3) of groups of them, (n, 6) of boxes, (n, 8) of
/// hexahedra; "@path" of a link to a component; None where nothing is given.
py::object python_value(scene::Data& data);

}  // namespace hexaplast::python
