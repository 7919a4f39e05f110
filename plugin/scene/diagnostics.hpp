// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "attributes/words.hpp"

namespace hexaplast::scene {

/// Where something was written.
struct Place {
  std::string file;                               ///< as the user named it; "--set" for a command-line override
  int line = 0;                                   ///< from 1; 0: no line
  std::shared_ptr<const Place> included_at = {};  ///< where the file is included; null: it is the scene itself
};

enum class Severity { kNote, kWarning, kError };

struct Message {
  Severity severity = Severity::kError;
  Place place;
  std::string text;       ///< "Component.attribute: what is wrong, the value, what is allowed"
  std::string hint = {};  ///< may be empty
};

/// "file:line: error: text"; the places where the file is included and the hint on lines of their own.
std::string format(const Message& message);
std::string format_error(const Place& place, const std::string& text, const std::string& hint = {});

/// A scene that cannot run. what() holds every error found, formatted, one after the other.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that a scene needs is missing or cannot be read.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Collects what is wrong with a scene, so that all of it is reported at once.
class Diagnostics {
 public:
  static constexpr int kMaxErrors = 20;    ///< errors kept; the others are counted
  static constexpr int kMaxCounted = 100;  ///< then enough is known of the scene

  /// Throws like throw_errors when this is error number kMaxCounted.
  void add(Message message);
  void add(Severity severity, Place place, std::string text, std::string hint = {}) {
    add({severity, std::move(place), std::move(text), std::move(hint)});
  }
  void error(Place place, std::string text, std::string hint = {}) {
    add(Severity::kError, std::move(place), std::move(text), std::move(hint));
  }

  bool has_errors() const { return num_errors_ > 0; }

  /// Throws SceneError with all errors, if there are any.
  void throw_errors() const;

  /// Notes and warnings since the last call, in the order in which they came.
  std::vector<Message> take_warnings();

 private:
  std::vector<Message> errors_, warnings_;
  long num_errors_ = 0;
};

using attributes::nearest;

/// "did you mean 'x'?" for the nearest of `names`, or empty.
std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& names);

}  // namespace hexaplast::scene
