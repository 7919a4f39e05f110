// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/saved_stream.hpp"

#include <fmt/format.h>

#include <istream>
#include <ostream>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"

namespace hexaplast {

namespace {

void read_exactly(std::istream& in, const SavedKind& kind, void* data, std::size_t size) {
  in.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
  if (static_cast<std::size_t>(in.gcount()) != size)
    throw InputError(
        fmt::format("a saved {} ends {} bytes too early", kind.name, size - static_cast<std::size_t>(in.gcount())));
}

}  // namespace

void write_saved(std::ostream& out, const SavedKind& kind, std::uint64_t identity,
                 const std::function<void(Archive&)>& contents) {
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) {
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    hash.add(data, size);
  });
  SavedKind written = kind;
  std::uint64_t size = serialized_size(contents);
  archive(written.magic, written.version, identity, size);
  contents(archive);
  std::uint64_t checksum = hash.value();
  archive(checksum);
  if (!out) throw InputError(fmt::format("the stream does not take a saved {}", kind.name));
}

std::vector<std::byte> read_saved(std::istream& in, const SavedKind& kind, std::uint64_t identity, std::size_t max) {
  std::array<std::byte, sizeof kind.magic + sizeof kind.version + 2 * sizeof(std::uint64_t)> header;
  read_exactly(in, kind, header.data(), header.size());
  SavedKind found = kind;
  std::uint64_t of = 0, size = 0, checksum = 0;
  Archive head{std::span<const std::byte>(header)};
  head(found.magic, found.version, of, size);
  if (found.magic != kind.magic) throw InputError(fmt::format("this is no saved {}", kind.name));
  if (found.version != kind.version)
    throw InputError(
        fmt::format("the saved {} has format version {}, must be {}", kind.name, found.version, kind.version));
  if (of != identity)
    throw InputError(fmt::format("the saved {} is of another mesh, or of another version", kind.name));
  if (size > max) throw InputError(fmt::format("the saved {} is damaged: {} bytes are announced", kind.name, size));

  std::vector<std::byte> bytes(size);
  read_exactly(in, kind, bytes.data(), bytes.size());
  read_exactly(in, kind, &checksum, sizeof checksum);
  StateHash hash;
  hash.add(header.data(), header.size());
  hash.add(bytes.data(), bytes.size());
  if (hash.value() != checksum)
    throw InputError(fmt::format("the saved {} is damaged: its checksum does not fit", kind.name));
  return bytes;
}

}  // namespace hexaplast
