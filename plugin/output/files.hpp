// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"

namespace hexaplast::output {

/// Reading or writing failed; the message names the file and the system's reason. The runner exits with 5.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws OutputError with the reason where a file cannot be read.
void require_readable(const std::filesystem::path& file);

/// A file that is either there whole or not there at all: written as `<name>.part` beside its place, then flushed to
/// disk and renamed. A file that stood at its place before stays until then; what is not a regular file is refused.
/// Every failure is an OutputError.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path path);
  ~WholeFile();  ///< without commit(): removes the part
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();

 private:
  std::filesystem::path path_, part_;
  std::FILE* file_ = nullptr;
};

/// A text file that grows by whole lines; they have left the program when append() returns, so that a killed run keeps
/// them all.
class LineFile {
 public:
  /// Creates the file or empties it.
  explicit LineFile(std::filesystem::path path);

  /// Finds the length of a file that a checkpoint knows of; cut() before lines are appended there. Throws InputError
  /// when the file does not begin with the lines that were written then.
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

/// Ending of the names of unfinished files.
inline constexpr std::string_view kPart = ".part";

/// Creates `directory`, or checks that it can be written. Throws OutputError when the place is a file or cannot be
/// written.
void make_directory(const std::filesystem::path& directory);

/// Makes `directory` ready for a new run: creates it, or checks that it can be written and holds no earlier run; with
/// `force` the files of an earlier run (history.csv, removed.csv, frames/frame_N.png, plot.svg, manifest.json,
/// report.html, checkpoint_N.hxc; mesh.pvd and mesh_N.vtu, and the same of surface and instruments) are removed, others
/// stay. Throws OutputError, before anything is changed, when the place is a file, cannot be written, or holds an
/// earlier run and `force` is not set.
void prepare_directory(const std::filesystem::path& directory, bool force);

/// Makes the directory of a run ready to go on after `step`: removes what was left unfinished, and what only the end of
/// a run or later steps have written (pictures, plot.svg, states and checkpoints of later steps, as far as `is_kept`
/// does not want them). Throws OutputError when it cannot be written.
void prepare_to_go_on(const std::filesystem::path& directory, long step,
                      const std::function<bool(const std::string& name)>& is_kept);

/// Whether a file name is prefix, digits, suffix.
bool is_numbered(std::string_view name, std::string_view prefix, std::string_view suffix);

}  // namespace hexaplast::output
