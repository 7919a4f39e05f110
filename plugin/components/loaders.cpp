// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "geometry/placement.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

/// Reads a mesh file when the first of its outputs is asked for, or at init.
class MeshLoader : public scene::Component {
 public:
  MeshLoader(const attributes::Description& description, MeshFormat format) : Component(description), format_(format) {}

  void init() override { mesh(); }

  void provide(scene::Data& output) override {
    const std::string_view name = output.attribute().name;
    if (name == "position") output.set_once([this] { return flattened(mesh().positions); });
    if (name == "edges") output.set_once([this] { return flattened<2>(mesh().edges); });
    if (name == "triangles") output.set_once([this] { return flattened<3>(mesh().triangles); });
    if (name == "quads") output.set_once([this] { return flattened<4>(mesh().quads); });
    if (name == "hexahedra") output.set_once([this] { return flattened<8>(mesh().hexahedra); });
  }

 protected:
  const ImportedMesh& mesh() {
    if (stage() == Stage::kFailed || is_refused_) throw scene::DependencyFailure();
    if (mesh_) return *mesh_;
    is_refused_ = true;  // until it is there: whoever asks again has no more to say
    mesh_ = loaded();
    is_refused_ = false;
    for (const std::string& sentence : what_is_left_out(*mesh_))
      remark(scene::Severity::kWarning, "filename", sentence);
    return *mesh_;
  }

  /// The mesh as it is in the file; null: it cannot be read, and init tells why.
  const ImportedMesh* file() {
    if (mesh_) return &*mesh_;
    if (text("filename").empty()) return nullptr;
    try {
      return file_ ? &*file_ : &file_.emplace(read_mesh(path(), format_));
    } catch (const InputError&) {
      return nullptr;
    }
  }

  std::filesystem::path path() {
    const std::string& name = text("filename");
    if (name.empty()) reject("filename", "is not given, must name a mesh file");
    return node().files().input(name, place());
  }

 private:
  ImportedMesh loaded() {
    const std::filesystem::path file = path();
    ImportedMesh mesh;
    try {
      mesh = file_ ? std::move(*file_) : read_mesh(file, format_);
    } catch (const InputError& error) {
      const bool is_missing = !std::filesystem::exists(file);
      reject("filename", error.what(), is_missing ? node().files().search.places_of(text("filename")) : "");
    }
    hexaplast::place(mesh.positions, real("scale") * vector3("scale3d"), vector3("rotation"), vector3("translation"));
    if (boolean("triangulate")) triangulate(mesh);
    if (format_ == MeshFormat::kGmsh) add_boundaries_of_cells(mesh);  // as SOFA's does, and the others do not
    return mesh;
  }

  const MeshFormat format_;
  std::optional<ImportedMesh> file_, mesh_;
  bool is_refused_ = false;
};

/// Gives what its file says about hexahedra besides.
class LabelledMeshLoader : public MeshLoader, public scene::ArraySource {
 public:
  using MeshLoader::MeshLoader;

  void provide(scene::Data& output) final {
    mesh();  // or refuses
    MeshLoader::provide(output);
  }

  scene::Data* array(std::string_view name) final {
    const auto known =
        std::ranges::find(arrays_, name, [](const auto& array) { return std::string_view(array->name); });
    if (known != arrays_.end()) return &(*known)->data;
    const ImportedMesh* const mesh = file();
    std::optional<scene::Value> found = mesh ? array_of(*mesh, name) : nothing();
    if (!found) return nullptr;
    scene::Data& data = arrays_.emplace_back(std::make_unique<Array>(*this, name, *found))->data;
    data.set(std::move(*found));
    return &data;
  }

 protected:
  /// Numbers: real or whole ones. None where the file has no such array.
  virtual std::optional<scene::Value> array_of(const ImportedMesh& mesh, std::string_view name) = 0;
  virtual scene::Value nothing() const = 0;  ///< no such numbers

 private:
  struct Array {
    Array(scene::Object& loader, std::string_view name_in_file, const scene::Value& value)
        : name(name_in_file),
          attribute{.name = name,
                    .type = std::holds_alternative<std::vector<double>>(value) ? attributes::Type::kReals
                                                                               : attributes::Type::kIntegers,
                    .access = attributes::Access::kOutput},
          data(loader, attribute) {}

    std::string name;
    attributes::Attribute attribute;
    scene::Data data;
  };

  std::vector<std::unique_ptr<Array>> arrays_;
};

/// Gives the cell data of .vtu files, as SOFA's does: of the hexahedra, in their order.
class MeshVTKLoader final : public LabelledMeshLoader, public scene::MayBeOfPatient {
 public:
  MeshVTKLoader() : LabelledMeshLoader(attributes::kMeshVTKLoader, MeshFormat::kVtk) {}

  bool is_of_patient() override { return mesh().is_of_patient && vector3("rotation").isZero(0); }

 private:
  std::optional<scene::Value> array_of(const ImportedMesh&, std::string_view name) override {
    ImportedState state;
    try {
      state = read_vtu_state(path());
    } catch (const InputError&) {
      return std::nullopt;  // a legacy file, which has none
    }
    const auto found = std::ranges::find(state.cell_data, name, &ImportedArray::name);
    if (found == state.cell_data.end() || found->num_components != 1) return std::nullopt;
    std::vector<double> values;
    for (const int cell : state.hexahedron_cells) values.push_back(found->values[static_cast<std::size_t>(cell)]);
    return values;
  }
  scene::Value nothing() const override { return std::vector<double>(); }
};

/// Gives the hexahedra of physical groups.
class MeshGmshLoader final : public LabelledMeshLoader {
 public:
  MeshGmshLoader() : LabelledMeshLoader(attributes::kMeshGmshLoader, MeshFormat::kGmsh) {}

 private:
  std::optional<scene::Value> array_of(const ImportedMesh& mesh, std::string_view name) override {
    const auto found = std::ranges::find(mesh.groups, name, &ImportedGroup::name);
    if (found == mesh.groups.end()) return std::nullopt;
    return std::vector<std::int64_t>(found->hexahedra.begin(), found->hexahedra.end());
  }
  scene::Value nothing() const override { return std::vector<std::int64_t>(); }
};

}  // namespace

void add_loaders(scene::Factory& factory) {
  using namespace attributes;
  factory.add<MeshGmshLoader>(kMeshGmshLoader);
  factory.add<MeshVTKLoader>(kMeshVTKLoader);
  factory.add(kMeshOBJLoader, [] { return std::make_unique<MeshLoader>(kMeshOBJLoader, MeshFormat::kObj); });
  factory.add(kMeshSTLLoader, [] { return std::make_unique<MeshLoader>(kMeshSTLLoader, MeshFormat::kStl); });
}

}  // namespace hexaplast::components
