// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/core/objectmodel/Link.h>

#include "parts/material_region.hpp"

namespace hexaplast::sofa_plugin
{

/// Gives some hexahedra of a body values of their own; its body asks for them. Data: the rows of Material, and
/// plugin/attributes/hexaplast.hpp.
class HEXAPLAST_SOFA_API MaterialRegion final : public sofa::core::objectmodel::BaseObject
{
public:
    SOFA_CLASS(MaterialRegion, sofa::core::objectmodel::BaseObject);
    using Field = HexahedronElastoplasticFEMForceField<Vec3Types>;
    using VecReal = sofa::type::vector<SReal>;

    Data<MeshTopology::SeqHexahedra> d_hexahedra;     ///< by their nodes
    Data<sofa::type::vector<sofa::Index>> d_indices;  ///< or by their numbers
    Data<VecReal> d_youngModulus;                     ///< [Pa] one, or one per hexahedron of the region
    Data<VecReal> d_poissonRatio;                     ///< one, or one per hexahedron of the region
    Data<VecReal> d_yieldStress;                      ///< [Pa] one, or one per hexahedron of the region
    Data<SReal> d_plasticFlowRate;                    ///< [1/s] of stretch in excess of yield
    Data<SReal> d_rotationYield;                      ///< [rad] at which rotation begins to flow
    Data<SReal> d_rotationFlowRate;                   ///< [1/s] of rotation in excess of rotationYield
    Data<SReal> d_hardening;                          ///< growth of the yield limits with the flow
    Data<SReal> d_fractureStress;                     ///< [Pa] beyond which a hexahedron tears
    Data<SReal> d_fractureStretch;                    ///< beyond which a hexahedron tears
    sofa::core::objectmodel::SingleLink<MaterialRegion, Field,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_body;  ///< whose hexahedra they are

    void init() override;
    void reinit() override;

    /// The body that it belongs to; null: there is none.
    Field* body() const;

    /// What it gives to a body with these hexahedra. Where its Data cannot be, it says so, becomes invalid, and gives
    /// nothing.
    std::optional<parts::MaterialRegion> values(const std::vector<Hexahedron>& ofBody);

    /// Whether Data have changed since this was asked last.
    bool haveChanged() { return m_inputs.have_changed(); }

protected:
    MaterialRegion();

private:
    template <class T>
    auto fromRow(Data<T>& data, std::string_view name);

    std::optional<std::vector<double>> given(const Row<Material>& row) const;

    Inputs m_inputs;
};

}  // namespace hexaplast::sofa_plugin
