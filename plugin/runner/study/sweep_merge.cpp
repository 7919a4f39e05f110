// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/sweep_merge.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <map>
#include <nlohmann/json.hpp>

#include "record/files.hpp"
#include "runner/exit_code.hpp"
#include "runner/run/directory_lock.hpp"
#include "runner/study/sweep_directory.hpp"

namespace hexaplast::runner {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
namespace {

/// The file under another name. It is complete, and never written to again: a new one takes its place.
void link_or_copy(const fs::path& from, const fs::path& to) {
  const fs::path part = part_of(to);
  fs::remove(part);
  std::error_code other_file_system;
  fs::create_hard_link(from, part, other_file_system);
  if (other_file_system) fs::copy_file(from, part);
  fs::rename(part, to);
  fs::remove(part);  // rename leaves it where both are one file already
}

/// The plan of the whole sweep, from those of its shards.
Json common_plan(const std::vector<fs::path>& shards) {
  Json plan = read_plan({shards.front()});
  for (const char* key :
       {"title", "labels", "units", "scene", "scene_hash", "version", "simd", "steps", "strict", "vary"})
    if (!plan.contains(key))
      throw output::OutputError(fmt::format("{}: is no plan of a sweep that can be merged: it has no {}",
                                            SweepDirectory{shards.front()}.plan().string(), key));
  for (const char* key : {"labels", "units"})
    if (!plan[key].is_array() || plan[key].size() != plan["vary"].size())
      throw output::OutputError(
          fmt::format("{}: is no plan of a sweep that can be merged: {} must have as many entries as vary",
                      SweepDirectory{shards.front()}.plan().string(), key));
  for (const fs::path& shard : shards)
    if (const std::string difference = difference_of(plan, read_plan({shard})); !difference.empty())
      throw output::OutputError(
          fmt::format("{} and {} are not of one sweep: {}", shards.front().string(), shard.string(), difference));
  plan.erase("shard");
  return plan;
}

/// Takes the runs of a shard into the table of all.
void take(const SweepDirectory& shard, const SweepDirectory& out, bool has_data, SweepTable& table,
          std::map<long, fs::path>& origin) {
  SweepTable of_shard(table.factors());
  if (!fs::exists(shard.table())) return;  // it has begun, and no more
  of_shard.read(shard.table());
  if (fs::exists(shard.times())) of_shard.read_times(shard.times());
  for (long run = 0; run < table.num_runs(); ++run) {
    const std::optional<SweepRow>& row = of_shard.row(run);
    if (!row) continue;
    if (table.is_finished(run) && of_shard.is_finished(run) && !table.row(run)->is_same_as(*row))
      throw output::OutputError(
          fmt::format("run {} has other results in {} than in {}: they are not of one version or "
                      "one instruction set",
                      run + 1, shard.path.string(), origin.contains(run) ? origin[run].string() : out.path.string()));
    if (table.is_finished(run)) continue;
    if (row->exit_code == kOk && has_data) {
      if (!fs::exists(shard.fields(run)))
        throw output::OutputError(shard.fields(run).string() + ": is missing, though the run is done");
      link_or_copy(shard.fields(run), out.fields(run));
    }
    if (row->exit_code != kOk && fs::exists(shard.messages(run)))
      link_or_copy(shard.messages(run), out.messages(run));
    else
      fs::remove(out.messages(run));
    table.set(run, *row);
    origin[run] = shard.path;
  }
}

}  // namespace

int merge_sweep(const std::vector<fs::path>& shards, const fs::path& out, bool force) {
  const SweepDirectory directory{out};
  try {
    const Json plan = common_plan(shards);
    output::make_directory(out);
    const DirectoryLock lock(out);
    for (const fs::path& shard : shards)
      if (fs::equivalent(shard, out)) throw output::OutputError(out.string() + ": is one of the directories to merge");
    SweepTable table(factors_of(plan));
    open(directory, plan, force, {}, table);
    std::map<long, fs::path> origin;
    for (const fs::path& shard : shards) take({shard}, directory, plan.contains("fields"), table, origin);
    table.write_times(directory.times());
    table.write(directory.table());
    write_overviews(directory, plan, table);
    const int code = conclude(directory, plan, table);
    const long num_missing = table.num_runs() - table.num_finished();
    if (num_missing == 0) return code;
    spdlog::error("{}: error: {} of {} runs are missing: complete the shards and merge again", out.string(),
                  num_missing, table.num_runs());
    return kInputOutput;
  } catch (const Json::exception&) {
    throw output::OutputError(SweepDirectory{shards.front()}.plan().string() + ": is no plan of a sweep");
  } catch (const UsageError&) {
    throw output::OutputError(SweepDirectory{shards.front()}.plan().string() + ": is no plan of a sweep");
  }
}

}  // namespace hexaplast::runner
