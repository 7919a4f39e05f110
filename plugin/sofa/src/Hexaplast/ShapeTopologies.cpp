// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/ShapeTopologies.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/fields.h>
#include <Hexaplast/registration.h>

#include "attributes/shapes.hpp"
#include "parts/grids.hpp"

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

TubeGridTopology::TubeGridTopology()
    : d_cells(from_table(*this, d_cells, row(attributes::kTubeGridTopology, "cells"), "Shape")),
      d_innerRadius(from_table(*this, d_innerRadius, row(attributes::kTubeGridTopology, "innerRadius"), "Shape")),
      d_outerRadius(from_table(*this, d_outerRadius, row(attributes::kTubeGridTopology, "outerRadius"), "Shape")),
      d_length(from_table(*this, d_length, row(attributes::kTubeGridTopology, "length"), "Shape")),
      d_bend(from_table(*this, d_bend, row(attributes::kTubeGridTopology, "bend"), "Shape")),
      d_centreline(from_table(*this, d_centreline, row(attributes::kTubeGridTopology, "centreline"), "Shape"))
{
}

HexMesh TubeGridTopology::makeGrid() const
{
    parts::TubeGridOptions options{.cells = whole_numbers(d_cells.getValue()),
                                   .inner_radius = d_innerRadius.getValue(),
                                   .outer_radius = d_outerRadius.getValue(),
                                   .length = d_length.getValue(),
                                   .bend = d_bend.getValue()};
    if (d_centreline.isSet()) options.centreline = view(d_centreline.getValue());
    return make_grid(options);
}

SheetGridTopology::SheetGridTopology()
    : d_cells(from_table(*this, d_cells, row(attributes::kSheetGridTopology, "cells"), "Shape")),
      d_size(from_table(*this, d_size, row(attributes::kSheetGridTopology, "size"), "Shape")),
      d_thickness(from_table(*this, d_thickness, row(attributes::kSheetGridTopology, "thickness"), "Shape")),
      d_curvature(from_table(*this, d_curvature, row(attributes::kSheetGridTopology, "curvature"), "Shape"))
{
}

HexMesh SheetGridTopology::makeGrid() const
{
    return make_grid(parts::SheetGridOptions{.cells = whole_numbers(d_cells.getValue()),
                                             .size = reals(d_size.getValue()),
                                             .thickness = d_thickness.getValue(),
                                             .curvature = d_curvature.getValue()});
}

SpherePatchGridTopology::SpherePatchGridTopology()
    : d_cells(from_table(*this, d_cells, row(attributes::kSpherePatchGridTopology, "cells"), "Shape")),
      d_innerRadius(
          from_table(*this, d_innerRadius, row(attributes::kSpherePatchGridTopology, "innerRadius"), "Shape")),
      d_outerRadius(
          from_table(*this, d_outerRadius, row(attributes::kSpherePatchGridTopology, "outerRadius"), "Shape")),
      d_angle(from_table(*this, d_angle, row(attributes::kSpherePatchGridTopology, "angle"), "Shape"))
{
}

HexMesh SpherePatchGridTopology::makeGrid() const
{
    return make_grid(parts::SpherePatchGridOptions{.cells = whole_numbers(d_cells.getValue()),
                                                   .inner_radius = d_innerRadius.getValue(),
                                                   .outer_radius = d_outerRadius.getValue(),
                                                   .angle = d_angle.getValue()});
}

void registerShapeTopologies(sofa::core::ObjectFactory* factory)
{
    register_component<TubeGridTopology>(factory, attributes::kTubeGridTopology);
    register_component<SheetGridTopology>(factory, attributes::kSheetGridTopology);
    register_component<SpherePatchGridTopology>(factory, attributes::kSpherePatchGridTopology);
}

}  // namespace hexaplast::sofa_plugin
