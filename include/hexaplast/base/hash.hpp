// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace hexaplast {

/// XXH64 (seed 0) over raw bytes: two runs with equal hashes computed the same bits.
class StateHash {
 public:
  StateHash();
  ~StateHash();
  StateHash(StateHash&&) noexcept;

  void add(const void* data, std::size_t bytes);

  std::uint64_t value() const;
  std::string text() const;  ///< 16 lower-case hexadecimal digits

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hexaplast
