// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <algorithm>
#include <istream>
#include <ostream>
#include <string>
#include <vector>

namespace sofa::helper {

/// One of some words. Like SOFA's it stays what it is where it is told another word.
class OptionsGroup {
 public:
  OptionsGroup() = default;
  template <class Words>
  explicit OptionsGroup(const Words& words) : words_(words.begin(), words.end()), selected_(words_.front()) {}

  void setSelectedItem(const std::string& word) {
    if (std::ranges::count(words_, word) > 0) selected_ = word;
  }
  const std::string& getSelectedItem() const { return selected_; }

 private:
  std::vector<std::string> words_;
  std::string selected_;
};

inline std::istream& operator>>(std::istream& in, OptionsGroup& words) {
  std::string word;
  std::getline(in, word);
  words.setSelectedItem(word);
  return in;
}
inline std::ostream& operator<<(std::ostream& out, const OptionsGroup& words) { return out << words.getSelectedItem(); }

}  // namespace sofa::helper
