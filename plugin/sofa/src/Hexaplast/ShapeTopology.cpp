// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/SheetGridTopology.h>
#include <Hexaplast/SpherePatchGridTopology.h>
#include <Hexaplast/TubeGridTopology.h>
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

[[maybe_unused]] const bool kShapesAreRegistered =
    registerComponent<TubeGridTopology>(attributes::kTubeGridTopology) &&
    registerComponent<SheetGridTopology>(attributes::kSheetGridTopology) &&
    registerComponent<SpherePatchGridTopology>(attributes::kSpherePatchGridTopology);

}  // namespace hexaplast::sofa_plugin
