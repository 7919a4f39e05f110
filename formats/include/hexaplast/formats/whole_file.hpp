// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hexaplast {

/// Reading or writing failed; the message names the file and the system's reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  OutputError(const std::filesystem::path& file, std::string_view what, int error);  ///< error: errno
};

/// What is said behind the name of a symbolic link in a place where somebody else may have made it.
inline constexpr const char* kIsLink = ": is a symbolic link, which is not followed here";

/// Files that are read, and so are never written over: known by what they are (device and inode), whatever names and
/// links lead to them.
class InputFiles {
 public:
  InputFiles() = default;
  explicit InputFiles(const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& file : files) add(file);
  }
  void add(const std::filesystem::path& file);  ///< nothing where there is none

  /// The one that is lost where `output` is written, be it as its unfinished file; empty: none.
  std::filesystem::path replaced_by(const std::filesystem::path& output) const;

 private:
  std::set<std::pair<std::uint64_t, std::uint64_t>> files_;
};

/// The file that a name from a command line stands for: where a symbolic link is there, the one that it leads to.
/// Throws OutputError where one of `inputs` would be lost, for the name of an unfinished file, and for a link below one
/// of `runs`, directories that a stranger may have filled.
std::filesystem::path output_place(const std::filesystem::path& file, const InputFiles& inputs = {},
                                   const std::vector<std::filesystem::path>& runs = {});

/// Ending of the names of unfinished files.
inline constexpr std::string_view kPart = ".part";

/// The unfinished file of one.
inline std::filesystem::path part_of(std::filesystem::path file) { return file += kPart; }

/// The name that an unfinished file is to have; every other one as it is.
inline std::string_view without_part(std::string_view name) {
  return name.ends_with(kPart) ? name.substr(0, name.size() - kPart.size()) : name;
}

/// A file that is either there whole or not there at all: written as `<name>.part` beside its place, then flushed to
/// disk and renamed. A file or symbolic link that stood at its place before stays until then, and links are never
/// followed; what is neither is refused. The part is always a new file. One that a killed run has left is removed, but
/// not one that somebody is writing, nor a file of that name that is none of ours. Every failure is an OutputError.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path path);
  ~WholeFile();  ///< without commit(): removes the part
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();

  int descriptor() const;  ///< of the unfinished file, for another program to write it

 private:
  std::filesystem::path path_, part_;
  std::FILE* file_ = nullptr;
};

}  // namespace hexaplast
