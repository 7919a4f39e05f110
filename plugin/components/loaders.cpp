// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "attributes/stock.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/placement.hpp"

namespace hexaplast::components {
namespace {

/// Reads a mesh file when the first of its outputs is asked for, or at init.
class MeshLoader final : public scene::Component {
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

 private:
  const ImportedMesh& mesh() {
    if (stage() == Stage::kFailed || is_refused_) throw scene::DependencyFailure();
    if (mesh_) return *mesh_;
    is_refused_ = true;  // until it is there: whoever asks again has no more to say
    mesh_ = loaded();
    is_refused_ = false;
    if (mesh_->num_skipped > 0)
      remark(scene::Severity::kWarning, "filename",
             fmt::format("{} cells are skipped: neither edges, triangles, quads nor hexahedra of first order",
                         mesh_->num_skipped));
    return *mesh_;
  }

  ImportedMesh loaded() {
    node().files().inputs.add(path());
    ImportedMesh mesh;
    try {
      mesh = read_(path());
    } catch (const InputError& error) {
      reject("filename", error.what());
    }
    transform(mesh.positions);
    if (boolean("triangulate")) triangulate(mesh);
    if (boolean("createSubelements")) add_boundaries_of_cells(mesh);
    if (boolean("onlyAttachedPoints")) remove_unused_nodes(mesh);
    return mesh;
  }

  std::filesystem::path path() {
    const std::string& name = text("filename");
    if (name.empty()) reject("filename", "is not given, must name a mesh file");
    return std::filesystem::path(place().file).parent_path() / name;
  }

  void transform(PointArray& points) {
    const std::vector<double>& rows = reals("transformation");
    if (rows.empty())
      return hexaplast::place(points, real("scale") * vector3("scale3d"), vector3("rotation"), vector3("translation"));
    if (rows.size() != 16) reject("transformation", fmt::format("{} numbers given, must be sixteen", rows.size()));
    const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.data());
    points = (points * matrix.topLeftCorner<3, 3>().transpose()).rowwise() + matrix.topRightCorner<3, 1>().transpose();
  }

  Read read_;
  std::optional<ImportedMesh> mesh_;
  bool is_refused_ = false;
};

}  // namespace

void add_loaders(scene::Factory& factory) {
  using namespace attributes;
  for (const auto& [description, read] : std::initializer_list<std::pair<const Description*, MeshLoader::Read>>{
           {&kMeshGmshLoader, read_gmsh}, {&kMeshVTKLoader, read_vtk}, {&kMeshOBJLoader, read_obj}})
    factory.add(*description,
                [description = description, read = read] { return std::make_unique<MeshLoader>(*description, read); });
}

}  // namespace hexaplast::components
