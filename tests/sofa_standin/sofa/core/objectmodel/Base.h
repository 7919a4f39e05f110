// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/Data.h>
#include <sofa/core/objectmodel/Link.h>

#include <map>
#include <memory>
#include <type_traits>

namespace sofa::core::objectmodel {

enum class ComponentState { Undefined, Loading, Valid, Dirty, Busy, Invalid };

class Base {
 public:
  Base() = default;
  Base(const Base&) = delete;
  virtual ~Base() = default;

  virtual std::string getClassName() const = 0;
  virtual std::string getPathName() const { return getName(); }
  const std::string& getName() const { return name_; }
  void setName(const std::string& name) { name_ = name; }

  const std::string& getInstanciationSourceFileName() const { return source_file_; }
  int getInstanciationSourceFilePos() const { return source_line_; }
  void setInstanciationSourceFileName(const std::string& file) { source_file_ = file; }
  void setInstanciationSourceFilePos(int line) { source_line_ = line; }

  BaseData* findData(const std::string& name) const {
    const auto found = data_.find(name);
    return found == data_.end() ? nullptr : found->second;
  }
  void addData(BaseData* data, const std::string& name) {
    data->setName(name);
    data_[name] = data;
  }
  void addAlias(BaseData* data, const char* alias) { data_[alias] = data; }

  /// An attribute of a scene file.
  virtual bool parseField(const std::string& attribute, const std::string& value) {
    return findData(attribute)->read(value);
  }

  Data<ComponentState> d_componentState{"Whether it works."};
  Data<bool> f_printLog{"Whether it says what it does."};
  bool isComponentStateInvalid() const { return d_componentState.getValue() == ComponentState::Invalid; }

 public:
  // Called before the Data is constructed, from what they return.
  template <class T>
  BaseData::Init initData(Data<T>* data, const char* name, const char* help, bool is_displayed = true,
                          bool is_read_only = false) {
    data_[name] = data;
    return {name, help, is_displayed, is_read_only};
  }
  template <class T>
  typename Data<T>::InitData initData(Data<T>* data, const std::type_identity_t<T>& value, const char* name,
                                      const char* help, bool is_displayed = true, bool is_read_only = false) {
    data_[name] = data;
    return {{name, help, is_displayed, is_read_only}, value};
  }

 protected:
  BaseLink::Init initLink(const char* name, const char* help) { return {name, help}; }

 private:
  std::string name_, source_file_;
  int source_line_ = 0;
  std::map<std::string, BaseData*> data_;
};

/// Makes objects whose constructors are protected, as those of components are.
template <class T>
struct New {
  static std::shared_ptr<T> make() { return std::shared_ptr<T>(new T); }
};

}  // namespace sofa::core::objectmodel

namespace sofa_standin {

/// "Class" of "Class" and of "SOFA_TEMPLATE(Class, T)".
inline std::string class_name(std::string text) {
  text.erase(0, text.find('(') + 1);
  return text.substr(0, text.find(','));
}

}  // namespace sofa_standin

#define SOFA_TEMPLATE(Class, Argument) Class<Argument>
#define SOFA_TEMPLATE2(Class, First, Second) Class<First, Second>
#define SOFA_ABSTRACT_CLASS(Class, Parent) \
  using Inherit1 = Parent;                 \
  template <class>                         \
  friend struct ::sofa::core::objectmodel::New
#define SOFA_CLASS(Class, ...)                                                             \
  std::string getClassName() const override { return ::sofa_standin::class_name(#Class); } \
  template <class>                                                                         \
  friend struct ::sofa::core::objectmodel::New
