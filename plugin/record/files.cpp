// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>

#include "formats/readable_file.hpp"
#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "record/checkpoint.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 4> kSeries = {"mesh", "surface", "instruments", "springs"};

bool is_series(std::string_view name) {
  return name.ends_with(".pvd") && std::ranges::count(kSeries, name.substr(0, name.size() - 4)) > 0;
}

/// Files of an earlier run, finished or not; refuses a directory in the place of one, and an input. Time series come
/// first: removed first, they never name a file that has gone.
std::vector<fs::path> files_of_earlier_run(const fs::path& directory, const InputFiles& inputs) {
  std::vector<fs::path> found;
  const auto collect = [&](const fs::path& in, auto&& is_ours) {
    std::error_code error;
    for (fs::directory_iterator entry(in, error), end; !error && entry != end; entry.increment(error))
      if (is_ours(entry->path().filename().string())) found.push_back(entry->path());
    if (error && error != std::errc::no_such_file_or_directory) throw OutputError(in, "cannot be read", error.value());
  };
  collect(directory, is_of_run);
  if (fs::is_symlink(directory / "frames"))
    throw OutputError((directory / "frames").string() + ": is a symbolic link, which is not followed here");
  if (fs::is_directory(directory / "frames"))
    collect(directory / "frames",
            [](std::string_view name) { return is_numbered(without_part(name), "frame_", ".png"); });
  for (const fs::path& file : found)
    if (fs::is_directory(file)) throw OutputError(file.string() + ": is a directory where a file belongs");
  for (const fs::path& file : found)
    if (const fs::path input = inputs.replaced_by(file); !input.empty())
      throw OutputError(input.string() + ": is an input of this run, which would replace it");
  std::stable_partition(found.begin(), found.end(),
                        [](const fs::path& path) { return is_series(path.filename().string()); });
  return found;
}

/// Grows by lines.
bool is_table(std::string_view name) { return name == "history.csv" || name == "removed.csv" || name == "opened.csv"; }

}  // namespace

bool is_of_run(std::string_view name) {
  name = without_part(name);
  const auto is_state = [&](std::string_view of) { return is_numbered(name, fmt::format("{}_", of), ".vtu"); };
  return is_series(name) || is_table(name) || name == "manifest.json" || name == "report.html" ||
         name == "plot.svg" ||  // of earlier versions
         name == "viewer.json" || std::ranges::any_of(kSeries, is_state) || is_numbered(name, "checkpoint_", ".hxc");
}

void add_files_of_run(const fs::path& directory, InputFiles& files) {
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error))
    if (is_of_run(entry->path().filename().string())) files.add(entry->path());
}

std::optional<long> number_at_end(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t last = stem.find_last_not_of("0123456789");
  const char* from = stem.data() + (last == stem.npos ? 0 : last + 1);
  long number = 0;
  const auto [end, error] = std::from_chars(from, stem.data() + stem.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

void require_readable(const fs::path& file) {
  if (const std::string reason = why_unreadable(file); !reason.empty())
    throw OutputError(fmt::format("{}: {}", file.string(), reason));
}

void make_directory(const fs::path& directory) {
  std::error_code error;
  const fs::file_status status = fs::status(directory, error);
  if (!fs::exists(status)) {
    if (status.type() != fs::file_type::not_found) throw OutputError(directory, "cannot be reached", error.value());
    fs::create_directories(directory, error);
    if (error) throw OutputError(directory, "cannot be created", error.value());
    return;
  }
  if (!fs::is_directory(status)) throw OutputError(directory.string() + ": is a file; an output directory is needed");
  if (::access(directory.c_str(), R_OK | W_OK | X_OK) != 0) throw OutputError(directory, "cannot be written", errno);
}

void prepare_directory(const fs::path& directory, bool force, const InputFiles& inputs) {
  make_directory(directory);
  const fs::path frames = directory / "frames";
  if (fs::exists(frames) && !fs::is_directory(frames))
    throw OutputError(frames.string() + ": is a file where the directory of the pictures belongs");
  if (fs::exists(frames) && ::access(frames.c_str(), R_OK | W_OK | X_OK) != 0)
    throw OutputError(frames, "cannot be written", errno);

  const std::vector<fs::path> earlier = files_of_earlier_run(directory, inputs);
  if (!earlier.empty() && !force)
    throw OutputError(fmt::format("{}: holds an earlier run ({}); --force replaces it", directory.string(),
                                  earlier.front().lexically_relative(directory).string()));
  for (const fs::path& file : earlier)
    if (::unlink(file.c_str()) != 0) throw OutputError(file, "cannot be removed", errno);
}

void prepare_to_go_on(const fs::path& directory, long step, const InputFiles& inputs,
                      const std::function<bool(const std::string& name)>& is_kept) {
  if (::access(directory.c_str(), R_OK | W_OK | X_OK) != 0) throw OutputError(directory, "cannot be written", errno);
  const auto stays = [&](const fs::path& file) {
    const std::string name = file.filename().string();
    if (name.ends_with(kPart)) return false;
    if (is_numbered(name, "checkpoint_", ".hxc")) return number_at_end(name).value_or(0) <= step;
    return is_series(name) || is_table(name) || is_kept(name);
  };
  for (const fs::path& file : files_of_earlier_run(directory, inputs))
    if (!stays(file) && ::unlink(file.c_str()) != 0) throw OutputError(file, "cannot be removed", errno);
}

}  // namespace hexaplast::output
