// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/archive.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

static_assert(std::endian::native == std::endian::little, "bytes are written as they are in memory");

void Archive::raw(void* data, std::size_t size) {
  if (reads_) {
    if (size > rest()) throw InputError(fmt::format("{} bytes are wanted where {} are left", size, rest()));
    if (size > 0) std::memcpy(data, bytes_.data() + size_, size);
  } else {
    sink_(data, size);
  }
  size_ += size;
}

std::span<const std::byte> Archive::take(std::size_t size) {
  if (size > rest()) throw InputError(fmt::format("{} bytes are wanted where {} are left", size, rest()));
  const auto taken = bytes_.subspan(size_, size);
  size_ += size;
  return taken;
}

std::size_t Archive::length(std::size_t present, std::size_t entry_size) {
  std::uint64_t length = present;
  raw(&length, sizeof length);
  if (reads_ && length > rest() / entry_size)
    throw InputError(fmt::format("a list of {} entries is announced where {} bytes are left", length, rest()));
  return length;
}

void Archive::one(bool& value) {
  unsigned char byte = value;
  raw(&byte, 1);
  if (byte > 1) throw InputError(fmt::format("{} stands where 0 or 1 must", byte));
  value = byte != 0;
}

void Archive::one(std::string& text) {
  text.resize(length(text.size(), 1));
  raw(text.data(), text.size());
}

void Archive::one(PointArray& rows) {
  const std::size_t count = length(static_cast<std::size_t>(rows.rows()), 3 * sizeof(double));
  rows.resize(static_cast<Eigen::Index>(count), 3);
  raw(rows.data(), static_cast<std::size_t>(rows.size()) * sizeof(double));
}

}  // namespace hexaplast
