// SPDX-License-Identifier: LGPL-2.1-or-later
#include "volume_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

constexpr double kMaxInflation = 1032;       // no byte of zlib's stands for more than this many
constexpr std::size_t kBuffer = 1 << 16;     // [byte]
constexpr std::size_t kMaxHeader = 1 << 20;  // [byte] of a text header
constexpr int kGzipOrZlib = MAX_WBITS + 32;  // for zlib: the header tells which of the two it is

/// What make() returns. Its refusals begin with the name.
template <class Make>
auto named(const std::string& name, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace

ByteSource::ByteSource(std::string_view content, bool is_compressed, std::string name)
    : content_(content), name_(std::move(name)), is_compressed_(is_compressed), num_left_(content.size()) {
  stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));  // which zlib only reads
  if (is_compressed && inflateInit2(&stream_, kGzipOrZlib) != Z_OK) throw std::bad_alloc();
}

ByteSource::~ByteSource() { inflateEnd(&stream_); }

void ByteSource::refuse(const std::string& what) const { throw InputError(fmt::format("{}: {}", name_, what)); }

void ByteSource::require_room_for(double bytes) const {
  const std::size_t rest = content_.size() - (is_compressed_ ? 0 : num_read_);
  const double max = static_cast<double>(rest) * (is_compressed_ ? kMaxInflation : 1);
  if (bytes > max)
    refuse(fmt::format("{:.10g} bytes of voxels cannot come from {} bytes of {}data", bytes, rest,
                       is_compressed_ ? "compressed " : ""));
}

std::size_t ByteSource::read_some(char* to, std::size_t bytes) {
  if (!is_compressed_) {
    const std::size_t count = std::min(bytes, content_.size() - num_read_);
    std::memcpy(to, content_.data() + num_read_, count);
    num_read_ += count;
    return count;
  }
  stream_.next_out = reinterpret_cast<Bytef*>(to);
  stream_.avail_out = static_cast<uInt>(bytes);
  while (stream_.avail_out > 0 && !is_at_end_) {
    if (stream_.avail_in == 0) {
      stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(num_left_, 1 << 30));
      num_left_ -= stream_.avail_in;
    }
    const int status = inflate(&stream_, Z_NO_FLUSH);
    const std::size_t rest = num_left_ + stream_.avail_in;
    if (status == Z_STREAM_END)  // a gzip file may be several, one after the other
      is_at_end_ = rest == 0 || inflateReset(&stream_) != Z_OK;
    else if (status == Z_BUF_ERROR && rest == 0)
      refuse(fmt::format("the compressed data are cut off after byte {} of the voxels and what is before them",
                         num_read_ + bytes - stream_.avail_out));
    else if (status != Z_OK && status != Z_BUF_ERROR)
      refuse(fmt::format("the compressed data are damaged after {} bytes: {}", content_.size() - rest,
                         stream_.msg ? stream_.msg : "no reason given"));
  }
  const std::size_t count = bytes - stream_.avail_out;
  num_read_ += count;
  return count;
}

void ByteSource::read(char* to, std::size_t bytes) {
  const std::size_t wanted = num_read_ + bytes;
  if (read_some(to, bytes) < bytes)
    refuse(fmt::format("the data end after {} bytes, must be at least {}", num_read_, wanted));
}

void ByteSource::expect_end() {
  char more;
  if (read_some(&more, 1) > 0) refuse(fmt::format("the data go on after the last voxel, at byte {}", num_read_ - 1));
}

bool is_gzip(std::string_view content) { return content.starts_with("\x1f\x8b"); }

LabelledVolume read_voxels(const VolumeGeometry& geometry, const NumberType& type, ByteSource& source,
                           const std::string& name, const VoxelCells& planned) {
  const auto nx = geometry.size[0], ny = geometry.size[1], nz = geometry.size[2];
  const double size = static_cast<double>(nx) * static_cast<double>(ny) * static_cast<double>(nz);
  source.require_room_for(std::min(size, kMaxVoxels + 1) * static_cast<double>(type.bytes));
  if (size > kMaxVoxels)
    throw InputError(
        fmt::format("{}: {} x {} x {} voxels: must be at most {:.10g} in all", name, nx, ny, nz, kMaxVoxels));
  LabelledVolume volume = named(name + ": " + geometry.axes_field, [&] {
    return LabelledVolume({static_cast<int>(nx), static_cast<int>(ny), static_cast<int>(nz)}, geometry.axes,
                          geometry.origin);
  });

  std::vector<char> buffer(kBuffer);
  const std::vector<char> zeros(kBuffer, 0);
  const auto set_labels = [&](std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto label = number_at<double>(buffer.data() + i * type.bytes, type, type.swaps_bytes);
      if (label == 0) continue;
      constexpr int kMin = std::numeric_limits<int>::min(), kMax = std::numeric_limits<int>::max();
      if (!(label >= kMin && label <= kMax && label == std::floor(label)))
        throw InputError(fmt::format("voxel {} has the label {:.10g}, must be a whole number in [{}, {}]", first + i,
                                     label, kMin, kMax));
      volume.set(first + i, static_cast<int>(label));
    }
    require_feasible(volume, planned);
  };
  for (std::size_t voxel = 0; voxel < volume.num_voxels();) {
    const std::size_t count = std::min(kBuffer / type.bytes, volume.num_voxels() - voxel);
    source.read(buffer.data(), count * type.bytes);
    if (std::memcmp(buffer.data(), zeros.data(), count * type.bytes) != 0)
      named(name, [&] { set_labels(voxel, count); });
    voxel += count;
  }
  source.expect_end();
  return volume;
}

void flip(VolumeGeometry& geometry, const Vec3& signs) {
  geometry.axes = signs.asDiagonal() * geometry.axes;
  geometry.origin = signs.cwiseProduct(geometry.origin);
}

TextHeader::TextHeader(std::string_view content, std::string name)
    : content_(content), name_(std::move(name)), lines_(content.substr(0, kMaxHeader), name_) {}

bool TextHeader::next_line(std::string_view& text) {
  ++line_;
  if (lines_.at_end()) return false;
  text = lines_.line();
  if (lines_.at_end() && content_.size() > kMaxHeader)
    refuse_line(fmt::format("the header is longer than {} bytes", kMaxHeader));
  return true;
}

std::string_view TextHeader::rest() const {
  return content_.substr(std::min(content_.size(), kMaxHeader) - lines_.remaining());
}

void TextHeader::add(std::string_view field, std::string_view value) {
  const auto [found, is_new] = values_.try_emplace(in_small_letters(field), Value{std::string(value), line_});
  if (!is_new)
    refuse_line(fmt::format("'{}' is given again, the first time in line {}", excerpt(field), found->second.line));
}

const std::string* TextHeader::find(const std::string& field) const {
  const auto found = values_.find(in_small_letters(field));
  return found == values_.end() ? nullptr : &found->second.text;
}

const std::string& TextHeader::value(const std::string& field) const {
  if (const std::string* found = find(field)) return *found;
  throw InputError(fmt::format("{}: the header has no '{}'", name_, field));
}

void TextHeader::expect(const std::string& field, const char* wanted) const {
  const std::string* found = find(field);
  if (found && in_small_letters(*found) != in_small_letters(wanted)) refuse(field, fmt::format("must be {}", wanted));
}

std::vector<std::string_view> TextHeader::words(const std::string& field) const {
  std::vector<std::string_view> all;
  MeshSource source(value(field), name_);
  for (std::string_view word = source.word(); !word.empty(); word = source.word()) all.push_back(word);
  return all;
}

std::vector<double> TextHeader::reals(const std::string& field, std::size_t count) const {
  const std::vector<std::string_view> all = words(field);
  std::vector<double> numbers(all.size());
  bool is_right = all.size() == count;
  for (std::size_t i = 0; i < all.size(); ++i) is_right = is_right && read_number(all[i], numbers[i]);
  if (!is_right) refuse(field, fmt::format("must be {} finite numbers", count));
  return numbers;
}

Vec3 TextHeader::spacing(const std::string& field) const {
  const Vec3 spacing(reals(field, 3).data());
  if (!(spacing.minCoeff() > 0)) refuse(field, "must be 3 numbers greater than 0");
  return spacing;
}

std::array<std::int64_t, 3> TextHeader::size(const std::string& field) const {
  const std::vector<std::string_view> all = words(field);
  std::array<std::int64_t, 3> size{};
  bool is_right = all.size() == 3;
  for (std::size_t d = 0; is_right && d < 3; ++d)
    is_right = read_number(all[d], size[d]) && size[d] >= 1 && size[d] <= std::numeric_limits<int>::max();
  if (!is_right) refuse(field, fmt::format("must be 3 whole numbers in [1, {}]", std::numeric_limits<int>::max()));
  return size;
}

void TextHeader::refuse(const std::string& field, const std::string& what) const {
  const auto found = values_.find(in_small_letters(field));
  if (found == values_.end()) throw InputError(fmt::format("{}: {}: {}", name_, field, what));
  const auto& [text, line] = found->second;
  throw InputError(fmt::format("{}:{}: {} '{}': {}", name_, line, field, excerpt(text), what));
}

void TextHeader::refuse_word(const std::string& field, const std::vector<std::string>& known) const {
  refuse(field, fmt::format("must be one of {}", fmt::join(known, ", ")));
}

void TextHeader::refuse_line(const std::string& what) const {
  throw InputError(fmt::format("{}:{}: {}", name_, line_, what));
}

std::string TextHeader::data_beside(const std::string& field, const ReadBeside& beside) const {
  std::string file = value(field);
  if (file.starts_with("./")) file.erase(0, 2);
  // a header from somebody else must not lead to any file of this machine
  if (file.empty() || file == "." || file == ".." || file.find_first_of("/\\%") != file.npos ||
      file.find('\0') != file.npos)
    refuse(field, "must be the name of one file in the directory of the header");
  if (!beside) refuse(field, "the data are in another file, which is not given");
  try {
    return beside(file);
  } catch (const InputError& error) {
    refuse(field, error.what());
  }
}

}  // namespace hexaplast
