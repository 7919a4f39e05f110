// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"

namespace hexaplast {

/// A text file that grows by whole lines; they have left the program when append() returns, so that a killed run keeps
/// them all. It is opened once, and written through that, whatever becomes of its name; without any, lines are refused.
class LineFile {
 public:
  /// Creates the file. Throws OutputError where something is there, be it a symbolic link.
  explicit LineFile(std::filesystem::path path);

  /// Finds the length of a file that a checkpoint knows of; cut() before lines are appended there. Throws OutputError
  /// where it cannot be read and written, is a symbolic link, or has other names, which would change with it; and
  /// InputError when it does not begin with the lines that were written then.
  LineFile(std::filesystem::path path, Archive& saved);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  void cut();                           ///< takes away what was written after the checkpoint
  void append(std::string_view lines);  ///< one line, or several with a line feed between them

  /// Flushes the lines to disk and writes down how many bytes they are, and their checksum.
  void save(Archive& archive);

 private:
  void add(std::string_view text);

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
  std::uint64_t size_ = 0;  // [byte]
  StateHash hash_;          // of all lines
};

}  // namespace hexaplast
