// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/formats/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>

namespace hexaplast {
namespace fs = std::filesystem;
namespace {

std::optional<std::pair<std::uint64_t, std::uint64_t>> identity_of(const fs::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return std::nullopt;
  return std::pair<std::uint64_t, std::uint64_t>(found.st_dev, found.st_ino);
}

/// A rename is on disk only when its directory is. Some file systems cannot do that: the file itself is safe even then.
void sync_directory(const fs::path& directory) {
  const int handle = ::open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  ::fsync(handle);
  ::close(handle);
}

/// A mode that no file has by itself, and that makes no difference to one: parts have it from their first moment
/// until they are finished, so that what a killed run has left is told from a stranger's file.
constexpr mode_t kUnfinished = S_ISVTX;

/// Takes away what a killed run has left under the name of an unfinished file. Whoever is still writing holds a lock.
void remove_leftover(const fs::path& part) {
  struct stat found {};
  if (::lstat(part.c_str(), &found) != 0) return;
  if (S_ISLNK(found.st_mode)) throw OutputError(part.string() + kIsLink);
  if (!S_ISREG(found.st_mode)) throw OutputError(part.string() + ": is not a regular file and will not be replaced");
  if (!(found.st_mode & kUnfinished))
    throw OutputError(part.string() + ": is in the way, and no unfinished file of a run: give it another name");
  const int handle = ::open(part.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  const bool is_in_use = handle >= 0 && ::flock(handle, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!is_in_use && ::unlink(part.c_str()) != 0) throw OutputError(part, "cannot be removed", errno);
  if (handle >= 0) ::close(handle);
  if (is_in_use) throw OutputError(part.string() + ": is being written by another program, or by another option");
}

/// A new file, never one that is there: nobody else chooses where the writing goes.
int create_part(const fs::path& part) {
  const auto create = [&] {
    return ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666 | kUnfinished);
  };
  int handle = create();
  if (handle < 0 && errno == EEXIST) {
    remove_leftover(part);
    handle = create();
  }
  if (handle < 0) throw OutputError(part, "cannot be created", errno);
  ::flock(handle, LOCK_EX | LOCK_NB);  // where the file system knows locks
  return handle;
}

/// A link on the way from a directory to a file below it; empty where there is none, or the file does not lie below.
fs::path link_below(const fs::path& directory, const fs::path& file) {
  std::error_code unknown;
  fs::path link;
  for (fs::path place = fs::absolute(file); !fs::equivalent(place, directory, unknown); place = place.parent_path()) {
    if (place == place.parent_path()) return {};
    if (fs::is_symlink(place, unknown)) link = place;
  }
  return link;
}

/// What a symbolic link leads to, there or not. Links of the system's to what is open lead to no name: what lies there
/// would be replaced under the hands of whoever has it open.
fs::path end_of_links(const fs::path& link) {
  constexpr int kMaxLinks = 40;  // as the system has it
  std::error_code unknown;
  fs::path place = link;
  for (int count = 0; fs::is_symlink(place, unknown); ++count) {
    const fs::path folder = fs::weakly_canonical(fs::absolute(place).parent_path());
    if (folder == "/dev" || (folder.string() + "/").starts_with("/proc/"))
      throw OutputError(link.string() +
                        ": is a link of the system's to what is open, not a file: name the file itself");
    if (count == kMaxLinks) throw OutputError(link, "cannot be reached", ELOOP);
    place = folder / fs::read_symlink(place);
  }
  return fs::weakly_canonical(place);
}

}  // namespace

OutputError::OutputError(const fs::path& file, std::string_view what, int error)
    : OutputError(fmt::format("{}: {}: {}", file.string(), what, std::strerror(error))) {}

void InputFiles::add(const fs::path& file) {
  if (const auto identity = identity_of(file)) files_.insert(*identity);
}

fs::path InputFiles::replaced_by(const fs::path& output) const {
  for (const fs::path& written : {output, part_of(output)})
    if (const auto identity = identity_of(written); identity && files_.contains(*identity)) return written;
  return {};
}

fs::path output_place(const fs::path& file, const InputFiles& inputs, const std::vector<fs::path>& runs) {
  std::error_code error;
  const fs::path place = fs::is_symlink(file, error) ? end_of_links(file) : file;
  if (const fs::path input = inputs.replaced_by(place); !input.empty())
    throw OutputError((input == place ? file : input).string() + ": is an input, and will not be written over");
  for (const fs::path& run : runs)
    if (const fs::path link = link_below(run, file); !link.empty()) throw OutputError(link.string() + kIsLink);
  if (without_part(place.string()) != place.string())
    throw OutputError(fmt::format("{}: ends in {}, as the names of unfinished files do", place.string(), kPart));
  return place;
}

WholeFile::WholeFile(fs::path path) : path_(std::move(path)), part_(part_of(path_)) {
  // a link at the place is replaced; a device, a pipe or a directory must not be
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path_, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_symlink(status))
    throw OutputError(path_.string() + ": is not a regular file and will not be replaced");
  file_ = ::fdopen(create_part(part_), "wb");
  if (!file_) throw OutputError(part_, "cannot be created", errno);
}

WholeFile::~WholeFile() {
  if (!file_) return;
  std::fclose(file_);
  ::unlink(part_.c_str());
}

void WholeFile::write(const void* data, std::size_t bytes) {
  if (bytes > 0 && std::fwrite(data, 1, bytes, file_) != bytes) throw OutputError(part_, "cannot be written", errno);
}

int WholeFile::descriptor() const { return ::fileno(file_); }

void WholeFile::commit() {
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) throw OutputError(part_, "cannot be written", errno);
  struct stat ours {
  }, there{};
  const bool is_ours = ::fstat(::fileno(file_), &ours) == 0 && ::lstat(part_.c_str(), &there) == 0 &&
                       ours.st_dev == there.st_dev && ours.st_ino == there.st_ino;
  if (!is_ours) throw OutputError(part_.string() + ": has been taken away while it was written");
  if (::rename(part_.c_str(), path_.c_str()) != 0) throw OutputError(path_, "cannot be put in place", errno);
  ::fchmod(::fileno(file_), ours.st_mode & 07777 & ~kUnfinished);  // not before: what a kill leaves has it
  std::fclose(file_);
  file_ = nullptr;
  sync_directory(path_.parent_path());
}

}  // namespace hexaplast
