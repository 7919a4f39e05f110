// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/names.hpp"

#include <fmt/format.h>

namespace hexaplast::view {

std::string Names::of(int hexahedron) const {
  std::string text;
  int first = 0;
  for (const Body& body : bodies)
    if (body.first_hexahedron <= hexahedron) {
      text = body.name + ", ";
      first = body.first_hexahedron;
    }
  if (!regions.names.empty())
    if (const int region = regions.of_hexahedra[static_cast<std::size_t>(hexahedron)]; region > 0)
      text += regions.names[static_cast<std::size_t>(region - 1)] + ", ";
  return text + fmt::format("hexahedron {}", hexahedron - first);
}

}  // namespace hexaplast::view
