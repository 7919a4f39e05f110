// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/ShapeTopologies.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/fields.h>
#include <Hexaplast/registration.h>

namespace hexaplast::sofa_plugin
{

void ShapeTopology::init()
{
    attempt(*this,
            [&]
            {
                const HexMesh grid = makeGrid();
                auto points = sofa::helper::getWriteOnlyAccessor(d_seqPoints);
                points.resize(grid.positions().rows());
                view(points.wref()) = grid.positions();
                auto hexahedra = sofa::helper::getWriteOnlyAccessor(d_seqHexahedra);
                hexahedra.clear();
                for (const hexaplast::Hexahedron& corners : grid.hexahedra())
                {
                    Hexa hexahedron;
                    for (std::size_t a = 0; a < corners.size(); ++a)
                        hexahedron[a] = static_cast<sofa::Index>(corners[a]);
                    hexahedra.push_back(hexahedron);
                }
            });
    Inherit::init();
}

void registerShapeTopologies(sofa::core::ObjectFactory* factory)
{
    register_component<TubeGridTopology>(factory, attributes::kTubeGridTopology);
    register_component<SheetGridTopology>(factory, attributes::kSheetGridTopology);
    register_component<SpherePatchGridTopology>(factory, attributes::kSpherePatchGridTopology);
}

}  // namespace hexaplast::sofa_plugin
