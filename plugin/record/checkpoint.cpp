// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/checkpoint.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

using Name = std::array<char, 8>;

constexpr Name kMagic = {'H', 'X', 'P', 'C', 'K', 'P', 'T', '\0'};
constexpr std::uint32_t kFormatVersion = 20;
constexpr std::size_t kNumKept = 2;

Name padded(std::string_view name) {
  Name bytes{};
  std::ranges::copy(name, bytes.begin());
  return bytes;
}

/// Passes on what `contents` writes, and its checksum.
void write_checked(const Archive::Sink& sink, const std::function<void(Archive&)>& contents) {
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) {
    sink(data, size);
    hash.add(data, size);
  });
  contents(archive);
  std::uint64_t checksum = hash.value();
  archive(checksum);
}

std::vector<std::byte> contents_of(const fs::path& file) {
  require_readable(file);
  std::vector<std::byte> bytes(fs::file_size(file));
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw OutputError(fmt::format("{}: cannot be read", file.string()));
  return bytes;
}

/// Reads the checksum that stands at the archive's place; it must be that of `bytes`.
void require_checksum(Archive& archive, std::span<const std::byte> bytes) {
  StateHash hash;
  hash.add(bytes.data(), bytes.size());
  std::uint64_t checksum = 0;
  archive(checksum);
  if (checksum != hash.value()) throw InputError("a checksum does not fit");
}

}  // namespace

void write_checkpoint(const Archive::Sink& sink, std::uint64_t scene_hash,
                      std::span<const CheckpointSection> sections) {
  write_checked(sink, [&](Archive& archive) {
    Name magic = kMagic;
    std::uint32_t version = kFormatVersion, count = static_cast<std::uint32_t>(sections.size());
    archive(magic, version, count, scene_hash);
  });
  for (const CheckpointSection& section : sections)
    write_checked(sink, [&](Archive& archive) {
      Name name = padded(section.name);
      std::uint64_t size = serialized_size(section.serialize);
      archive(name, size);
      section.serialize(archive);
    });
}

void write_checkpoint(const fs::path& directory, long step, std::uint64_t scene_hash,
                      std::span<const CheckpointSection> sections) {
  WholeFile file(directory / fmt::format("checkpoint_{:09}.hxc", step));
  write_checkpoint([&](const void* data, std::size_t size) { file.write(data, size); }, scene_hash, sections);
  file.commit();

  const std::vector<fs::path> all = checkpoints_in(directory);
  for (std::size_t i = kNumKept; i < all.size(); ++i)
    if (::unlink(all[i].c_str()) != 0) throw OutputError(all[i], "cannot be removed", errno);
}

Checkpoint::Checkpoint(fs::path file) : Checkpoint(file, contents_of(file)) {}

Checkpoint::Checkpoint(fs::path file, std::vector<std::byte> content)
    : file_(std::move(file)), bytes_(std::move(content)) {
  const std::span<const std::byte> all(bytes_);
  Archive archive(all);
  Name magic{};
  std::uint32_t version = 0, count = 0;
  const auto is_checkpoint = [&] {
    if (all.size() < sizeof magic) return false;
    archive(magic);
    return magic == kMagic;
  };
  if (!is_checkpoint()) throw InputError(fmt::format("{} is no checkpoint", file_.string()));
  try {
    archive(version, count, scene_hash_);
    if (version != kFormatVersion)
      throw InputError(fmt::format("{} has format version {}, must be {}", file_.string(), version, kFormatVersion));
    require_checksum(archive, all.first(archive.size()));
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t begin = archive.size();
      Name name{};
      std::uint64_t size = 0;
      archive(name, size);
      const std::span<const std::byte> bytes = archive.take(size);
      require_checksum(archive, all.subspan(begin, archive.size() - begin));
      sections_.push_back({std::string(name.begin(), std::ranges::find(name, '\0')), bytes});
    }
    if (archive.rest() != 0) throw InputError(fmt::format("{} bytes follow its end", archive.rest()));
  } catch (const InputError& error) {
    if (version != kFormatVersion && archive.size() >= sizeof magic + sizeof version) throw;
    throw InputError(fmt::format("{} is damaged: {}", file_.string(), error.what()));
  }
}

bool Checkpoint::has(std::string_view section) const {
  return std::ranges::count(sections_, section, &Section::name) > 0;
}

Archive Checkpoint::section(std::string_view name) const {
  const auto found = std::ranges::find(sections_, name, &Section::name);
  if (found == sections_.end()) throw InputError(fmt::format("{} has no section '{}'", file_.string(), name));
  return Archive(found->bytes);
}

std::vector<fs::path> checkpoints_in(const fs::path& directory) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error))
    if (is_numbered(entry->path().filename().string(), "checkpoint_", ".hxc")) found.push_back(entry->path());
  if (error) throw OutputError(fmt::format("{}: cannot be read: {}", directory.string(), error.message()));
  std::ranges::sort(found, [](const fs::path& a, const fs::path& b) { return number_at_end(a) > number_at_end(b); });
  return found;
}

}  // namespace hexaplast::output
