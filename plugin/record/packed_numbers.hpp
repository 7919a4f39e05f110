// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::output {

/// Arrays of unsigned integers in few bytes, for the script of a page.
///
/// An entry is replaced by its difference to the entry `stride` before it (to 0 at first), modulo the range of its
/// type, and that by 2 d for d >= 0 and -2 d - 1 for d < 0. Of an array follow the lowest bytes of all entries, then
/// the next ones. What all arrays have in common is deflated (zlib) and written in base64.
class PackedNumbers {
 public:
  struct Array {
    std::string name;
    int bits = 0;  ///< 8, 16 or 32
    std::size_t count = 0, stride = 0;
  };

  void add(std::string_view name, std::span<const std::uint8_t> values, std::size_t stride);
  void add(std::string_view name, std::span<const std::uint16_t> values, std::size_t stride);
  void add(std::string_view name, std::span<const std::uint32_t> values, std::size_t stride);

  const std::vector<Array>& arrays() const { return arrays_; }  ///< in their order
  std::string base64() const;

 private:
  template <class Number>
  void append(std::string_view name, std::span<const Number> values, std::size_t stride);

  std::vector<Array> arrays_;
  std::string bytes_;
};

}  // namespace hexaplast::output
