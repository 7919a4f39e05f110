// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "scene/diagnostics.hpp"
#include "scene/value.hpp"

namespace hexaplast::scene {

class Object;

/// One attribute of one object: its value, or the attribute elsewhere that it follows. Values are read where they are
/// used, so that a link sees what its source holds at that moment.
class Data {
 public:
  Data(Object& owner, const attributes::Attribute& attribute);

  Object& owner() const { return owner_; }
  const attributes::Attribute& attribute() const { return attribute_; }
  const Place& place() const { return place_; }  ///< where it was given; the owner's place where it was not

  /// Given in the scene, as a value or as a link.
  bool is_given() const { return is_given_; }

  /// Takes the text of a scene: a value or a link ("@..."), which is kept until links are resolved.
  /// Throws InputError where the text cannot be read.
  void read(std::string_view text, Place place);

  /// Takes a value that does not come from text: from a host that keeps its own. Throws InputError like read_value;
  /// then nothing has changed.
  void set(Value value, Place place);

  /// As if it had never been given: the value is the default one again.
  void unset();

  /// "@path" as written; empty when there is none.
  const std::string& link() const { return link_; }

  /// Follows another attribute of the same kind from now on, and counts as given. `link`: as the scene writes it.
  void follow(Data& source, const std::string& link);
  Data* source() const { return source_; }

  /// What stands here: a value, a link and what it leads to at present, or neither.
  struct Given {
    std::optional<Value> value;  ///< absent: not given
    Data* source = nullptr;
    std::string link;
    Place place;
  };
  Given given();
  void put_back(const Given& given);

  /// The object that an attribute of type kLink leads to; null: not given.
  void point_to(Object& target) { target_ = &target; }
  Object* target() const { return target_; }

  /// For the owner: a new value of an output or a state.
  void set(Value value);

  /// The same for an output that never changes: `make` gives it when it is first asked for.
  template <class Make>
  void set_once(const Make& make) {
    if (is_made_) return;
    set(make());
    is_made_ = true;
  }

  /// The present value: that of the source, or the own one, which the owner brings up to date first if it computes it.
  const Value& value();

  /// What it was when it was asked for last; nothing is computed.
  const Value& latest() const { return source_ ? source_->latest() : value_; }

  /// Grows whenever the value changes, also where it comes from somewhere else than before.
  long version();

  /// For the owner: whether the value is another one than accept() was called for, and that it is known now.
  bool is_new() { return version() != accepted_version_; }
  void accept() { accepted_version_ = version(); }
  void forget() { accepted_version_ = -1; }  ///< it is new again

  /// The present value. Throws InputError where it is that of a source and not admissible here.
  const Value& checked();

 private:
  void compute();
  void drop_link();

  Object& owner_;
  const attributes::Attribute& attribute_;
  Place place_;
  Value value_;
  long version_ = 0;
  long source_version_ = -1;   // of the source, when it was last looked at
  long checked_version_ = -1;  // at which the source's value was admissible
  long accepted_version_ = -1;
  bool is_given_ = false;
  bool is_made_ = false;  // by set_once
  std::string link_;
  Data* source_ = nullptr;
  Object* target_ = nullptr;
};

/// What nodes and components have in common: a class, a name, and the attributes of the class's description.
class Object {
 public:
  /// Declares the attributes of `description` and those that everything has.
  explicit Object(const attributes::Description& description);
  virtual ~Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  const attributes::Description& description() const { return description_; }
  std::string_view class_name() const { return description_.class_name; }
  const std::string& name() const { return name_; }
  const Place& place() const { return place_; }

  /// Set once, when the object is made.
  void introduce(std::string name, Place place, Diagnostics& diagnostics);

  /// By name; null: there is none.
  Data* find_data(std::string_view name);
  const std::vector<std::unique_ptr<Data>>& all_data() const { return data_; }

  /// Values by name. Asking for a name or a type that the description does not have is a programming error
  /// (std::logic_error). `integers` and `reals` stay valid until the value changes.
  bool is_given(std::string_view name) { return data(name).is_given(); }
  bool has_value(std::string_view name);  ///< given, here or where it comes from, or there by default
  bool boolean(std::string_view name) { return get<bool>(name); }
  int integer(std::string_view name) { return static_cast<int>(get<std::int64_t>(name)); }
  double real(std::string_view name) { return get<double>(name); }
  std::optional<double> real_if_given(std::string_view name);
  const std::string& text(std::string_view name) { return get<std::string>(name); }
  const std::vector<std::int64_t>& integers(std::string_view name) { return get<std::vector<std::int64_t>>(name); }
  const std::vector<double>& reals(std::string_view name) { return get<std::vector<double>>(name); }
  Vec3 vector3(std::string_view name);
  Eigen::Map<const PointArray> vectors3(std::string_view name);  ///< one row per group of three

  /// `integers` as node or element numbers; rejects those that are not below `count`.
  std::vector<int> indices(std::string_view name, int count);

  /// Refuses the scene because of an attribute, at the place where it was given.
  [[noreturn]] void reject(std::string_view attribute, const std::string& what, std::string hint = {});
  /// Refuses the scene because of the object as a whole.
  [[noreturn]] void reject(const std::string& what);
  /// Says something about an attribute, or (empty name) about the object, that does not stop the run.
  void remark(Severity severity, std::string_view attribute, const std::string& what);

  /// Called before an output or a state is read: brings it up to date with Data::set.
  virtual void provide(Data&) {}

  /// Names of the inputs whose values are new since accept_inputs. Valid until the next call.
  std::span<const std::string_view> new_inputs();
  void accept_inputs();

 private:
  Data& data(std::string_view name);
  template <class T>
  const T& get(std::string_view name);

  const attributes::Description& description_;
  std::string name_;
  Place place_;
  Diagnostics* diagnostics_ = nullptr;
  std::vector<std::unique_ptr<Data>> data_;
  std::vector<std::string_view> new_inputs_;  // kept, so that a step does not allocate
};

/// Thrown by reject: one thing wrong with the scene, which whoever called the object adds to the others.
class Rejection : public SceneError {
 public:
  explicit Rejection(Message message) : SceneError(format(message)), message_(std::move(message)) {}
  const Message& message() const { return message_; }

 private:
  Message message_;
};

}  // namespace hexaplast::scene
