// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// What an Archive takes as its bytes in memory: numbers, enumerators, fixed arrays and matrices of numbers.
template <class T>
inline constexpr bool kIsFlat = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T, std::size_t N>
inline constexpr bool kIsFlat<std::array<T, N>> = kIsFlat<T>;
template <class T, int R, int C, int O>
inline constexpr bool kIsFlat<Eigen::Matrix<T, R, C, O>> = kIsFlat<T>&& R > 0 && C > 0;

/// Writes values as bytes, or reads them back: a class lists its state once, for both directions.
///
///   void serialize(Archive& archive) { archive(time, positions, names, part_with_serialize); }
///
/// Little-endian; a list is preceded by its length (64 bits). What is read is checked against the bytes that are there
/// before anything is allocated. Not protected against damage: a checksum around it is (Body::save).
class Archive {
 public:
  using Sink = std::function<void(const void* data, std::size_t size)>;

  /// Writes to `sink`.
  explicit Archive(Sink sink) : sink_(std::move(sink)) {}

  /// Reads from bytes that outlive the archive.
  explicit Archive(std::span<const std::byte> bytes) : bytes_(bytes), reads_(true) {}

  bool reads() const { return reads_; }

  /// Bytes written or read so far.
  std::size_t size() const { return size_; }

  /// Bytes left to read.
  std::size_t rest() const { return bytes_.size() - size_; }

  /// Writes the values, or overwrites them by what was written. Throws InputError where bytes are missing.
  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

  /// As they are, without a length.
  void raw(void* data, std::size_t size);

  /// Reads the next `size` bytes as they are. Throws InputError where they are missing.
  std::span<const std::byte> take(std::size_t size);

 private:
  template <class T>
  void one(T& value) {
    if constexpr (kIsFlat<T>)
      raw(&value, sizeof(T));
    else
      value.serialize(*this);
  }
  template <class T>
  void one(std::vector<T>& values) {
    values.resize(length(values.size(), kIsFlat<T> ? sizeof(T) : 1));
    if constexpr (kIsFlat<T>)
      raw(values.data(), values.size() * sizeof(T));
    else
      for (T& value : values) one(value);
  }
  void one(bool& value);
  void one(std::string& text);
  void one(PointArray& rows);

  /// Passes on the length of a list whose entries take at least `entry_size` bytes each.
  std::size_t length(std::size_t present, std::size_t entry_size);

  Sink sink_;
  std::span<const std::byte> bytes_;
  bool reads_ = false;
  std::size_t size_ = 0;
};

/// The bytes that an archive of `serialize(Archive&)` takes.
template <class Serialize>
std::size_t serialized_size(const Serialize& serialize) {
  Archive counting([](const void*, std::size_t) {});
  serialize(counting);
  return counting.size();
}

}  // namespace hexaplast
