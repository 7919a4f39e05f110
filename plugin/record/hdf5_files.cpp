// SPDX-License-Identifier: LGPL-2.1-or-later
// The module with the HDF5 library (field_file.hpp).
#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "record/field_file.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

constexpr hsize_t kChunkBytes =
    256 * 1024;  // several states of small bodies together; a part of one state of large ones
constexpr unsigned kCompression = 4;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
using Shape = std::vector<hsize_t>;

/// An object of the HDF5 library.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close end, const fs::path& file, const char* what) : id_(id), close_(end) {
    if (id_ < 0) throw OutputError(fmt::format("{}: HDF5 {}", file.string(), what));
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): as the library's calls take it
  bool close() { return close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  Close close_;
};

void require(bool is_well, const fs::path& file, const char* what) {
  if (!is_well) throw OutputError(fmt::format("{}: HDF5 {}", file.string(), what));
}

/// Messages of the library go nowhere: failures are exceptions of ours. At the end of the program it must not try once
/// more to write what a full disk has refused, which it does not survive.
void keep_quiet() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle space_of(const Shape& shape, const fs::path& file, const Shape& max = {}) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), max.empty() ? nullptr : max.data()), H5Sclose,
          file, "cannot make a data space"};
}

Handle text_type(std::size_t size, const fs::path& file) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, file, "cannot make a type of texts");
  require(H5Tset_size(type, std::max<std::size_t>(size, 1)) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0, file,
          "cannot make a type of texts");
  return type;
}

/// An attribute of variable length, which readers take for a text, and not for bytes.
void set_text(hid_t object, const std::string& name, std::string_view text, const fs::path& file) {
  const Handle type = text_type(H5T_VARIABLE, file);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, file, "cannot make a data space");
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, file,
                         "cannot write an attribute");
  const std::string written(text);
  const char* begin = written.c_str();
  require(H5Awrite(attribute, type, &begin) >= 0, file, "cannot write an attribute");
}

/// A data set, with the groups that its name tells.
Handle make(hid_t file_id, const std::string& name, hid_t type, hid_t space, hid_t made_with, const fs::path& file) {
  const Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose, file, "cannot make properties");
  require(H5Pset_create_intermediate_group(link, 1) >= 0, file, "cannot make properties");
  return {H5Dcreate2(file_id, name.c_str(), type, space, link, made_with, H5P_DEFAULT), H5Dclose, file,
          "cannot make a data set"};
}

/// Properties of data sets that hold no moment of their making, so that equal runs make equal files.
Handle properties(const fs::path& file) {
  Handle made(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, file, "cannot make properties");
  require(H5Pset_obj_track_times(made, false) >= 0, file, "cannot make properties");
  return made;
}

/// A data set as a whole.
void write_all(hid_t file_id, const std::string& name, hid_t stored, hid_t given, const Shape& shape, const void* data,
               std::string_view unit, const fs::path& file) {
  const Handle space = space_of(shape, file);
  const Handle set = make(file_id, name, stored, space, properties(file), file);
  if (!unit.empty()) set_text(set, "unit", unit, file);
  require(H5Dwrite(set, given, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0, file, "cannot write a data set");
}

void write_texts(hid_t file_id, const std::string& name, const std::vector<std::string>& texts, const fs::path& file) {
  std::size_t size = 1;
  for (const std::string& text : texts) size = std::max(size, text.size());
  std::string packed(size * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(packed.data() + i * size, size);
  const Handle type = text_type(size, file);
  write_all(file_id, name, type, type, {texts.size()}, packed.data(), "", file);
}

/// A file of ours under its unfinished name, opened by what it is. Nothing else locks it: WholeFile does.
Handle create(const WholeFile& part, const fs::path& file) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, file, "cannot make properties");
  require(H5Pset_file_locking(access, false, true) >= 0, file, "cannot make properties");
  return {H5Fcreate(fmt::format("/proc/self/fd/{}", part.descriptor()).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access),
          H5Fclose, file, "cannot create the file"};
}

/// A data set that grows by a row per state.
class Series {
 public:
  Series(hid_t file_id, const std::string& name, hid_t stored, Shape row, std::string_view unit, const fs::path& file)
      : file_(file), row_(std::move(row)), set_(make_set(file_id, name, stored)) {
    if (!unit.empty()) set_text(set_, "unit", unit, file);
  }

  hid_t id() const { return set_; }

  void append(hid_t given, const void* data) {
    Shape all = with_states(num_states_ + 1), one = with_states(1), from(all.size(), 0);
    from[0] = num_states_++;
    require(H5Dset_extent(set_, all.data()) >= 0, file_, "cannot make room for a state");
    const Handle there(H5Dget_space(set_), H5Sclose, file_, "cannot make a data space"), here = space_of(one, file_);
    require(H5Sselect_hyperslab(there, H5S_SELECT_SET, from.data(), nullptr, one.data(), nullptr) >= 0 &&
                H5Dwrite(set_, given, here, there, H5P_DEFAULT, data) >= 0,
            file_, "cannot write a state");
  }

 private:
  Shape with_states(hsize_t count) const {
    Shape shape = {count};
    shape.insert(shape.end(), row_.begin(), row_.end());
    return shape;
  }

  Handle make_set(hid_t file_id, const std::string& name, hid_t stored) const {
    Shape chunk = with_states(1), max = with_states(H5S_UNLIMITED);
    hsize_t bytes = sizeof(double);
    for (std::size_t d = row_.size(); d-- > 0;) {
      chunk[d + 1] = std::max<hsize_t>(1, std::min(row_[d], kChunkBytes / bytes));
      bytes *= chunk[d + 1];
    }
    chunk[0] = std::clamp<hsize_t>(kChunkBytes / bytes, 1, 256);
    const Handle made_with = properties(file_), space = space_of(with_states(0), file_, max);
    require(H5Pset_chunk(made_with, static_cast<int>(chunk.size()), chunk.data()) >= 0 &&
                H5Pset_shuffle(made_with) >= 0 && H5Pset_deflate(made_with, kCompression) >= 0,
            file_, "cannot compress");
    return make(file_id, name, stored, space, made_with, file_);
  }

  fs::path file_;
  Shape row_;
  hsize_t num_states_ = 0;
  Handle set_;
};

/// A field of nodes, one row each.
PointArray nodal_values(Field field, const Bodies& bodies, const FieldState& state) {
  const PointArray& initial = bodies.mesh().positions();
  switch (field) {
    case Field::kDisplacement:
      return state.positions - initial;
    case Field::kVelocity:
      return state.velocities;
    case Field::kPlasticDisplacement:
      return bodies.plastic_rest_positions() - initial;
    case Field::kLoads:
      return state.conditions.loads;
    default:
      break;
  }
  PointArray forces = PointArray::Zero(initial.rows(), 3);
  for (const Instrument& instrument : state.conditions.instruments)
    for (std::size_t i = 0; i < instrument.nodes.size(); ++i)
      forces.row(instrument.nodes[i]) += instrument.forces.row(static_cast<Eigen::Index>(i));
  return forces;
}

/// A field of hexahedra.
const std::vector<double>& element_values(Field field, const ElementFields& fields) {
  switch (field) {
    case Field::kStrain:
      return fields.strain;
    case Field::kStress:
      return fields.stress_norm;
    case Field::kYieldStress:
      return fields.yield_stress;
    case Field::kVolumeRatio:
      return fields.volume_ratio;
    default:
      return fields.plastic_strain;
  }
}

class Hdf5FieldFile final : public FieldFile {
 public:
  Hdf5FieldFile(const fs::path& place, Bodies of, FieldPlan how)
      : path_(place), bodies_(std::move(of)), plan_(std::move(how)), part_(place), file_(create(part_, place)) {
    const HexMesh& mesh = bodies_.mesh();
    const auto n = static_cast<hsize_t>(mesh.num_nodes()), m = static_cast<hsize_t>(mesh.num_elements());
    for (const auto& [name, text] : plan_.attributes) set_text(file_, name, text, path_);
    {
      const Handle overrides(H5Gcreate2(file_, "overrides", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path_,
                             "cannot make a group");
      for (const auto& [name, text] : plan_.overrides) set_text(overrides, name, text, path_);
    }
    write_all(file_, "positions", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {n, 3}, mesh.positions().data(), "m", path_);
    write_all(file_, "hexahedra", H5T_STD_I32LE, H5T_NATIVE_INT, {m, 8}, mesh.hexahedra().data(), "", path_);
    step_.emplace(file_, "step", H5T_STD_I64LE, Shape{}, "", path_);
    time_.emplace(file_, "time", H5T_IEEE_F64LE, Shape{}, "s", path_);
    for (const Field field : plan_.fields) {
      const FieldEntry& entry = entry_of(field);
      const Series& series = fields_.emplace_back(file_, fmt::format("fields/{}", entry.word), H5T_IEEE_F64LE,
                                                  entry.of_nodes ? Shape{n, 3} : Shape{m}, entry.unit, path_);
      set_text(series.id(), "description", entry.help, path_);
      set_text(series.id(), "of", entry.of_nodes ? "nodes" : "hexahedra", path_);
    }
    for (const std::string& probe : plan_.probes)
      probes_.emplace_back(file_, "probes/" + probe, H5T_IEEE_F64LE, Shape{}, "", path_);
  }

  bool wants(long step) const override { return step % plan_.every == 0; }
  long last_step() const override { return last_step_; }

  void record(const FieldState& state) override {
    const auto step = static_cast<long long>(state.step);
    step_->append(H5T_NATIVE_LLONG, &step);
    time_->append(H5T_NATIVE_DOUBLE, &state.time);
    for (std::size_t p = 0; p < probes_.size(); ++p) probes_[p].append(H5T_NATIVE_DOUBLE, &state.probes[p]);

    const auto is_of_elements = [](Field field) { return !entry_of(field).of_nodes; };
    ElementFields of_elements;
    if (std::ranges::any_of(plan_.fields, is_of_elements)) of_elements = bodies_.fields(state.positions);
    const std::span<const unsigned char> alive = bodies_.alive();
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const Field field = plan_.fields[f];
      if (is_of_elements(field)) {
        std::vector<double> values = element_values(field, of_elements);
        for (std::size_t e = 0; e < values.size(); ++e)
          if (!alive[e]) values[e] = kNoNumber;
        fields_[f].append(H5T_NATIVE_DOUBLE, values.data());
      } else {
        fields_[f].append(H5T_NATIVE_DOUBLE, nodal_values(field, bodies_, state).data());
      }
    }
    last_step_ = state.step;
  }

  void complete(const NamedTexts& attributes) override {
    for (const auto& [name, text] : attributes) set_text(file_, name, text, path_);
    fields_.clear();
    probes_.clear();
    step_.reset();
    time_.reset();
    require(file_.close(), path_, "cannot complete the file");
    part_.commit();
  }

 private:
  fs::path path_;
  Bodies bodies_;
  FieldPlan plan_;
  WholeFile part_;
  Handle file_;
  std::optional<Series> step_, time_;
  std::vector<Series> fields_, probes_;
  long last_step_ = -1;
};

std::unique_ptr<FieldFile> begin_field_file(const fs::path& file, Bodies bodies, FieldPlan plan) {
  keep_quiet();
  return std::make_unique<Hdf5FieldFile>(file, std::move(bodies), std::move(plan));
}

// Files over many runs.

/// A data set of a run's file.
struct Found {
  Shape shape;
  bool is_whole_number;
  std::string unit;
};

// From version 1.12 on the callback is given another struct, and the function that takes it has a number of its own.
#if H5_VERSION_GE(1, 12, 0)
constexpr auto kVisit = H5Ovisit3;
#else
constexpr auto kVisit = H5Ovisit2;
#endif

/// Those with numbers, by their names in the file.
std::map<std::string, Found> find_sets(const fs::path& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, path, "cannot make properties");
  require(H5Pset_file_locking(access, false, true) >= 0, path, "cannot make properties");
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, path, "cannot open the file");
  std::map<std::string, Found> found;
  const auto visit = [](hid_t id, const char* name, const auto* info, void* data) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const hid_t set = H5Dopen2(id, name, H5P_DEFAULT), space = H5Dget_space(set), type = H5Dget_type(set);
    Found one{Shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space)))),
              H5Tget_class(type) == H5T_INTEGER,
              {}};
    H5Sget_simple_extent_dims(space, one.shape.data(), nullptr);
    if (H5Aexists(set, "unit") > 0) {
      const hid_t attribute = H5Aopen(set, "unit", H5P_DEFAULT), text = H5Aget_type(attribute);
      char* unit = nullptr;
      if (H5Tis_variable_str(text) > 0 && H5Aread(attribute, text, &unit) >= 0 && unit) one.unit = unit;
      H5free_memory(unit);
      H5Tclose(text);
      H5Aclose(attribute);
    }
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
    static_cast<std::map<std::string, Found>*>(data)->emplace(name, std::move(one));
    return 0;
  };
  require(kVisit(file, H5_INDEX_NAME, H5_ITER_INC, visit, &found, H5O_INFO_BASIC) >= 0, path, "cannot read the file");
  return found;
}

void write_virtual(hid_t file_id, const std::string& name, const Found& one, std::span<const fs::path> runs,
                   const fs::path& path) {
  Shape all = {runs.size()}, slab = {1}, from(one.shape.size() + 1, 0);
  all.insert(all.end(), one.shape.begin(), one.shape.end());
  slab.insert(slab.end(), one.shape.begin(), one.shape.end());
  const Handle made_with = properties(path), there = space_of(all, path), here = space_of(one.shape, path);
  const long long no_count = -1;
  require(H5Pset_fill_value(made_with, one.is_whole_number ? H5T_NATIVE_LLONG : H5T_NATIVE_DOUBLE,
                            one.is_whole_number ? static_cast<const void*>(&no_count) : &kNoNumber) >= 0,
          path, "cannot make properties");
  for (std::size_t run = 0; run < runs.size(); ++run) {
    if (runs[run].empty()) continue;
    from[0] = run;
    require(H5Sselect_hyperslab(there, H5S_SELECT_SET, from.data(), nullptr, slab.data(), nullptr) >= 0 &&
                H5Pset_virtual(made_with, there, runs[run].filename().c_str(), ("/" + name).c_str(), here) >= 0,
            path, "cannot refer to a file");
  }
  const Handle space = space_of(all, path);
  const Handle set = make(file_id, name, one.is_whole_number ? H5T_STD_I64LE : H5T_IEEE_F64LE, space, made_with, path);
  if (!one.unit.empty()) set_text(set, "unit", one.unit, path);
}

std::vector<std::string> write_file_over(const fs::path& path, std::span<const fs::path> runs,
                                         std::span<const StudyColumn> columns, const NamedTexts& attributes) {
  keep_quiet();
  std::map<std::string, Found> common;
  std::set<std::string> differing;
  for (const fs::path& run : runs) {
    if (run.empty()) continue;
    for (auto& [name, one] : find_sets(run)) {
      const auto [place, is_new] = common.try_emplace(name, one);
      if (!is_new && place->second.shape != one.shape) differing.insert(name);
    }
  }

  WholeFile part(path);
  {
    Handle file = create(part, path);
    for (const auto& [name, text] : attributes) set_text(file, name, text, path);
    for (const StudyColumn& column : columns)
      if (!column.texts.empty())
        write_texts(file, column.name, column.texts, path);
      else
        write_all(file, column.name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {column.numbers.size()}, column.numbers.data(),
                  column.unit, path);
    for (const auto& [name, one] : common)
      if (!differing.contains(name)) write_virtual(file, name, one, runs, path);
    require(file.close(), path, "cannot complete the file");
  }
  part.commit();
  return {differing.begin(), differing.end()};
}

}  // namespace
}  // namespace hexaplast::output

extern "C" const hexaplast::output::FieldFileModule HEXAPLAST_FIELD_FILE_ENTRY;
const hexaplast::output::FieldFileModule HEXAPLAST_FIELD_FILE_ENTRY{hexaplast::output::begin_field_file,
                                                                    hexaplast::output::write_file_over};
