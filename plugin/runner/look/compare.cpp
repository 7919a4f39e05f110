// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "formats/text.hpp"
#include "page/comparison.hpp"
#include "record/files.hpp"
#include "runner/run/common_options.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

using TableRow = std::vector<std::string>;

void print(const output::ComparisonTable& table) {
  fmt::print("{}\n", printable_line(table.title));
  std::vector<TableRow> rows = table.rows;
  if (!rows.empty()) rows.insert(rows.begin(), table.columns);
  std::vector<std::size_t> widths(table.columns.size());
  for (const TableRow& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  for (const TableRow& row : rows) {
    std::string line = " ";
    for (std::size_t c = 0; c < row.size(); ++c) line += fmt::format(" {:<{}} ", row[c], widths[c]);
    fmt::print("{}\n", printable_line(line.substr(0, line.find_last_not_of(' ') + 1)));
  }
  if (!table.note.empty()) fmt::print("  {}\n", printable_line(table.note));
}

struct CompareOptions {
  std::filesystem::path a, b;                ///< directories of runs
  std::optional<std::filesystem::path> out;  ///< page to write
};

/// Prints where two runs are farthest apart, and writes the page. Throws OutputError and InputError; then no page is
/// written.
void compare(const CompareOptions& options) {
  const std::vector<output::ComparisonTable> tables = output::compare_runs(options.a, options.b);
  if (options.out) {
    InputFiles inputs;
    output::add_files_of_run(options.a, inputs);
    output::add_files_of_run(options.b, inputs);
    output::WholeFile page(output_place(*options.out, inputs, {options.a, options.b}));
    page.write(output::comparison_page(options.a, options.b, tables));
    page.commit();
  }
  for (const output::ComparisonTable& table : tables) print(table);
}

}  // namespace

void add_compare(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "compare", "Print where two runs of a body are farthest apart", compare,
                     [](const CompareOptions&) { return "hexaplast compare"; });
  add_option(command, "run_a", options.a, "RUN_A", "Directory of a run")->required();
  add_option(command, "run_b", options.b, "RUN_B", "Directory of another one")->required();
  add_option(command, "-o,--out", options.out, "FILE.html",
             "Write the comparison with the curves of both runs as a page; replaces an older file");
}

}  // namespace hexaplast::runner
