// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/abaqus_deck.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "hexaplast/formats/mesh_export.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace {

constexpr std::size_t kNumbersPerLine = 16;  // the most that the format allows

/// ccx reads no more than 20 characters of a number: twelve digits fit with sign and exponent.
std::string number(double value) { return fmt::format("{:.12g}", value); }

std::string list(const std::vector<int>& indices) {
  std::string lines;
  for (std::size_t begin = 0; begin < indices.size(); begin += kNumbersPerLine) {
    const auto from = indices.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = from + static_cast<std::ptrdiff_t>(std::min(kNumbersPerLine, indices.size() - begin));
    lines += fmt::format("{}\n", fmt::join(from, to, ", "));
  }
  return lines;
}

std::string material_lines(const Bodies& bodies) {
  std::map<std::pair<double, double>, std::vector<int>> elements_of;  // by Young's modulus and Poisson's ratio
  std::string lines;
  for (const Bodies::Entry& entry : bodies.all()) {
    const int first = entry.first_hexahedron + 1, num_elements = entry.body->mesh().num_elements();
    for (int e = 0; e < num_elements; ++e) {
      const Material& m = entry.body->material(e);
      elements_of[{m.young_modulus, m.poisson_ratio}].push_back(first + e);
    }
    if (!bodies.is_one())
      lines += fmt::format("*ELSET, ELSET=BODY_{}, GENERATE\n{}, {}\n", entry.name, first, first + num_elements - 1);
  }

  int count = 0;
  for (const auto& [constants, elements] : elements_of) {
    const std::string name = fmt::format("MATERIAL{}", ++count);
    lines += fmt::format("*ELSET, ELSET={}\n{}", name, list(elements));
    lines +=
        fmt::format("*MATERIAL, NAME={}\n*ELASTIC\n{}, {}\n", name, number(constants.first), number(constants.second));
    lines += fmt::format("*SOLID SECTION, ELSET={0}, MATERIAL={0}\n", name);
  }
  return lines;
}

std::string boundary_lines(const PointArray& is_free) {
  std::vector<int> fixed;
  std::string single;  // degrees of freedom of nodes that are held in part
  for (int n = 0; n < static_cast<int>(is_free.rows()); ++n) {
    if (is_free.row(n).isZero(0)) {
      fixed.push_back(n + 1);
      continue;
    }
    for (int axis = 0; axis < 3; ++axis)
      if (is_free(n, axis) == 0) single += fmt::format("{0}, {1}, {1}\n", n + 1, axis + 1);
  }
  std::string lines;
  if (!fixed.empty()) lines += fmt::format("*NSET, NSET=FIXED\n{}", list(fixed));
  if (!fixed.empty() || !single.empty()) lines += "*BOUNDARY\n";
  if (!fixed.empty()) lines += "FIXED, 1, 3\n";
  return lines + single;
}

std::string load_lines(const AbaqusDeck& deck) {
  std::string lines;
  for (int n = 0; n < static_cast<int>(deck.loads.rows()); ++n)
    for (int axis = 0; axis < 3; ++axis)
      if (deck.loads(n, axis) != 0 && deck.is_free(n, axis) != 0)
        lines += fmt::format("{}, {}, {}\n", n + 1, axis + 1, number(deck.loads(n, axis)));
  return lines.empty() ? ""
                       : fmt::format("** Loads at t = {:.6g} s on the undeformed body\n*CLOAD\n", deck.time) + lines;
}

}  // namespace

void write_abaqus_deck(const std::filesystem::path& file, const Bodies& bodies, const AbaqusDeck& deck) {
  WholeFile out(file);
  out.write(fmt::format("*HEADING\n{}\n", deck.title));
  const PointArray& x = bodies.mesh().positions();
  out.write(
      abaqus_text({.points = {x.data(), static_cast<std::size_t>(x.size())}, .hexahedra = bodies.mesh().hexahedra()}));
  out.write(material_lines(bodies));
  out.write(boundary_lines(deck.is_free));
  // the first increment is a tenth of the load; the program shortens it where it has to
  out.write("*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1\n");
  out.write(load_lines(deck));
  out.write("*NODE PRINT, NSET=ALL\nU\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n");
  out.commit();
}

}  // namespace hexaplast::output
