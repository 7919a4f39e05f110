// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/output_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "formats/text.hpp"

namespace hexaplast::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSeriesEnding = ".vtu";

[[noreturn]] void refuse(const std::string& what, const std::string& hint = {}, Fault fault = Fault::kScene) {
  throw OutputRefusal(what, hint, fault);
}

/// Turns what is found out when files are written into OutputErrors.
template <class Action>
void attempt(const Action& action) {
  try {
    action();
  } catch (const OutputRefusal& refusal) {
    throw OutputError(refusal.what());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(error.what());
  }
}

bool is_below(const fs::path& folder, const fs::path& directory) {
  return std::mismatch(directory.begin(), directory.end(), folder.begin(), folder.end()).first == directory.end();
}

bool is_there(const fs::path& file) {
  std::error_code unknown;
  return fs::exists(fs::symlink_status(file, unknown));
}

/// Refuses a file that could not be made, as far as that can be told without making it: folders are made for it.
void require_room(const fs::path& file) {
  fs::path folder = file.parent_path();
  while (!is_there(folder)) folder = folder.parent_path();
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) refuse(fmt::format("'{}' is no directory", folder.string()));
  const long max = ::pathconf(folder.c_str(), _PC_NAME_MAX);  // -1: unknown
  for (const fs::path& word : part_of(file).lexically_relative(folder))
    if (max > 0 && word.native().size() > static_cast<std::size_t>(max))
      refuse(fmt::format("'{}' is too long a name: with all suffixes, at most {} bytes", word.string(), max));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(fmt::format("'{}' cannot be written: {}", folder.string(), std::strerror(errno)), {}, Fault::kFiles);
}

/// The files of a folder; none where there is no folder.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    files.push_back(entry->path());
  std::ranges::sort(files);
  return files;
}

}  // namespace

bool OutputFiles::Claim::has(const fs::path& file) const {
  const std::string name = file.filename().string();
  if (file.parent_path() != place.parent_path()) return false;
  return is_series ? is_numbered(without_part(name), place.filename().string(), kSeriesEnding)
                   : without_part(name) == place.filename().string();
}

bool OutputFiles::Claim::is_folder_of(const Claim& other) const {
  for (fs::path folder = other.place.parent_path(); folder.has_relative_path(); folder = folder.parent_path())
    if (has(folder)) return true;
  return false;
}

bool OutputFiles::Claim::meets(const Claim& other) const {
  if (is_folder_of(other) || other.is_folder_of(*this)) return true;
  if (!other.is_series) return has(other.place);
  if (!is_series) return other.has(place);
  // one of the series has all its numbers behind a number of the other's
  const std::string mine = place.string(), theirs = other.place.string();
  const std::string &longer = mine.size() < theirs.size() ? theirs : mine,
                    &shorter = mine.size() < theirs.size() ? mine : theirs;
  return longer.starts_with(shorter) && longer.find_first_not_of("0123456789", shorter.size()) == longer.npos;
}

// Where a name leads, whether or not something is there.
fs::path OutputFiles::resolved(const fs::path& name) const {
  const fs::path directory = fs::weakly_canonical((fs::absolute(rules.directory) / "").parent_path());
  const bool leads_out = name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
  if (leads_out && !rules.allows_outside)
    refuse(fmt::format("'{}' is absolute or has '..': must be a name below '{}'", name.string(), directory.string()),
           rules.how_outside);

  if (std::ranges::any_of(name, [](const fs::path& word) { return word.string().ends_with(kPart); }))
    refuse(fmt::format("'{}' ends in {}, as the names of unfinished files do", name.string(), kPart));

  fs::path file = directory / name;
  if (!file.has_filename() || name.filename() == ".") refuse(fmt::format("'{}' names no file", name.string()));
  std::error_code unknown;
  if (fs::is_symlink(file, unknown)) {
    if (!rules.allows_outside)
      refuse(fmt::format("'{}' is a symbolic link, which is not followed", file.string()), rules.how_outside);
    file = output_place(file);
  }
  const fs::path folder = fs::weakly_canonical(file.parent_path());
  const bool is_inside = is_below(folder, directory);
  if (!is_inside && !rules.allows_outside)
    refuse(fmt::format("'{}' leads to '{}': must lie below '{}'", name.string(), folder.string(), directory.string()),
           rules.how_outside);
  // folders below the run's directory are made, others must be there
  if (is_there(folder) ? !fs::is_directory(folder, unknown) : !is_inside)
    refuse(fmt::format("'{}' is no directory", folder.string()));
  return folder / file.filename();
}

void OutputFiles::require_free(const fs::path& file) const {
  for (fs::path taken = file; rules.is_taken && taken.has_relative_path(); taken = taken.parent_path())
    if (rules.is_taken(taken)) refuse(fmt::format("'{}' is written by the run itself", taken.string()));
  if (!is_there(file)) return;
  std::error_code unknown;
  const fs::file_status status = fs::symlink_status(file, unknown);
  if (fs::is_symlink(status)) refuse(fmt::format("'{}' is a symbolic link, which is not followed", file.string()));
  if (!fs::is_regular_file(status)) refuse(fmt::format("'{}' is not a file", file.string()));
  if (!inputs.replaced_by(file).empty())
    refuse(fmt::format("'{}' is read by this scene, and what is read is never written over", file.string()));
  if (!rules.replaces && !begun_.contains(file))
    refuse(fmt::format("'{}' is there already", file.string()), rules.how_to_replace, Fault::kFiles);
}

// Its folder is known without links since it was claimed.
void OutputFiles::require_same_folder(const fs::path& file) const {
  const fs::path folder = fs::weakly_canonical(file.parent_path());
  if (folder != file.parent_path())
    refuse(fmt::format("'{}' leads to '{}' by now", file.parent_path().string(), folder.string()));
}

fs::path OutputFiles::claim(const fs::path& name, bool is_series) {
  if (!rules.writes) return name;
  const Claim wanted{resolved(name), is_series};
  for (const Claim& other : claims_)
    if (wanted.meets(other)) refuse(fmt::format("'{}' is written by another component too", wanted.place.string()));

  require_free(is_series ? fs::path(fmt::format("{}0{}", wanted.place.string(), kSeriesEnding)) : wanted.place);
  for (const fs::path& file : files_in(wanted.place.parent_path()))
    if (wanted.has(file)) require_free(file);
  require_room(
      is_series ? fs::path(fmt::format("{}{}{}", wanted.place.string(), std::numeric_limits<int>::max(), kSeriesEnding))
                : wanted.place);
  claims_.push_back(wanted);
  return wanted.place;
}

void OutputFiles::prepare(const fs::path& file) {
  attempt([&] {
    require_same_folder(file);
    if (begun_.contains(file)) return;
    require_free(file);
    fs::create_directories(file.parent_path());
    if (rules.replaces) fs::remove(part_of(file));  // whosever it was: the claim has found it
    begun_.insert(file);
  });
}

void OutputFiles::begin_series(const fs::path& series, int first) {
  const Claim claim{series, true};
  const std::size_t digits = series.string().size();
  attempt([&] {
    require_same_folder(series);
    for (const fs::path& file : files_in(series.parent_path())) {
      if (!claim.has(file) || std::strtol(file.c_str() + digits, nullptr, 10) < first) continue;
      require_free(file);
      fs::remove(file);
    }
  });
}

std::vector<std::string> OutputFiles::claimed() const {
  std::vector<std::string> names;
  for (const Claim& claim : claims_)
    names.push_back(claim.is_series ? fmt::format("{}<N>{}", claim.place.string(), kSeriesEnding)
                                    : claim.place.string());
  return names;
}

}  // namespace hexaplast::scene
