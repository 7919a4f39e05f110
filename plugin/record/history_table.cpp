// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/history_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "record/files.hpp"

namespace hexaplast::output {
namespace {

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;; ++begin) {
    const std::size_t comma = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, comma - begin));
    begin = comma;
    if (comma == line.size()) return fields;
  }
}

}  // namespace

HistoryTable::HistoryTable(const std::filesystem::path& file) : file_(file) {
  require_readable(file);
  in_.open(file, std::ios::binary);
  std::getline(in_, line_);
  for (const std::string_view name : fields_of(line_)) columns_.emplace_back(name);
  if (columns_.size() < 2 || columns_[kStep] != "step" || columns_[kTime] != "time")
    throw OutputError(fmt::format("{}:1: is no history of a run: must begin with step,time", file.string()));
  row_.resize(columns_.size());
}

int HistoryTable::find(std::string_view column) const {
  const auto found = std::ranges::find(columns_, column);
  return found == columns_.end() ? -1 : static_cast<int>(found - columns_.begin());
}

std::span<const double> HistoryTable::next() {
  if (!std::getline(in_, line_) || in_.eof()) return {};
  ++line_number_;
  const std::vector<std::string_view> fields = fields_of(line_);
  if (fields.size() != columns_.size())
    throw OutputError(
        fmt::format("{}:{}: {} numbers, must be {}", file_.string(), line_number_, fields.size(), columns_.size()));
  for (std::size_t c = 0; c < fields.size(); ++c) {
    const char* const end = fields[c].data() + fields[c].size();
    const auto [at, error] = std::from_chars(fields[c].data(), end, row_[c]);
    if (error != std::errc() || at != end)
      throw OutputError(fmt::format("{}:{}: {}: '{}', must be a number", file_.string(), line_number_, columns_[c],
                                    fields[c].substr(0, 40)));
  }
  return row_;
}

long count_rows(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> block(1 << 16);
  long lines = 0;
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    lines += std::count(block.begin(), block.begin() + in.gcount(), '\n');
  }
  return std::max(lines - 1, 0L);
}

}  // namespace hexaplast::output
