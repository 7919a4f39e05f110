// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/time_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "record/files.hpp"

namespace hexaplast::output {

void TimeSeries::add(double time, const std::string& vtu) {
  std::vector<Entry> entries = entries_;
  entries.push_back({time, vtu});
  write(entries);
  entries_ = std::move(entries);
}

void TimeSeries::serialize(Archive& archive) {
  std::uint64_t count = entries_.size();
  archive(count);
  if (archive.reads()) {
    if (count > archive.rest()) throw InputError(fmt::format("{} states are announced", count));
    entries_.resize(count);
  }
  for (Entry& entry : entries_) {
    archive(entry.time, entry.vtu);
    // what a checkpoint says goes into the file as it is
    if (archive.reads() && !(std::isfinite(entry.time) && is_numbered(entry.vtu, file_.stem().string() + "_", ".vtu")))
      throw InputError(fmt::format("a state '{}' at t = {} is listed: must be {}_N.vtu and a time",
                                   printable_line(entry.vtu), entry.time, file_.stem().string()));
  }
}

void TimeSeries::keep(const std::function<bool(const std::string&)>& is_wanted) {
  std::erase_if(entries_, [&](const Entry& entry) { return !is_wanted(entry.vtu); });
  write(entries_);
}

bool TimeSeries::has(const std::string& vtu) const {
  return std::ranges::find(entries_, vtu, &Entry::vtu) != entries_.end();
}

TimeSeries TimeSeries::with_prefix(std::filesystem::path file, std::string_view own, std::string_view prefix) const {
  TimeSeries other(std::move(file));
  for (const Entry& entry : entries_)
    other.entries_.push_back({entry.time, std::string(prefix) + entry.vtu.substr(own.size())});
  return other;
}

void TimeSeries::write(const std::vector<Entry>& entries) const {
  WholeFile out(file_);
  out.write(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n");
  for (const Entry& entry : entries)
    out.write(fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time, entry.vtu));
  out.write("  </Collection>\n</VTKFile>\n");
  out.commit();
}

}  // namespace hexaplast::output
