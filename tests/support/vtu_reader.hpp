// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <tinyxml2.h>

#include <map>

#include "support/output.hpp"

namespace hexaplast::support {

/// The arrays of a .vtu file as meshio, an independent reader, sees them.
inline std::map<std::string, std::string> read_with_meshio(const Scratch& scratch, const std::filesystem::path& file,
                                                           std::vector<std::string> names) {
  const std::string dump = (scratch / "dump").string();
  std::vector<std::string> words{"/usr/bin/python3", HEXAPLAST_TEST_DATA "/output/dump_vtu.py", file.string(), dump};
  words.insert(words.end(), names.begin(), names.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  pid_t child = 0;
  int status = -1;
  if (::posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) return {};
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << "meshio cannot read " << file;

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
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.LoadFile((directory / name).c_str()), tinyxml2::XML_SUCCESS);
  std::vector<std::pair<double, std::filesystem::path>> found;
  const tinyxml2::XMLElement* entry =
      document.RootElement()->FirstChildElement("Collection")->FirstChildElement("DataSet");
  for (; entry; entry = entry->NextSiblingElement("DataSet")) {
    found.emplace_back(entry->DoubleAttribute("timestep"), directory / entry->Attribute("file"));
    EXPECT_TRUE(content(found.back().second).ends_with("</VTKFile>\n")) << found.back().second;
  }
  return found;
}

}  // namespace hexaplast::support
