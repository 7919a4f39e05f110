// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/shard.hpp"

#include <fmt/format.h>

#include <charconv>

#include "hexaplast/base/hash.hpp"
#include "runner/exit_code.hpp"

namespace hexaplast::runner {
namespace {

constexpr int kMaxShards = 100'000;

}  // namespace

bool Shard::has(const std::vector<std::string>& assignments) const {
  StateHash hash;
  for (const std::string& assignment : assignments) hash.add(assignment.c_str(), assignment.size() + 1);
  return hash.value() % static_cast<std::uint64_t>(count) == static_cast<std::uint64_t>(index - 1);
}

std::string Shard::text() const { return fmt::format("{}/{}", index, count); }

Shard parse_shard(std::string_view text) {
  Shard shard{0, 0};
  const char* end = text.data() + text.size();
  const auto [slash, no_index] = std::from_chars(text.data(), end, shard.index);
  bool is_well = no_index == std::errc() && slash != end && *slash == '/';
  if (is_well) {
    const auto [stop, no_count] = std::from_chars(slash + 1, end, shard.count);
    is_well = no_count == std::errc() && stop == end;
  }
  if (!is_well || shard.count < 1 || shard.count > kMaxShards || shard.index < 1 || shard.index > shard.count)
    throw UsageError(fmt::format("--shard {}: must be i/n with i from 1 to n, and n at most {}", text, kMaxShards));
  return shard;
}

}  // namespace hexaplast::runner
