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

protected:
    SheetGridTopology() : ShapeTopology(attributes::kSheetGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::SheetGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
