// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_python_stubs TEMPLATE STUBS: writes the type stubs, in which classes made of rows stand as @Material@.
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "rows.hpp"

namespace hexaplast::python {
namespace {

template <class Options>
std::string stub(const char* name, std::span<const Row<Options>> rows) {
  std::string text = fmt::format("class {}:\n", name);
  for (const Row<Options>& row : rows) text += fmt::format("    {}: {}\n", row.member, python_type(row));
  text += "    def __init__(\n        self,\n        *,\n";
  for (const std::string& keyword : keywords(rows)) text += fmt::format("        {},\n", keyword);
  return text + "    ) -> None: ...";
}

void replace(std::string& text, const std::string& mark, const std::string& by) {
  const std::size_t at = text.find(mark);
  if (at == text.npos) throw std::runtime_error("the template has no " + mark);
  text.replace(at, mark.size(), by);
}

void write_stubs(const char* source, const char* target) {
  std::ifstream in(source);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  replace(text, "@Material@", stub("Material", material_rows()));
  replace(text, "@Settings@", stub("Settings", settings_rows()));
  std::ofstream out(target);
  if (!(out << text).flush()) throw std::runtime_error(std::string("cannot write ") + target);
}

}  // namespace
}  // namespace hexaplast::python

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::runtime_error("two files wanted: the template and the stubs");
    hexaplast::python::write_stubs(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hexaplast_python_stubs: error: %s\n", error.what());
    return 1;
  }
}
