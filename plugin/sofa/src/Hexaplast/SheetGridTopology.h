// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/ShapeTopology.h>

#include "attributes/shapes.hpp"
#include "parts/grids.hpp"

namespace hexaplast::sofa_plugin
{

/// Data: plugin/attributes/shapes.hpp.
class HEXAPLAST_SOFA_API SheetGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SheetGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells", "Shape")};
    Data<sofa::type::vector<SReal>> d_size{fromTable(d_size, "size", "Shape")};
    Data<SReal> d_thickness{fromTable(d_thickness, "thickness", "Shape")};
    Data<SReal> d_curvature{fromTable(d_curvature, "curvature", "Shape")};

protected:
    SheetGridTopology() : ShapeTopology(attributes::kSheetGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::SheetGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
