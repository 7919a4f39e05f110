// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/packed_numbers.hpp"

#include <zlib.h>

#include <limits>

#include "formats/base64.hpp"
#include "record/files.hpp"

namespace hexaplast::output {

template <class Number>
void PackedNumbers::append(std::string_view name, std::span<const Number> values, std::size_t stride) {
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

void PackedNumbers::add(std::string_view name, std::span<const std::uint8_t> values, std::size_t stride) {
  append(name, values, stride);
}
void PackedNumbers::add(std::string_view name, std::span<const std::uint16_t> values, std::size_t stride) {
  append(name, values, stride);
}
void PackedNumbers::add(std::string_view name, std::span<const std::uint32_t> values, std::size_t stride) {
  append(name, values, stride);
}

std::string PackedNumbers::base64() const {
  uLongf size = compressBound(bytes_.size());
  std::string deflated(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(deflated.data()), &size, reinterpret_cast<const Bytef*>(bytes_.data()),
                bytes_.size(), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw OutputError("the states of the viewer cannot be deflated");
  deflated.resize(size);
  return to_base64(deflated);
}

}  // namespace hexaplast::output
