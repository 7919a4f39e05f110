// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hexaplast::output {

/// Reading or writing failed; the message names the file and the system's reason. The runner exits with 5.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

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
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  void append(std::string_view lines);  ///< one line, or several with a line feed between them

 private:
  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
};

/// Ending of the names of unfinished files.
inline constexpr std::string_view kPart = ".part";

/// Makes `directory` ready for a new run: creates it, or checks that it can be written and holds no earlier run; with
/// `force` the files of an earlier run (history.csv, removed.csv, mesh.pvd, mesh_N.vtu, frames/frame_N.png, plot.svg,
/// manifest.json, report.html) are removed, others stay. Throws OutputError, before anything is changed, when the place
/// is a file, cannot be written, or holds an earlier run and `force` is not set.
void prepare_directory(const std::filesystem::path& directory, bool force);

}  // namespace hexaplast::output
