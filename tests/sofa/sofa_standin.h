// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <istream>
#include <list>
#include <map>
#include <memory>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

/// Not SOFA: the names and signatures of v26.06 that the plugin uses, in the place of all of its headers, so that the
/// plugin's files are compiled with all warnings where SOFA is absent, and its components are registered and have Data.
/// There is no graph and no mechanics: what needs them ends in absent(). Whether the plugin works in SOFA is tested in
/// SOFA (plugin/sofa/tests). Never installed; no other target includes it.

#define SOFA_VERSION 260600
#define SOFA_EXPORT_DYNAMIC_LIBRARY
#define SOFA_IMPORT_DYNAMIC_LIBRARY

using SReal = double;

namespace sofa_standin {

[[noreturn]] inline void absent() { throw std::logic_error("the stand-in for SOFA has no graph and no mechanics"); }

/// Errors and warnings of components since the list was cleared.
inline std::vector<std::string>& messages() {
  static std::vector<std::string> list;
  return list;
}

struct Message {
  explicit Message(const void* /*component*/ = nullptr) {}
  ~Message() { messages().push_back(text_.str()); }
  template <class T>
  Message& operator<<(const T& value) {
    text_ << value;
    return *this;
  }

 private:
  std::ostringstream text_;
};

/// "Class" of "Class" and of "SOFA_TEMPLATE(Class, T)".
inline std::string class_name(std::string text) {
  text.erase(0, text.find('(') + 1);
  return text.substr(0, text.find(','));
}

/// That, unless the class gives itself a name, as SOFA asks it for one.
template <class T>
std::string name_of(std::string text) {
  if constexpr (requires { T::GetCustomClassName(); })
    return T::GetCustomClassName();
  else
    return class_name(std::move(text));
}

}  // namespace sofa_standin

#define msg_error(...) ::sofa_standin::Message(__VA_ARGS__)
#define msg_warning(...) ::sofa_standin::Message(__VA_ARGS__)
#define msg_info(...) std::ostringstream()

#define SOFA_TEMPLATE(Class, Argument) Class<Argument>
#define SOFA_ABSTRACT_CLASS(Class, Parent) \
  template <class>                         \
  friend struct ::sofa::core::objectmodel::New
#define SOFA_CLASS(Class, ...)                                                                 \
  std::string getClassName() const override { return ::sofa_standin::name_of<Class>(#Class); } \
  template <class>                                                                             \
  friend struct ::sofa::core::objectmodel::New

namespace sofa {

using sofa_standin::absent;
using Index = unsigned int;
using Size = Index;

namespace type {

enum NoInit { NOINIT };

template <std::size_t N, class Real>
struct Vec : std::array<Real, N> {
  Vec() : std::array<Real, N>{} {}
  Vec(Real x, Real y, Real z) requires(N == 3) : std::array<Real, N>{x, y, z} {}
  Real* ptr() { return this->data(); }
  const Real* ptr() const { return this->data(); }
};
using Vec3 = Vec<3, SReal>;

template <class T>
struct vector : std::vector<T> {
  using std::vector<T>::vector;
};

template <std::size_t Rows, std::size_t Columns, class Real>
struct Mat {
  explicit Mat(NoInit) {}
  Real& operator()(std::size_t, std::size_t) { absent(); }
};

struct RGBAColor {
  RGBAColor(float, float, float, float) {}
  static RGBAColor gray() { return {0, 0, 0, 1}; }
  static RGBAColor red() { return gray(); }
  static RGBAColor green() { return gray(); }
  static RGBAColor yellow() { return gray(); }
};

struct BoundingBox {
  BoundingBox() = default;
  BoundingBox(const Vec3&, const Vec3&) {}
  void include(const Vec3&) {}
};

template <std::size_t N, class Real>
std::istream& operator>>(std::istream& in, Vec<N, Real>& value) {
  for (Real& each : value) in >> each;
  return in;
}
template <std::size_t N, class Real>
std::ostream& operator<<(std::ostream& out, const Vec<N, Real>& value) {
  for (const Real& each : value) out << each << " ";
  return out;
}
template <class T>
std::istream& operator>>(std::istream& in, vector<T>& values) {
  values.clear();
  for (T each; in >> each;) values.push_back(each);
  if (in.eof()) in.clear(std::ios::eofbit);
  return in;
}
template <class T>
std::ostream& operator<<(std::ostream& out, const vector<T>& values) {
  for (const T& each : values) out << each << " ";
  return out;
}

}  // namespace type

namespace defaulttype {
struct Vec3Types {
  using Coord = type::Vec3;
  using Deriv = type::Vec3;
  using VecCoord = type::vector<Coord>;
  using VecDeriv = type::vector<Deriv>;
  static const char* Name() { return "Vec3d"; }
};
}  // namespace defaulttype

namespace helper {

/// One of some words. Like SOFA's it stays what it is where it is told another word.
struct OptionsGroup {
  OptionsGroup() = default;
  template <class Words>
  explicit OptionsGroup(const Words& words) : words_(words.begin(), words.end()), selected_(words_.front()) {}

  void setSelectedItem(const std::string& word) {
    if (std::ranges::count(words_, word) > 0) selected_ = word;
  }
  const std::string& getSelectedItem() const { return selected_; }
  unsigned int getSelectedId() const {
    return static_cast<unsigned int>(std::ranges::find(words_, selected_) - words_.begin());
  }

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

}  // namespace helper

// Data, components, the factory

namespace core {

template <class T>
struct sptr {
  sptr(T* target = nullptr) : target_(target) {}
  T* get() const { return target_; }
  T* operator->() const { return target_; }
  T& operator*() const { return *target_; }
  explicit operator bool() const { return target_ != nullptr; }

 private:
  T* target_;
};

struct ExecParams {};
namespace execparams {
inline const ExecParams* defaultInstance() { absent(); }
}  // namespace execparams

namespace behavior {
struct BaseMechanicalState;
}

namespace topology {
struct Topology;
struct BaseMeshTopology;
}  // namespace topology

namespace visual {
struct VisualParams;
}

namespace objectmodel {

struct DDGNode {
  virtual ~DDGNode() = default;
  virtual void update() = 0;
  void addInput(DDGNode*) {}
  void addOutput(DDGNode*) {}
  bool isDirty() const { return false; }
  void setDirtyValue() {}
  void cleanDirty() {}
  void updateIfDirty() const {}

 protected:
  std::vector<DDGNode*> inputs;
};

/// What a file or a script gives to a component.
struct BaseObjectDescription {
  std::map<std::string, std::string> attributes;
  const char* getAttribute(const std::string& name) const {
    const auto found = attributes.find(name);
    return found == attributes.end() ? nullptr : found->second.c_str();
  }
};

struct AbstractTypeInfo {
  bool ValidInfo() const { absent(); }
  bool Scalar() const { absent(); }
  bool Integer() const { absent(); }
  bool Text() const { absent(); }
  Size size() const { absent(); }
  Size size(const void*) const { absent(); }
  SReal getScalarValue(const void*, Size) const { absent(); }
};

struct Base {
  virtual ~Base() = default;
};

struct BaseData : DDGNode {
  struct Init {
    std::string help;
    bool is_displayed = true, is_read_only = false;
    std::string group = {};
  };

  explicit BaseData(Init init) : init_(std::move(init)) {}
  void update() override {}
  virtual bool read(const std::string& text) = 0;
  virtual std::string getValueString() const = 0;

  bool isSet() const { return is_set_; }
  void unset() { is_set_ = false; }
  int getCounter() const { return counter_; }
  bool isReadOnly() const { return init_.is_read_only; }
  const std::string& getHelp() const { return init_.help; }
  const std::string& getGroup() const { return init_.group; }
  void setGroup(const std::string& group) { init_.group = group; }
  BaseData* getParent() const { return nullptr; }
  Base* getOwner() const { absent(); }
  bool setParent(BaseData*) { absent(); }
  const AbstractTypeInfo* getValueTypeInfo() const { absent(); }
  const void* getValueVoidPtr() const { absent(); }

 protected:
  void set() {
    is_set_ = true;
    ++counter_;
  }

 private:
  Init init_;
  bool is_set_ = false;
  int counter_ = 0;
};

template <class T>
struct Data : BaseData {
  struct InitData : Init {
    T value{};
  };

  Data(const Init& init = {}) : BaseData(init) {}
  Data(const InitData& init) : BaseData(init), value_(init.value) {}

  const T& getValue() const { return value_; }
  void setValue(const T& value) { *beginEdit() = value; }
  T* beginEdit() {
    set();
    return &value_;
  }
  T* beginWriteOnly() { return beginEdit(); }
  void endEdit() {}

  bool read(const std::string& text) override {
    T value = value_;
    if constexpr (std::is_same_v<T, std::string>) {
      value = text;
    } else if constexpr (requires(std::istream & in) { in >> value; }) {
      std::istringstream in(text);
      if (!(in >> std::boolalpha >> value)) return false;
    } else {
      return false;
    }
    setValue(value);
    return true;
  }
  std::string getValueString() const override {
    std::ostringstream out;
    if constexpr (requires { out << value_; }) out << std::boolalpha << value_;
    return out.str();
  }

 private:
  T value_{};
};

struct DataCallback {
  void addInputs(std::initializer_list<BaseData*>) {}
  void addCallback(const std::function<void()>&) {}
};

struct DataFileName : Data<std::string> {
  using Data<std::string>::Data;
  const std::string& getFullPath() const { return getValue(); }
};

struct BaseComponent;

struct BaseLink {
  enum Flags { FLAG_NONE = 0, FLAG_STOREPATH = 1, FLAG_STRONGLINK = 2 };
  struct Init {};
  const BaseComponent* getLinkedBase() const { absent(); }
};

template <class Owner, class Target, unsigned flags>
struct SingleLink : BaseLink {
  SingleLink(const Init& = {}) {}
  Target* get() const { return target_; }
  std::string getLinkedPath() const { return {}; }
  void set(Target* target, const std::string& /*path*/ = {}) { target_ = target; }
  operator Target*() const { return target_; }
  Target* operator->() const { return target_; }

 private:
  Target* target_ = nullptr;
};

enum class ComponentState { Undefined, Loading, Valid, Dirty, Busy, Invalid };

struct Event {
  virtual ~Event() = default;
};

struct BaseContext {
  enum SearchDirection { SearchUp = -1, Local = 0, SearchDown = 1 };

  SReal getDt() const { absent(); }
  SReal getTime() const { absent(); }
  bool getAnimate() const { absent(); }
  void setAnimate(bool) { absent(); }
  BaseContext* getRootContext() const { absent(); }
  topology::BaseMeshTopology* getMeshTopologyLink() const { absent(); }
  behavior::BaseMechanicalState* getMechanicalState() const { absent(); }
  template <class T>
  T* get(SearchDirection = SearchUp) const {
    absent();
  }
  template <class T>
  void get(T*&, SearchDirection = SearchUp) const {
    absent();
  }
  template <class T>
  void get(std::vector<T*>*, SearchDirection = SearchUp) const {
    absent();
  }
};

/// Makes objects whose constructors are protected, as those of components are.
template <class T>
struct New {
  static std::shared_ptr<T> make() { return std::shared_ptr<T>(new T); }
};

/// In no node.
struct BaseComponent : Base {
  BaseComponent() = default;
  BaseComponent(const BaseComponent&) = delete;

  virtual std::string getClassName() const = 0;
  std::string getName() const { return getClassName(); }
  std::string getPathName() const { return "/" + getName(); }
  std::string getInstanciationSourceFileName() const { return {}; }
  int getInstanciationSourceFilePos() const { return 0; }
  const BaseContext* getContext() const { return nullptr; }
  BaseContext* getContext() { return nullptr; }

  virtual void parse(BaseObjectDescription* given) {
    for (const auto& [name, text] : given->attributes)
      if (BaseData* data = findData(name)) data->read(text);
  }
  virtual void init() {}
  virtual void bwdInit() {}
  virtual void reinit() {}
  virtual void reset() {}
  virtual void handleEvent(Event*) {}
  virtual void handleTopologyChange(topology::Topology*) {}
  virtual void draw(const visual::VisualParams*) {}
  virtual void computeBBox(const ExecParams*, bool /*only_visible*/ = false) {}

  BaseData* findData(const std::string& name) const {
    const auto found = data_.find(name);
    return found == data_.end() ? nullptr : found->second;
  }

  // Called before the Data is constructed, from what they return.
  template <class T>
  BaseData::Init initData(Data<T>* data, const char* name, const char* help, bool is_displayed = true,
                          bool is_read_only = false) {
    data_[name] = data;
    return {help, is_displayed, is_read_only};
  }
  template <class T>
  typename Data<T>::InitData initData(Data<T>* data, const std::type_identity_t<T>& value, const char* name,
                                      const char* help, bool is_displayed = true, bool is_read_only = false) {
    return {initData(data, name, help, is_displayed, is_read_only), value};
  }

  Data<ComponentState> d_componentState;
  Data<bool> f_listening;
  Data<type::BoundingBox> f_bbox;

  BaseLink::Init initLink(const char*, const char*) { return {}; }
  const BaseLink* findLink(const std::string&) const { absent(); }

 private:
  std::map<std::string, BaseData*> data_;
};
using BaseObject = BaseComponent;

}  // namespace objectmodel

using objectmodel::BaseData;

struct ObjectRegistrationData {
  explicit ObjectRegistrationData(const std::string& help) : help_(help) {}

  template <class T>
  ObjectRegistrationData& add() {
    make_ = [] { return std::shared_ptr<objectmodel::BaseComponent>(objectmodel::New<T>::make()); };
    if constexpr (requires { typename T::DataTypes; }) template_name_ = T::DataTypes::Name();
    return *this;
  }

 private:
  friend struct ObjectFactory;
  std::string help_, template_name_;
  std::function<std::shared_ptr<objectmodel::BaseComponent>()> make_;
};

/// Knows classes by the name that their objects say they have.
struct ObjectFactory {
  struct Entry {
    std::string help, template_name;
    std::function<std::shared_ptr<objectmodel::BaseComponent>()> make;
  };

  bool registerObjects(ObjectRegistrationData& data) {
    return entries.insert({data.make_()->getClassName(), {data.help_, data.template_name_, data.make_}}).second;
  }

  std::map<std::string, Entry> entries;
};

}  // namespace core

namespace helper {

template <class T>
struct ReadAccessor {
  const T& ref() const { absent(); }
};

template <class T>
struct WriteAccessor {
  T& wref() { absent(); }
  std::size_t size() const { absent(); }
  void resize(std::size_t) { absent(); }
  void clear() { absent(); }
  void push_back(const auto&) { absent(); }
};
template <class T>
WriteAccessor<T> getWriteAccessor(core::objectmodel::Data<T>&) {
  return {};
}
template <class T>
WriteAccessor<T> getWriteOnlyAccessor(core::objectmodel::Data<T>&) {
  return {};
}

}  // namespace helper

// events, drawing, topologies

namespace simulation {
struct AnimateBeginEvent : core::objectmodel::Event {
  SReal getDt() const { absent(); }
  static bool checkEventType(const Event*) { absent(); }
};
struct AnimateEndEvent : AnimateBeginEvent {};
struct UpdateMappingEndEvent : AnimateBeginEvent {};
struct IntegrateBeginEvent : AnimateBeginEvent {};
}  // namespace simulation

namespace helper {

struct ColorMap {
  ColorMap(unsigned int, const std::string&) {}
  auto getEvaluator(SReal, SReal) const {
    return [](SReal) { return type::RGBAColor::gray(); };
  }
};

namespace visual {
struct DrawTool {
  struct StateLifeCycle {
    ~StateLifeCycle() {}
  };
  StateLifeCycle makeStateLifeCycle() { absent(); }
  void setPolygonMode(int, bool) {}
  void enableLighting() {}
  void disableLighting() {}
  void drawTriangles(const std::vector<type::Vec3>&, const std::vector<type::RGBAColor>&) {}
  void drawTriangles(const std::vector<type::Vec3>&, const type::RGBAColor&) {}
  void drawLines(const std::vector<type::Vec3>&, float, const type::RGBAColor&) {}
  void drawPoints(const std::vector<type::Vec3>&, float, const type::RGBAColor&) {}
};
}  // namespace visual
}  // namespace helper

namespace core::visual {
struct DisplayFlags {
  bool getShowForceFields() const { absent(); }
  bool getShowWireFrame() const { absent(); }
  bool getShowVisualModels() const { absent(); }
};
struct VisualParams {
  const DisplayFlags& displayFlags() const { absent(); }
  helper::visual::DrawTool* drawTool() const { absent(); }
};
}  // namespace core::visual

namespace core::topology {

enum TopologyChangeType { POINTSADDED, POINTSREMOVED, POINTSRENUMBERING, HEXAHEDRAADDED, HEXAHEDRAREMOVED, OTHER };

struct TopologyChange {
  virtual ~TopologyChange() = default;
  TopologyChangeType getChangeType() const { absent(); }
};
struct HexahedraRemoved : TopologyChange {
  const type::vector<Index>& getArray() const { absent(); }
};

struct Topology : objectmodel::BaseComponent {
  using Hexahedron = type::Vec<8, Index>;
  using Hexa = Hexahedron;
  using SeqHexahedra = type::vector<Hexahedron>;
  using Triangle = type::Vec<3, Index>;
  using SeqTriangles = type::vector<Triangle>;
};
struct BaseMeshTopology : Topology {
  const SeqHexahedra& getHexahedra() { absent(); }
  std::size_t getNbHexahedra() { absent(); }
  std::list<const TopologyChange*>::const_iterator beginChange() const { absent(); }
  std::list<const TopologyChange*>::const_iterator endChange() const { absent(); }
};

}  // namespace core::topology

namespace component::topology::container {
namespace constant {
struct MeshTopology : core::topology::BaseMeshTopology {
  core::objectmodel::Data<type::vector<type::Vec3>> d_seqPoints{initData(&d_seqPoints, "position", "")};
  core::objectmodel::Data<SeqHexahedra> d_seqHexahedra{initData(&d_seqHexahedra, "hexahedra", "")};
  core::objectmodel::Data<type::vector<Index>> d_seqQuads{initData(&d_seqQuads, "quads", "")};
  core::objectmodel::Data<type::vector<Index>> d_seqEdges{initData(&d_seqEdges, "edges", "")};
};
}  // namespace constant
namespace grid {
struct SparseGridTopology : constant::MeshTopology {
  float getStiffnessCoef(Index) { absent(); }
};
}  // namespace grid
namespace dynamic {
struct HexahedronSetTopologyContainer : core::topology::BaseMeshTopology {};
struct HexahedronSetTopologyModifier : core::objectmodel::BaseComponent {
  core::objectmodel::Data<bool> removeIsolated;
  using Ancestors = type::vector<type::vector<Index>>;
  using Coefficients = type::vector<type::vector<SReal>>;
  void addPoints(Size, const Ancestors&, const Coefficients&, bool) { absent(); }
  void addHexahedra(const core::topology::Topology::SeqHexahedra&, const Ancestors&, const Coefficients&) { absent(); }
  void removeHexahedra(const type::vector<Index>&) { absent(); }
  void notifyEndingEvent() { absent(); }
};
}  // namespace dynamic
}  // namespace component::topology::container

// states, force fields, linear systems

namespace linearalgebra {
struct BaseVector {
  virtual ~BaseVector() = default;
  SReal element(long) const { absent(); }
};
struct BaseMatrix {
  virtual ~BaseMatrix() = default;
  void add(long, long, SReal) { absent(); }
  long rowSize() const { absent(); }
  long colSize() const { absent(); }
};
template <class Real>
struct SparseMatrix final : BaseMatrix {
  using Index = long;
  using Lines = std::map<Index, std::map<Index, Real>>;
  void resize(Index, Index) { absent(); }
  typename Lines::const_iterator begin() const { absent(); }
  typename Lines::const_iterator end() const { absent(); }
};
}  // namespace linearalgebra

namespace core {

enum class VecDerivId { kOne };
enum class ConstVecId { kPosition, kVelocity };
namespace vec_id::read_access {
inline constexpr ConstVecId position = ConstVecId::kPosition, velocity = ConstVecId::kVelocity;
}
struct MultiVecDerivId {
  VecDerivId getId(const behavior::BaseMechanicalState*) const { absent(); }
};

struct MatricesFactors {
  template <char name>
  struct Factor {
    explicit Factor(SReal) {}
  };
  using M = Factor<'M'>;
  using B = Factor<'B'>;
  using K = Factor<'K'>;
};
struct MechanicalParams {
  SReal mFactor() const { absent(); }
  SReal bFactor() const { absent(); }
  SReal kFactor() const { absent(); }
};
namespace mechanicalparams {
inline SReal kFactorIncludingRayleighDamping(const MechanicalParams*, SReal) { absent(); }
}  // namespace mechanicalparams

struct ConstraintParams {
  MultiVecDerivId lambda() const { absent(); }
};
struct BaseMapping : objectmodel::BaseComponent {
  bool isMechanical() const { absent(); }
  type::vector<behavior::BaseMechanicalState*> getMechTo() { absent(); }
  type::vector<const objectmodel::BaseComponent*> getFrom() { absent(); }
};
struct CollisionModel : objectmodel::BaseComponent {};
namespace topology {
struct TopologicalMapping : objectmodel::BaseComponent {
  Topology* getFrom() { absent(); }
};
}  // namespace topology

namespace behavior {

struct OdeSolver : objectmodel::BaseComponent {};
struct BaseConstraintCorrection : objectmodel::BaseComponent {};
struct ConstraintSolver : objectmodel::BaseComponent {
  void removeConstraintCorrection(BaseConstraintCorrection*) { absent(); }
};

struct BaseMechanicalState : objectmodel::BaseComponent {
  Size getSize() const { absent(); }
  Size getCoordDimension() const { absent(); }
  Size getDerivDimension() const { absent(); }
  void copyToBuffer(SReal*, ConstVecId, unsigned int) const { absent(); }
};
template <class DataTypes>
struct MechanicalState : BaseMechanicalState {
  using VecCoord = typename DataTypes::VecCoord;
  using VecDeriv = typename DataTypes::VecDeriv;
  helper::ReadAccessor<VecCoord> readPositions() const { return {}; }
  helper::ReadAccessor<VecCoord> readRestPositions() const { return {}; }
  helper::ReadAccessor<VecDeriv> readVelocities() const { return {}; }
  helper::WriteAccessor<VecCoord> writePositions() { return {}; }
  helper::WriteAccessor<VecDeriv> writeVelocities() { return {}; }
  const objectmodel::Data<VecDeriv>* read(VecDerivId) { absent(); }
  objectmodel::Data<VecDeriv>* write(VecDerivId) { absent(); }
};

struct StiffnessMatrix {
  struct Block {
    void operator+=(const type::Mat<3, 3, SReal>&) { absent(); }
  };
  struct Derivative {
    Derivative& withRespectToPositionsIn(BaseMechanicalState*) { absent(); }
    Derivative& withRespectToVelocityIn(BaseMechanicalState*) { absent(); }
    Block operator()(int, int) { absent(); }
  };
  Derivative getForceDerivativeIn(BaseMechanicalState*) { return {}; }
};
struct DampingMatrix final : StiffnessMatrix {};

struct StateAccessor : objectmodel::BaseComponent {
  const type::vector<BaseMechanicalState*>& getMechanicalStates() const { absent(); }
};

struct BaseForceField : StateAccessor {
  virtual void buildStiffnessMatrix(StiffnessMatrix*) = 0;
  virtual void buildDampingMatrix(DampingMatrix*) = 0;
  objectmodel::Data<SReal> rayleighStiffness{initData(&rayleighStiffness, 0, "rayleighStiffness", "")};
};

template <class TDataTypes>
struct ForceField : BaseForceField {
  using DataTypes = TDataTypes;
  using DataVecCoord = objectmodel::Data<typename DataTypes::VecCoord>;
  using DataVecDeriv = objectmodel::Data<typename DataTypes::VecDeriv>;

  MechanicalState<DataTypes>* getMState() const { return mstate.get(); }
  virtual void addForce(const MechanicalParams*, DataVecDeriv&, const DataVecCoord&, const DataVecDeriv&) = 0;
  virtual void addDForce(const MechanicalParams*, DataVecDeriv&, const DataVecDeriv&) = 0;
  virtual void addKToMatrix(linearalgebra::BaseMatrix*, SReal, unsigned int&) = 0;
  virtual SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord&) const = 0;

 protected:
  objectmodel::SingleLink<ForceField, MechanicalState<DataTypes>, objectmodel::BaseLink::FLAG_STRONGLINK> mstate;
};

template <class Types1, class Types2>
struct MixedInteractionForceField : BaseForceField {
  using DataTypes = Types1;
  using DataVecCoord1 = objectmodel::Data<typename Types1::VecCoord>;
  using DataVecCoord2 = objectmodel::Data<typename Types2::VecCoord>;
  using DataVecDeriv1 = objectmodel::Data<typename Types1::VecDeriv>;
  using DataVecDeriv2 = objectmodel::Data<typename Types2::VecDeriv>;

  MechanicalState<Types1>* getMState1() const { return mstate1.get(); }
  MechanicalState<Types2>* getMState2() const { return mstate2.get(); }
  virtual void addForce(const MechanicalParams*, DataVecDeriv1&, DataVecDeriv2&, const DataVecCoord1&,
                        const DataVecCoord2&, const DataVecDeriv1&, const DataVecDeriv2&) = 0;
  virtual void addDForce(const MechanicalParams*, DataVecDeriv1&, DataVecDeriv2&, const DataVecDeriv1&,
                         const DataVecDeriv2&) = 0;
  virtual SReal getPotentialEnergy(const MechanicalParams*, const DataVecCoord1&, const DataVecCoord2&) const = 0;

 protected:
  template <class Types>
  using Link = objectmodel::SingleLink<MixedInteractionForceField, MechanicalState<Types>,
                                       objectmodel::BaseLink::FLAG_STRONGLINK>;
  Link<Types1> mstate1;
  Link<Types2> mstate2;
};

struct BaseMass {
  virtual ~BaseMass() = default;
  bool isDiagonal() const { absent(); }
  objectmodel::Data<SReal> rayleighMass;
};

}  // namespace behavior
}  // namespace core

namespace simulation {
namespace common {
struct MechanicalOperations {
  void propagateDxAndResetDf(core::MultiVecDerivId, core::MultiVecDerivId) { absent(); }
  void addMBKdx(core::MultiVecDerivId, core::MatricesFactors::M, core::MatricesFactors::B, core::MatricesFactors::K,
                bool) {
    absent();
  }
  void projectResponse(core::MultiVecDerivId) { absent(); }
};
}  // namespace common
namespace mechanicalvisitor {
struct MechanicalGetConstraintJacobianVisitor {
  MechanicalGetConstraintJacobianVisitor(const core::ConstraintParams*, linearalgebra::BaseMatrix*) {}
  void execute(core::objectmodel::BaseContext*) { absent(); }
};
}  // namespace mechanicalvisitor
}  // namespace simulation

namespace component::odesolver::backward {
struct EulerImplicitSolver : core::behavior::OdeSolver {
  core::objectmodel::Data<bool> d_firstOrder, d_trapezoidalScheme;
  core::objectmodel::Data<SReal> d_rayleighStiffness;
};
}  // namespace component::odesolver::backward

namespace component::mapping::linear {
template <class From, class To>
struct BarycentricMapping : core::BaseMapping {};
}  // namespace component::mapping::linear

namespace component::mass {
template <class DataTypes>
struct DiagonalMass : core::behavior::StateAccessor {
  core::objectmodel::Data<type::vector<SReal>> d_vertexMass;
  SReal getMassDensity() const { absent(); }
};
}  // namespace component::mass

namespace component::constraint::projective {
template <class DataTypes>
struct FixedProjectiveConstraint : core::behavior::StateAccessor {
  core::objectmodel::Data<type::vector<Index>> d_indices;
  void addConstraint(Index) { absent(); }
};
template <class DataTypes>
struct LinearMovementProjectiveConstraint : core::behavior::StateAccessor {
  core::objectmodel::Data<type::vector<Index>> d_indices;
  typename DataTypes::VecCoord x0;
  void addIndex(Index) { absent(); }
};
template <class DataTypes>
struct PartialLinearMovementProjectiveConstraint : LinearMovementProjectiveConstraint<DataTypes> {};
}  // namespace component::constraint::projective

namespace component::constraint::lagrangian {
namespace correction {
template <class DataTypes>
struct LinearSolverConstraintCorrection : core::behavior::BaseConstraintCorrection {};
}  // namespace correction
namespace solver {
struct UnbuiltGaussSeidelConstraintSolver : core::behavior::ConstraintSolver {};
}  // namespace solver
}  // namespace component::constraint::lagrangian

namespace helper::system {
struct PluginManager {
  static PluginManager& getInstance() {
    static PluginManager one;
    return one;
  }
  bool pluginIsLoaded(const std::string&) const { return true; }
  bool registerPlugin(const std::string&) { absent(); }
};
}  // namespace helper::system

namespace component::linearsolver {

struct GraphScatteredVector {
  void clear() { absent(); }
  core::MultiVecDerivId id() const { return {}; }
  operator core::MultiVecDerivId() const { return {}; }
};
struct GraphScatteredMatrix {
  core::MechanicalParams mparams;
  simulation::common::MechanicalOperations* parent = nullptr;
};

template <class Matrix, class Vector>
struct LinearSystem {
  Matrix* getSystemMatrix() { absent(); }
  Vector* getSolutionVector() { absent(); }
  Vector* getRHSVector() { absent(); }
};

template <class Matrix, class Vector>
struct MatrixLinearSolver : core::objectmodel::BaseComponent {
  struct TempVectorContainer {
    TempVectorContainer(MatrixLinearSolver*, const core::ExecParams*, Matrix&, Vector&, Vector&) {}
    Vector* createTempVector() { absent(); }
  };
  virtual void solve(Matrix&, Vector&, Vector&) = 0;
  virtual void invert(Matrix&) = 0;
  virtual bool addJMInvJt(linearalgebra::BaseMatrix*, linearalgebra::BaseMatrix*, SReal) = 0;
  virtual bool buildComplianceMatrix(const core::ConstraintParams*, linearalgebra::BaseMatrix*, SReal, SReal) = 0;
  virtual void applyConstraintForce(const core::ConstraintParams*, core::MultiVecDerivId,
                                    const linearalgebra::BaseVector*) = 0;
  LinearSystem<Matrix, Vector>* getLinearSystem() const { absent(); }
};

}  // namespace component::linearsolver
}  // namespace sofa
