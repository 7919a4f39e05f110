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
  using Read = ImportedMesh (*)(const std::filesystem::path&);

  MeshLoader(const attributes::Description& description, Read read) : Component(description), read_(read) {}

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

  /// Whether the file can be read; init tells why not.
  bool is_readable() {
    if (text("filename").empty()) return false;
    try {
      read_(path());
      return true;
    } catch (const InputError&) {
      return false;
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
      mesh = read_(file);
    } catch (const InputError& error) {
      const bool is_missing = !std::filesystem::exists(file);
      reject("filename", error.what(), is_missing ? node().files().search.places_of(text("filename")) : "");
    }
    hexaplast::place(mesh.positions, real("scale") * vector3("scale3d"), vector3("rotation"), vector3("translation"));
    if (boolean("triangulate")) triangulate(mesh);
    if (boolean("createSubelements")) add_boundaries_of_cells(mesh);
    if (boolean("onlyAttachedPoints")) remove_unused_nodes(mesh);
    return mesh;
  }

  Read read_;
  std::optional<ImportedMesh> mesh_;
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
    std::optional<scene::Value> found;
    try {
      if (!text("filename").empty()) found = read_array(name);
    } catch (const InputError&) {  // legacy files of VTK have none
    }
    if (!found && is_readable()) return nullptr;
    if (!found) found = nothing();
    scene::Data& data = arrays_.emplace_back(std::make_unique<Array>(*this, name, *found))->data;
    data.set(std::move(*found));
    return &data;
  }

 protected:
  /// Numbers: real or whole ones. None where the file has no such array.
  virtual std::optional<scene::Value> read_array(std::string_view name) = 0;
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
  MeshVTKLoader() : LabelledMeshLoader(attributes::kMeshVTKLoader, read_vtk) {}

  bool is_of_patient() override { return mesh().is_of_patient && vector3("rotation").isZero(0); }

 private:
  std::optional<scene::Value> read_array(std::string_view name) override {
    const ImportedState state = read_vtu_state(path());
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
  MeshGmshLoader() : LabelledMeshLoader(attributes::kMeshGmshLoader, read_gmsh) {}

 private:
  std::optional<scene::Value> read_array(std::string_view name) override {
    const std::vector<ImportedGroup> groups = read_gmsh_groups(path());
    const auto found = std::ranges::find(groups, name, &ImportedGroup::name);
    if (found == groups.end()) return std::nullopt;
    return std::vector<std::int64_t>(found->hexahedra.begin(), found->hexahedra.end());
  }
  scene::Value nothing() const override { return std::vector<std::int64_t>(); }
};

class MeshSTLLoader final : public MeshLoader {
 public:
  MeshSTLLoader() : MeshLoader(attributes::kMeshSTLLoader, read_stl) {}

  void init() override {
    if (integer("headerSize") != 80) reject("headerSize", "must be 80, as the format has it");
    MeshLoader::init();
  }
};

}  // namespace

void add_loaders(scene::Factory& factory) {
  using namespace attributes;
  factory.add<MeshGmshLoader>(kMeshGmshLoader);
  factory.add<MeshVTKLoader>(kMeshVTKLoader);
  factory.add(kMeshOBJLoader, [] { return std::make_unique<MeshLoader>(kMeshOBJLoader, read_obj); });
  factory.add<MeshSTLLoader>(kMeshSTLLoader);
}

}  // namespace hexaplast::components
