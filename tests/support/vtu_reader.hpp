// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "formats/xml.hpp"
#include "support/output.hpp"

namespace hexaplast::support {

/// The arrays of a .vtu file as meshio, an independent reader, sees them.
inline std::map<std::string, std::string> read_with_meshio(const Scratch& scratch, const std::filesystem::path& file,
                                                           const std::vector<std::string>& names) {
  const std::string dump = (scratch / "dump").string();
  std::string command =
      "/usr/bin/python3 '" HEXAPLAST_TEST_DATA "/output/dump_vtu.py' '" + file.string() + "' '" + dump + "'";
  for (const std::string& name : names) command += " '" + name + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << "meshio cannot read " << file;

  std::map<std::string, std::string> arrays;
  std::ifstream in(dump, std::ios::binary);
  std::string name;
  for (std::size_t bytes = 0; in >> name >> bytes;) {
    in.get();
    arrays[name].resize(bytes);
    in.read(arrays[name].data(), static_cast<std::streamsize>(bytes));
  }
  return arrays;
}

template <class Numbers>
std::string bytes_of(const Numbers& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), sizeof(numbers.data()[0]) * numbers.size()};
}

/// Files that a .pvd file names, and their times; every one must be there.
inline std::vector<std::pair<double, std::filesystem::path>> series_in(const std::filesystem::path& directory,
                                                                       const std::string& name = "mesh.pvd") {
  const std::string text = content(directory / name);
  const XmlElement root = parse_xml(text).root;
  std::vector<std::pair<double, std::filesystem::path>> found;
  for (const XmlElement& entry : root.child("Collection")->children) {
    found.emplace_back(std::stod(std::string(entry.attribute("timestep"))), directory / entry.attribute("file"));
    EXPECT_TRUE(content(found.back().second).ends_with("</VTKFile>\n")) << found.back().second;
  }
  return found;
}

}  // namespace hexaplast::support
