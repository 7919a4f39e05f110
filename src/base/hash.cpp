// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/hash.hpp"

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace hexaplast {

struct StateHash::State {
  XXH64_state_t xxh;
};

StateHash::StateHash() : state_(std::make_unique<State>()) { XXH64_reset(&state_->xxh, 0); }
StateHash::~StateHash() = default;
StateHash::StateHash(StateHash&&) noexcept = default;

void StateHash::add(const void* data, std::size_t bytes) { XXH64_update(&state_->xxh, data, bytes); }

std::uint64_t StateHash::value() const { return XXH64_digest(&state_->xxh); }

std::string StateHash::text() const { return fmt::format("{:016x}", value()); }

}  // namespace hexaplast
