// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/json_file.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "record/files.hpp"

namespace hexaplast::output {

// A value costs up to 80 bytes of memory, however few it takes in the file.
nlohmann::ordered_json read_json(const std::filesystem::path& file) {
  using Parsed = nlohmann::ordered_json;
  constexpr long kMaxValues = 1'000'000;
  constexpr int kMaxLevels = 100;
  require_readable(file);
  std::ifstream in(file);
  long num_values = 0;
  return Parsed::parse(in, [&](int level, Parsed::parse_event_t event, Parsed&) {
    const bool opens = event == Parsed::parse_event_t::object_start || event == Parsed::parse_event_t::array_start;
    if (opens || event == Parsed::parse_event_t::value) ++num_values;
    if (num_values > kMaxValues || (opens && level >= kMaxLevels))
      throw Parsed::other_error::create(599, "more than a million values, or a hundred in one another", nullptr);
    return true;
  });
}

}  // namespace hexaplast::output
