// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/whole_file.hpp"
#include "scene/diagnostics.hpp"
#include "scene/search_path.hpp"

namespace hexaplast::scene {

/// Where the components of a scene may write. The host says so between reading and init.
struct OutputRules {
  std::filesystem::path directory = ".";  ///< from which relative names count, and below which all files lie
  bool writes = true;                     ///< false: exporters write nothing, whatever their names
  bool allows_outside = false;            ///< also absolute names, those with .., and symbolic links
  bool replaces = false;                  ///< also files that are there already
  std::function<bool(const std::filesystem::path&)> is_taken = {};  ///< by the host, for a file of its own
  std::string how_outside = {}, how_to_replace = {};                ///< hints: how the host is told to allow it
};

/// A name that a component must not write to.
class OutputRefusal : public InputError {
 public:
  OutputRefusal(const std::string& what, std::string hint, Fault fault = Fault::kScene)
      : InputError(what), hint_(std::move(hint)), fault_(fault) {}
  const std::string& hint() const { return hint_; }
  Fault fault() const { return fault_; }  ///< of the name, or of a file that is there already

 private:
  std::string hint_;
  Fault fault_;
};

/// What a scene reads and what its components write: no file is both, and none is written by two. Exporters claim their
/// names in bwd_init, when everything has been read.
class OutputFiles {
 public:
  OutputRules rules;
  InputFiles inputs;  ///< the scene, its includes, and the meshes that it names
  SearchPath search;  ///< of these meshes

  /// The file that a component names, found and added to `inputs`. `by`: where the component stands.
  std::filesystem::path input(const std::filesystem::path& name, const Place& by) {
    const std::filesystem::path file = search.find(name, std::filesystem::path(by.file).parent_path());
    inputs.add(file);
    return file;
  }

  /// The place of a file of that name, which belongs to the claimant from now on; of a series that of its files
  /// without number and ending (place0.vtu, place1.vtu, ...). Throws OutputRefusal.
  std::filesystem::path claim(const std::filesystem::path& name, bool is_series = false);

  /// To be called before a claimed file is written: makes its folder. Throws OutputError where something is there by
  /// now that must not be replaced, or the folder has become a link.
  void prepare(const std::filesystem::path& file);

  /// To be called before the first file of a claimed series is written: removes those from number `first` on, finished
  /// or not, which an earlier run has left. Throws OutputError where one must not be replaced.
  void begin_series(const std::filesystem::path& series, int first);

  /// All claims, for people: "out/states.txt", "out/beam<N>.vtu".
  std::vector<std::string> claimed() const;

 private:
  struct Claim {
    std::filesystem::path place;
    bool is_series;
    bool has(const std::filesystem::path& file) const;  // finished or not
    bool is_folder_of(const Claim& other) const;
    bool meets(const Claim& other) const;
  };

  std::filesystem::path resolved(const std::filesystem::path& name) const;
  void require_free(const std::filesystem::path& file) const;
  void require_same_folder(const std::filesystem::path& file) const;

  std::vector<Claim> claims_;
  std::set<std::filesystem::path> begun_;  // by this scene
};

}  // namespace hexaplast::scene
