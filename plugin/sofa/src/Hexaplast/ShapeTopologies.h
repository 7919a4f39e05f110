// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/config.h>
#include <Hexaplast/table.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>

#include "attributes/shapes.hpp"
#include "parts/grids.hpp"

namespace hexaplast::sofa_plugin
{

/// A topology of SOFA whose nodes and hexahedra are those of a grid that is bent into shape. Data:
/// plugin/attributes/shapes.hpp.
class HEXAPLAST_SOFA_API ShapeTopology
    : public TableComponent<sofa::component::topology::container::constant::MeshTopology>
{
public:
    using Inherit = sofa::component::topology::container::constant::MeshTopology;
    SOFA_ABSTRACT_CLASS(ShapeTopology, SOFA_TEMPLATE(TableComponent, Inherit));

    void init() override;

protected:
    using TableComponent::TableComponent;

    virtual HexMesh makeGrid() const = 0;
};

class HEXAPLAST_SOFA_API TubeGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(TubeGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells", "Shape")};
    Data<SReal> d_innerRadius{fromTable(d_innerRadius, "innerRadius", "Shape")};
    Data<SReal> d_outerRadius{fromTable(d_outerRadius, "outerRadius", "Shape")};
    Data<SReal> d_length{fromTable(d_length, "length", "Shape")};
    Data<SReal> d_bend{fromTable(d_bend, "bend", "Shape")};
    Data<sofa::type::vector<sofa::type::Vec3>> d_centreline{fromTable(d_centreline, "centreline", "Shape")};

protected:
    TubeGridTopology() : ShapeTopology(attributes::kTubeGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::TubeGridOptions>()); }
};

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

class HEXAPLAST_SOFA_API SpherePatchGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SpherePatchGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells", "Shape")};
    Data<SReal> d_innerRadius{fromTable(d_innerRadius, "innerRadius", "Shape")};
    Data<SReal> d_outerRadius{fromTable(d_outerRadius, "outerRadius", "Shape")};
    Data<SReal> d_angle{fromTable(d_angle, "angle", "Shape")};

protected:
    SpherePatchGridTopology() : ShapeTopology(attributes::kSpherePatchGridTopology) {}
    HexMesh makeGrid() const override { return parts::make_grid(readOptions<parts::SpherePatchGridOptions>()); }
};

}  // namespace hexaplast::sofa_plugin
