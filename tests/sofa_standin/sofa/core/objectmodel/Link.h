// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <string>

namespace sofa::core::objectmodel {

class BaseLink {
 public:
  enum Flags { FLAG_NONE = 0, FLAG_STOREPATH = 1, FLAG_STRONGLINK = 2 };
  struct Init {
    std::string name, help;
  };
};

template <class Owner, class Target, unsigned flags>
class SingleLink : public BaseLink {
 public:
  SingleLink() = default;
  SingleLink(const Init& init) : init_(init) {}

  Target* get() const { return target_; }
  void set(Target* target) { target_ = target; }
  void set(Target* target, const std::string& /*path*/) { target_ = target; }
  operator Target*() const { return target_; }
  Target* operator->() const { return target_; }

 private:
  Init init_;
  Target* target_ = nullptr;
};

}  // namespace sofa::core::objectmodel
