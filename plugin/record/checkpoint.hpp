// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/archive.hpp"

namespace hexaplast::output {

/// A part of a checkpoint.
struct CheckpointSection {
  std::string_view name;  ///< at most 8 bytes
  std::function<void(Archive&)> serialize;
};

/// The format of a checkpoint, little-endian, in bytes:
///
///   8  HXPCKPT and a zero          8  name of a section, padded with zeros
///   4  format version              8  size n of its contents
///   4  number of sections          n  contents: each list begins with its length (8 bytes)
///   8  XXH64 of the scene          8  XXH64 of name, size and contents
///   8  XXH64 of the bytes before   and so on for each section
void write_checkpoint(const Archive::Sink& sink, std::uint64_t scene_hash, std::span<const CheckpointSection> sections);

/// Writes checkpoint_<step>.hxc into the directory of a run, whole, and removes all but the newest two there. Throws
/// OutputError; what was there before is then still there.
void write_checkpoint(const std::filesystem::path& directory, long step, std::uint64_t scene_hash,
                      std::span<const CheckpointSection> sections);

/// A checkpoint that has been read and found undamaged.
class Checkpoint {
 public:
  /// Throws OutputError when the file cannot be read, InputError when it is no checkpoint, is of another format version
  /// or is damaged: every byte of it is covered by a checksum.
  explicit Checkpoint(std::filesystem::path file);

  /// The same from the content of one; messages call it `file`.
  Checkpoint(std::filesystem::path file, std::vector<std::byte> content);

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t scene_hash() const { return scene_hash_; }

  bool has(std::string_view section) const;

  /// Throws InputError where there is no such section. The archive must not outlive this.
  Archive section(std::string_view name) const;

 private:
  struct Section {
    std::string name;
    std::span<const std::byte> bytes;
  };

  std::filesystem::path file_;
  std::vector<std::byte> bytes_;
  std::uint64_t scene_hash_ = 0;
  std::vector<Section> sections_;
};

/// The checkpoints in the directory of a run, the newest first.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& directory);

}  // namespace hexaplast::output
