// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/dependencies.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/Link.h>

#include "attributes/hexaplast.hpp"
#include "parts/material_region.hpp"

namespace hexaplast::sofa_plugin
{

/// Gives some hexahedra of a body values of their own; its body asks for them. Data: the rows of Material, and
/// plugin/attributes/hexaplast.hpp.
class HEXAPLAST_SOFA_API MaterialRegion final : public TableComponent<SofaComponent>
{
public:
    SOFA_CLASS(MaterialRegion, SOFA_TEMPLATE(TableComponent, SofaComponent));
    using Field = HexahedronElastoplasticFEMForceField;
    using VecReal = sofa::type::vector<SReal>;

    Data<MeshTopology::SeqHexahedra>& d_hexahedra = data<MeshTopology::SeqHexahedra>("hexahedra");
    Data<sofa::type::vector<sofa::Index>>& d_indices = data<sofa::type::vector<sofa::Index>>("indices");
    sofa::core::objectmodel::SingleLink<MaterialRegion, Field,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_body{initLink("body", helpOf("body"))};  ///< whose hexahedra they are

    void init() override;
    void reinit() override;

    /// The body that it belongs to; null: there is none.
    Field* body() const;

    /// What it gives to a body with these hexahedra. Where its Data cannot be, it says so, becomes invalid, and gives
    /// nothing.
    /// ofTopology: numbers in the body of the hexahedra of its topology, where some have gone or their nodes have
    /// split; null: they are the same. Then a region that follows other Data, as lists of SOFA's regions, keeps its
    /// hexahedra.
    std::optional<parts::MaterialRegion> values(const std::vector<Hexahedron>& ofBody,
                                                const std::vector<int>* ofTopology);

    /// From now on a change of its Data is one of these.
    void tell(Inputs& ofBody) { ofBody.addInput(&m_inputs); }

protected:
    MaterialRegion() : TableComponent(attributes::kMaterialRegion) {}

private:
    std::optional<std::vector<double>> given(const Row<Material>& row) const;
    std::vector<int> hexahedraIn(const std::vector<Hexahedron>& body, const std::vector<int>* ofTopology) const;

    std::optional<std::vector<int>> m_hexahedra;  ///< given last, by their numbers in the body
    int m_counter = 0;                            ///< of changes of the lists until then
    Inputs m_inputs{*this, attributes::kMaterialRegion};
};

}  // namespace hexaplast::sofa_plugin
