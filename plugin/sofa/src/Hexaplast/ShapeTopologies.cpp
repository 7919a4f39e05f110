// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>

#include "attributes/shapes.hpp"
#include "parts/grids.hpp"

namespace hexaplast::sofa_plugin
{

/// A topology of SOFA whose nodes and hexahedra are those of a grid that is bent into shape. Data:
/// plugin/attributes/shapes.hpp.
template <class Options, const auto& kTable>
class ShapeTopology final : public TableComponent<sofa::component::topology::container::constant::MeshTopology>
{
public:
    using Inherit = sofa::component::topology::container::constant::MeshTopology;
    SOFA_CLASS(ShapeTopology, SOFA_TEMPLATE(TableComponent, Inherit));
    static std::string GetCustomClassName() { return std::string(kTable.class_name); }
    static std::string GetCustomTemplateName() { return {}; }

    void init() override
    {
        attempt(*this,
                [&]
                {
                    const HexMesh grid = parts::make_grid(readOptions<Options>());
                    auto points = sofa::helper::getWriteOnlyAccessor(d_seqPoints);
                    points.resize(grid.positions().rows());
                    view(points.wref()) = grid.positions();
                    auto hexahedra = sofa::helper::getWriteOnlyAccessor(d_seqHexahedra);
                    hexahedra.clear();
                    for (const hexaplast::Hexahedron& corners : grid.hexahedra())
                        hexahedra.push_back(hexahedronOf(corners));
                });
        Inherit::init();
    }

protected:
    ShapeTopology() : TableComponent(kTable, "Shape") {}
};

[[maybe_unused]] const bool kShapesAreRegistered =
    registerComponent<ShapeTopology<parts::TubeGridOptions, attributes::kTubeGridTopology>>(
        attributes::kTubeGridTopology) &&
    registerComponent<ShapeTopology<parts::SheetGridOptions, attributes::kSheetGridTopology>>(
        attributes::kSheetGridTopology) &&
    registerComponent<ShapeTopology<parts::SpherePatchGridOptions, attributes::kSpherePatchGridTopology>>(
        attributes::kSpherePatchGridTopology);

}  // namespace hexaplast::sofa_plugin
