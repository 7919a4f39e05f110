// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/DDGNode.h>
#include <sofa/type/types.h>

#include <utility>

namespace sofa::core::objectmodel {

class BaseData : public DDGNode {
 public:
  struct Init {
    std::string name, help;
    bool is_displayed = true, is_read_only = false;
    std::string group = {};
  };

  explicit BaseData(Init init) : init_(std::move(init)) {}

  virtual bool read(const std::string& text) = 0;
  virtual std::string getValueString() const = 0;
  virtual void copyFrom(const BaseData& parent) = 0;

  bool isSet() const { return is_set_; }
  void unset() { is_set_ = false; }
  int getCounter() const { return counter_; }
  bool isReadOnly() const { return init_.is_read_only; }
  const std::string& getHelp() const { return init_.help; }
  const std::string& getName() const { return init_.name; }
  void setName(const std::string& name) { init_.name = name; }
  const std::string& getGroup() const { return init_.group; }
  void setGroup(const std::string& group) { init_.group = group; }

  /// The Data whose value it takes whenever that has changed; null: none.
  BaseData* getParent() const { return parent_; }
  bool setParent(BaseData* parent) {
    if (parent_) delInput(parent_);
    parent_ = parent;
    if (!parent) return true;
    parent->addOutput(this);
    changed();
    return true;
  }

  void update() override {
    cleanDirty();
    update_inputs();
    if (parent_) copyFrom(*parent_);
  }

 protected:
  void changed() {
    is_set_ = true;
    ++counter_;
  }

 private:
  Init init_;
  bool is_set_ = false;
  int counter_ = 0;
  BaseData* parent_ = nullptr;
};

template <class T>
class Data : public BaseData {
 public:
  struct InitData : Init {
    T value{};
  };

  explicit Data(const std::string& help = "", bool is_displayed = true, bool is_read_only = false)
      : BaseData({"", help, is_displayed, is_read_only}) {}
  Data(const Init& init) : BaseData(init) {}
  Data(const InitData& init) : BaseData(init), value_(init.value) {}

  const T& getValue() const {
    updateIfDirty();
    return value_;
  }
  void setValue(const T& value) {
    value_ = value;
    cleanDirty();  // until the parent changes anew
    changed();
    set_outputs_dirty();
  }
  void copyFrom(const BaseData& parent) override {
    if (const auto* of_this_type = dynamic_cast<const Data<T>*>(&parent)) setValue(of_this_type->getValue());
  }
  T* beginEdit() {
    updateIfDirty();
    return beginWriteOnly();
  }
  T* beginWriteOnly() {
    changed();
    return &value_;
  }
  void endEdit() {}

  bool read(const std::string& text) override {
    if constexpr (std::is_same_v<T, std::string>) {
      setValue(text);
      return true;
    } else if constexpr (requires(std::istream & in, T & value) { in >> value; }) {
      std::istringstream in(text);
      T value = value_;
      if (!(in >> std::boolalpha >> value)) return false;
      setValue(value);
      return true;
    } else {
      return false;
    }
  }
  std::string getValueString() const override {
    std::ostringstream out;
    if constexpr (requires { out << std::boolalpha << value_; }) out << std::boolalpha << getValue();
    return out.str();
  }

 private:
  T value_{};
};

}  // namespace sofa::core::objectmodel

namespace sofa::core {
using objectmodel::BaseData;
}  // namespace sofa::core

namespace sofa::helper {

template <class T>
class ReadAccessor {
 public:
  explicit ReadAccessor(const core::objectmodel::Data<T>& data) : value_(data.getValue()) {}
  const T& ref() const { return value_; }
  auto size() const { return value_.size(); }
  const auto& operator[](std::size_t i) const { return value_[i]; }

 private:
  const T& value_;
};

template <class T>
class WriteAccessor {
 public:
  explicit WriteAccessor(T& value) : value_(value) {}
  T& wref() { return value_; }
  auto size() const { return value_.size(); }
  void resize(std::size_t size) { value_.resize(size); }
  void clear() { value_.clear(); }
  template <class Entry>
  void push_back(const Entry& entry) {
    value_.push_back(entry);
  }
  auto& operator[](std::size_t i) { return value_[i]; }
  auto begin() { return value_.begin(); }
  auto end() { return value_.end(); }

 private:
  T& value_;
};

template <class T>
WriteAccessor<T> getWriteAccessor(core::objectmodel::Data<T>& data) {
  return WriteAccessor<T>(*data.beginEdit());
}
template <class T>
WriteAccessor<T> getWriteOnlyAccessor(core::objectmodel::Data<T>& data) {
  return WriteAccessor<T>(*data.beginWriteOnly());
}

}  // namespace sofa::helper
