// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "hexaplast/base/archive.hpp"

namespace hexaplast::support {

/// What serialize writes.
template <class T>
std::vector<std::byte> written(T& object) {
  std::vector<std::byte> bytes;
  Archive archive([&](const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
  });
  object.serialize(archive);
  return bytes;
}

template <class T>
void read_from(const std::vector<std::byte>& bytes, T& object) {
  Archive archive{std::span<const std::byte>(bytes)};
  object.serialize(archive);
}

/// What save writes.
template <class T>
std::string saved(const T& object) {
  std::ostringstream out;
  object.save(out);
  return out.str();
}

/// What follows stays in the stream.
template <class T>
void load(T& object, const std::string& bytes) {
  std::istringstream in(bytes + "next");
  object.load(in);
  std::string rest;
  in >> rest;
  EXPECT_EQ(rest, "next");
}

}  // namespace hexaplast::support
