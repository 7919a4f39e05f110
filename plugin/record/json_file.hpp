// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace hexaplast::output {

/// The content of a JSON file that a run or sweep has left, in a directory that a stranger may have filled: of more
/// than a million values, or a hundred in one another, nothing is kept. Throws OutputError where it cannot be read, and
/// nlohmann's exceptions where it is no such JSON.
nlohmann::ordered_json read_json(const std::filesystem::path& file);

}  // namespace hexaplast::output
