// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
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

  template <std::unsigned_integral Number>
  void add(std::string_view name, const std::vector<Number>& values, std::size_t stride) {
    constexpr int kBits = std::numeric_limits<Number>::digits;
    arrays_.push_back({std::string(name), kBits, values.size(), stride});
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + values.size() * sizeof(Number));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto difference = static_cast<Number>(values[i] - (i < stride ? Number(0) : values[i - stride]));
      const bool is_negative = (difference >> (kBits - 1)) != 0;
      const auto doubled = static_cast<Number>(difference << 1);
      const auto folded = is_negative ? static_cast<Number>(~doubled) : doubled;
      for (std::size_t byte = 0; byte < sizeof(Number); ++byte)
        bytes_[begin + byte * values.size() + i] = static_cast<char>((folded >> (8 * byte)) & 0xff);
    }
  }
  const std::vector<Array>& arrays() const { return arrays_; }  ///< in their order
  std::string base64() const;

 private:
  std::vector<Array> arrays_;
  std::string bytes_;
};

}  // namespace hexaplast::output
