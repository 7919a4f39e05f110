// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/archive.hpp"

namespace hexaplast::output {

/// A time series of a run, a .pvd file: names of .vtu files beside it and their times.
class TimeSeries {
 public:
  explicit TimeSeries(std::filesystem::path file) : file_(std::move(file)) {}

  /// Adds a state and replaces the file; `vtu` must be complete on disk. Throws OutputError; the file is then as
  /// before.
  void add(double time, const std::string& vtu);

  /// Names and times, into a checkpoint or from one.
  void serialize(Archive& archive);

  /// Leaves out those entries that are not wanted, and replaces the file. Throws OutputError.
  void keep(const std::function<bool(const std::string& vtu)>& is_wanted);
  bool has(const std::string& vtu) const;

  /// A series of the same times with other files, whose names begin with `prefix` where these begin with `own`. Its
  /// file is not written yet.
  TimeSeries with_prefix(std::filesystem::path file, std::string_view own, std::string_view prefix) const;

 private:
  struct Entry {
    double time = 0;  // [s]
    std::string vtu;
  };
  void write(const std::vector<Entry>& entries) const;

  std::filesystem::path file_;
  std::vector<Entry> entries_;
};

}  // namespace hexaplast::output
