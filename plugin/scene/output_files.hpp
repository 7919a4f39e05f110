// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/whole_file.hpp"

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
  OutputRefusal(const std::string& what, std::string hint) : InputError(what), hint_(std::move(hint)) {}
  const std::string& hint() const { return hint_; }

 private:
  std::string hint_;
};

/// What a scene reads and what its components write: no file is both, and none is written by two. Exporters claim their
/// names in bwd_init, when everything has been read.
class OutputFiles {
 public:
  OutputRules rules;
  InputFiles inputs;  ///< the scene, its includes, and the meshes that it names

  /// The place of a file of that name, which belongs to the claimant from now on; of a series that of its files
  /// without number and ending (place0.vtu, place1.vtu, ...). Throws OutputRefusal.
  std::filesystem::path claim(const std::filesystem::path& name, bool is_series = false);

  /// To be called before a claimed file is written for the first time: makes its folder. Throws OutputError where
  /// something is there by now that must not be replaced.
  void prepare(const std::filesystem::path& file);

  /// All claims, for people: "out/states.txt", "out/beam<N>.vtu".
  std::vector<std::string> claimed() const;

 private:
  struct Claim {
    std::filesystem::path place;
    bool is_series;
    bool has(const std::filesystem::path& file) const;
    bool meets(const Claim& other) const;
  };

  std::filesystem::path resolved(const std::filesystem::path& name) const;
  void require_free(const std::filesystem::path& file) const;

  std::vector<Claim> claims_;
  std::set<std::filesystem::path> begun_;  // by this scene
};

}  // namespace hexaplast::scene
