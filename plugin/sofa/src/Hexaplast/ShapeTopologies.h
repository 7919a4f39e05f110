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
class HEXAPLAST_SOFA_API ShapeTopology : public sofa::component::topology::container::constant::MeshTopology
{
public:
    using Inherit = sofa::component::topology::container::constant::MeshTopology;
    SOFA_ABSTRACT_CLASS(ShapeTopology, Inherit);

    void init() override;

protected:
    explicit ShapeTopology(const Description& description) : m_description(description) {}

    template <class T>
    typename Data<T>::InitData fromTable(Data<T>& data, std::string_view name)
    {
        return from_table(*this, data, attributes::attribute_of(m_description, name), "Shape");
    }

    virtual HexMesh makeGrid() const = 0;

    template <class Options>
    HexMesh make() const
    {
        return parts::make_grid(read_options<Options>(*this, m_description));
    }

private:
    const Description& m_description;
};

class HEXAPLAST_SOFA_API TubeGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(TubeGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells")};
    Data<SReal> d_innerRadius{fromTable(d_innerRadius, "innerRadius")};
    Data<SReal> d_outerRadius{fromTable(d_outerRadius, "outerRadius")};
    Data<SReal> d_length{fromTable(d_length, "length")};
    Data<SReal> d_bend{fromTable(d_bend, "bend")};
    Data<sofa::type::vector<sofa::type::Vec3>> d_centreline{fromTable(d_centreline, "centreline")};

protected:
    TubeGridTopology() : ShapeTopology(attributes::kTubeGridTopology) {}
    HexMesh makeGrid() const override { return make<parts::TubeGridOptions>(); }
};

class HEXAPLAST_SOFA_API SheetGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SheetGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells")};
    Data<sofa::type::vector<SReal>> d_size{fromTable(d_size, "size")};
    Data<SReal> d_thickness{fromTable(d_thickness, "thickness")};
    Data<SReal> d_curvature{fromTable(d_curvature, "curvature")};

protected:
    SheetGridTopology() : ShapeTopology(attributes::kSheetGridTopology) {}
    HexMesh makeGrid() const override { return make<parts::SheetGridOptions>(); }
};

class HEXAPLAST_SOFA_API SpherePatchGridTopology : public ShapeTopology
{
public:
    SOFA_CLASS(SpherePatchGridTopology, ShapeTopology);

    Data<sofa::type::vector<sofa::Index>> d_cells{fromTable(d_cells, "cells")};
    Data<SReal> d_innerRadius{fromTable(d_innerRadius, "innerRadius")};
    Data<SReal> d_outerRadius{fromTable(d_outerRadius, "outerRadius")};
    Data<SReal> d_angle{fromTable(d_angle, "angle")};

protected:
    SpherePatchGridTopology() : ShapeTopology(attributes::kSpherePatchGridTopology) {}
    HexMesh makeGrid() const override { return make<parts::SpherePatchGridOptions>(); }
};

}  // namespace hexaplast::sofa_plugin
