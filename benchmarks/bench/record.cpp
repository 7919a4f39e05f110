// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tuple>

#include "formats/readable_file.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast::bench {

namespace {

constexpr double kResidualSlack =
    1.1;  // instruction sets and compilers differ in the last bits, which iterations carry

/// Visits every field with its name in the file: written and read by the same list.
template <class R, class Visit>
void for_each_field(R& r, const Visit& visit) {
  visit("size", r.size);
  visit("shape", r.shape);
  visit("element", r.element);
  visit("poisson_ratio", r.poisson_ratio);
  visit("mode", r.mode);
  visit("precision", r.precision);
  visit("solver", r.solver);
  visit("target", r.target);
  visit("threads", r.threads);
  visit("simd", r.simd);
  visit("processor", r.processor);
  visit("iterations", r.iterations);
  visit("tolerance", r.tolerance);
  visit("hex_per_ms", r.hex_per_ms);
  visit("p50_ms", r.p50_ms);
  visit("p99_ms", r.p99_ms);
  visit("ratio_to_dense_peer", r.ratio_to_dense_peer);
  visit("bytes_per_hex", r.bytes_per_hex);
  visit("residual", r.residual);
  visit("velocity_error", r.velocity_error);
  visit("yielded", r.yielded);
  visit("state_hash", r.state_hash);
  visit("linearize_ns", r.linearize_ns);
  visit("operator_ns", r.operator_ns);
  visit("vectors_ns", r.vectors_ns);
  visit("flow_ns", r.flow_ns);
}

/// Five significant digits: more is noise.
double rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, 4 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

/// What a record is of, for any number of threads and instruction set.
auto subject(const Record& r) {
  return std::tie(r.size, r.shape, r.element, r.poisson_ratio, r.mode, r.precision, r.solver, r.target);
}

std::string kind(const Record& r) {
  return fmt::format("{} hexahedra, {}, {}, {}, {} {}, {} thread{}", r.size, r.element, r.mode, r.precision, r.solver,
                     r.target, r.threads, r.threads == 1 ? "" : "s");
}

std::string number(double value, const char* format) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

}  // namespace

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string to_json(const std::vector<Record>& records) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const Record& record : records) {
    nlohmann::ordered_json object;
    for_each_field(record, [&]<class T>(const char* name, const T& value) {
      if constexpr (std::is_same_v<T, double>)
        object[name] = rounded(value);  // what is no number becomes null
      else
        object[name] = value;
    });
    array.push_back(std::move(object));
  }
  return array.dump(1) + "\n";
}

std::vector<Record> read_json(const std::filesystem::path& file) {
  if (const std::string reason = why_unreadable(file); !reason.empty())
    throw InputError(fmt::format("{}: {}", file.string(), reason));
  std::ifstream in(file);
  std::vector<Record> records;
  try {
    for (const nlohmann::json& object : nlohmann::json::parse(in)) {
      Record record;
      for_each_field(record, [&]<class T>(const char* name, T& value) {
        const nlohmann::json& entry = object.at(name);
        if constexpr (std::is_same_v<T, double>)
          value = entry.is_null() ? kNotMeasured : entry.get<double>();
        else
          value = entry.get<T>();
      });
      records.push_back(std::move(record));
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: not an array of benchmark records: {}", file.string(), error.what()));
  }
  return records;
}

std::string table_head() {
  return fmt::format(
      "{:>7} {:<34} {:>5} {:<12} {:<6} {:<9} {:>7} {:>2} | {:>6} {:>8} {:>8} {:>8} {:>7} {:>7} {:>8} | {:>5} {:>5} "
      "{:>5} {:>5}  {}\n",
      "hex", "element", "nu", "mode", "prec.", "solver", "asked", "th", "its", "hex/ms", "p50 ms", "p99 ms", "x peer",
      "B/hex", "residual", "lin", "op", "vec", "flow", "state hash");
}

std::string table_row(const Record& r) {
  return fmt::format(
      "{:>7} {:<34} {:>5} {:<12} {:<6} {:<9} {:>7} {:>2} | {:>6.1f} {:>8.1f} {:>8.3f} {:>8.3f} {:>7} {:>7} {:>8.1e} | "
      "{:>5} {:>5} {:>5} {:>5}  {}\n",
      r.size, r.element, number(r.poisson_ratio, "{:.3g}"), r.mode, r.precision, r.solver, r.target, r.threads,
      r.iterations, r.hex_per_ms, r.p50_ms, r.p99_ms, number(r.ratio_to_dense_peer, "{:.2f}"),
      number(r.bytes_per_hex, "{:.0f}"), r.residual, number(r.linearize_ns, "{:.0f}"), number(r.operator_ns, "{:.1f}"),
      number(r.vectors_ns, "{:.1f}"), number(r.flow_ns, "{:.0f}"), r.state_hash);
}

std::vector<std::string> compare(const std::vector<Record>& records, const std::vector<Record>& baseline,
                                 double ratio) {
  std::vector<std::string> behind;
  int num_compared = 0;
  for (const Record& record : records) {
    const auto old = std::ranges::find_if(baseline, [&](const Record& each) {
      return subject(each) == subject(record) && each.threads == record.threads && each.simd == record.simd;
    });
    if (old == baseline.end()) continue;
    ++num_compared;
    if (record.threads == 1 && record.ratio_to_dense_peer < ratio * old->ratio_to_dense_peer)
      behind.push_back(fmt::format("{}: {:.2f} times the dense peer, less than {} of the baseline's {:.2f}",
                                   kind(record), record.ratio_to_dense_peer, ratio, old->ratio_to_dense_peer));
    if (record.tolerance == 0 && record.residual > kResidualSlack * old->residual)
      behind.push_back(
          fmt::format("{}: residual {:.3g}, the baseline has {:.3g}", kind(record), record.residual, old->residual));
  }
  if (num_compared == 0)
    behind.push_back("no record has one of its kind in the baseline: same sizes, solvers, threads and instruction set");
  return behind;
}

std::vector<std::string> differing_hashes(const std::vector<Record>& records) {
  std::vector<std::string> differing;
  for (auto one = records.begin(); one != records.end(); ++one)
    for (auto other = one + 1; other != records.end(); ++other)
      if (subject(*one) == subject(*other) && one->state_hash != other->state_hash)
        differing.push_back(fmt::format("{} hexahedra, {}, {} {} {}: state {} with {} threads, {} with {}", one->size,
                                        one->mode, one->precision, one->solver, one->target, one->state_hash,
                                        one->threads, other->state_hash, other->threads));
  return differing;
}

}  // namespace hexaplast::bench
