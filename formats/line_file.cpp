// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/line_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "formats/readable_file.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast {
namespace fs = std::filesystem;
namespace {

/// With the flags of open(2) and the mode of fdopen(3). What a link leads to, and what another name of the file belongs
/// to, lies elsewhere.
std::FILE* open_here(const fs::path& path, int flags, const char* mode) {
  const int handle = ::open(path.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (handle < 0) {
    const int reason = errno;
    std::error_code unknown;
    if (fs::is_symlink(path, unknown)) throw OutputError(path.string() + kIsLink);
    throw OutputError(path, "cannot be opened for writing", reason);
  }
  std::FILE* file = ::fdopen(handle, mode);
  if (!file) throw OutputError(path, "cannot be opened for writing", errno);
  struct stat found {};
  if (::fstat(handle, &found) != 0 || found.st_nlink > 1) {
    std::fclose(file);
    throw OutputError(path.string() + ": has other names, which would change with it");
  }
  return file;
}

}  // namespace

LineFile::LineFile(fs::path path)
    : path_(std::move(path)), file_(open_here(path_, O_WRONLY | O_CREAT | O_EXCL, "wb")) {}

LineFile::LineFile(fs::path path, Archive& saved) : path_(std::move(path)) {
  std::uint64_t size = 0, checksum = 0;
  saved(size, checksum);
  if (const std::string reason = why_unreadable(path_); !reason.empty())
    throw OutputError(fmt::format("{}: {}", path_.string(), reason));
  file_ = open_here(path_, O_RDWR, "r+b");

  std::array<char, 65536> buffer;
  while (size_ < size) {
    const std::size_t found = std::fread(buffer.data(), 1, std::min<std::uint64_t>(buffer.size(), size - size_), file_);
    if (found == 0) break;
    hash_.add(buffer.data(), found);
    size_ += found;
  }
  if (size_ < size || hash_.value() != checksum) {
    std::fclose(file_);
    throw InputError(fmt::format("{} does not begin with the {} bytes that the run had written at the checkpoint",
                                 path_.string(), size));
  }
}

LineFile::~LineFile() { std::fclose(file_); }

void LineFile::cut() {
  if (::ftruncate(::fileno(file_), static_cast<off_t>(size_)) != 0 || std::fseek(file_, 0, SEEK_END) != 0)
    throw OutputError(path_, "cannot be written", errno);
}

void LineFile::append(std::string_view lines) {
  add(lines);
  add("\n");
  if (std::fflush(file_) != 0) throw OutputError(path_, "cannot be written", errno);
  struct stat ours {};
  if (::fstat(::fileno(file_), &ours) == 0 && ours.st_nlink == 0)
    throw OutputError(path_.string() + ": has been taken away while it was written");
}

void LineFile::add(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size())
    throw OutputError(path_, "cannot be written", errno);
  size_ += text.size();
  hash_.add(text.data(), text.size());
}

void LineFile::save(Archive& archive) {
  if (::fsync(::fileno(file_)) != 0) throw OutputError(path_, "cannot be written", errno);
  std::uint64_t checksum = hash_.value();
  archive(size_, checksum);
}

}  // namespace hexaplast
