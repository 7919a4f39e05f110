// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/BaseComponent.h>

#include <functional>
#include <map>

namespace sofa::core {

class ObjectRegistrationData {
 public:
  explicit ObjectRegistrationData(const std::string& help) : help_(help) {}

  template <class T>
  ObjectRegistrationData& add() {
    make_ = [] { return std::shared_ptr<objectmodel::BaseComponent>(objectmodel::New<T>::make()); };
    if constexpr (requires { typename T::DataTypes; }) template_name_ = T::DataTypes::Name();
    return *this;
  }

 private:
  friend class ObjectFactory;
  std::string help_, template_name_;
  std::function<std::shared_ptr<objectmodel::BaseComponent>()> make_;
};

/// Knows classes by the name that their objects say they have.
class ObjectFactory {
 public:
  struct Entry {
    std::string help, template_name;
    std::function<std::shared_ptr<objectmodel::BaseComponent>()> make;
  };

  bool registerObjects(ObjectRegistrationData& data) {
    return entries.insert({data.make_()->getClassName(), {data.help_, data.template_name_, data.make_}}).second;
  }

  std::map<std::string, Entry> entries;
};

}  // namespace sofa::core
