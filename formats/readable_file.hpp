// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>

namespace hexaplast {

/// What keeps a file from being read: "no such file", "is not a file" (a folder, or a pipe or device, on which a reader
/// may wait for ever), or "cannot be read: " and the system's reason. Empty: it can be read.
std::string why_unreadable(const std::filesystem::path& file);

/// The whole content of a regular file. Throws InputError: "FILE: " and what keeps it from being read.
std::string whole_file(const std::filesystem::path& file);

}  // namespace hexaplast
