// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>

#include "parts/tangential_load.hpp"

namespace hexaplast::sofa_plugin
{

/// Forces around an axis that turn with the body.
template <class TDataTypes>
class TangentialForceField : public PartForceField<TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(TangentialForceField, TDataTypes), SOFA_TEMPLATE(PartForceField, TDataTypes));
    using Inherit = PartForceField<TDataTypes>;

    Data<sofa::type::vector<sofa::Index>> d_indices;  ///< nodes, group after group
    Data<int> d_groupSize;                            ///< consecutive indices that form a group
    Data<sofa::type::Vec3> d_axis;                    ///< direction of the axis
    Data<sofa::type::Vec3> d_centre;                  ///< [m] a point on the axis
    Data<sofa::type::vector<SReal>> d_times;          ///< [s] key times
    Data<sofa::type::vector<SReal>> d_forces;         ///< [N] on each group at each key time

    bool hasPart() const override { return m_load.has_value(); }
    bool isInMatrix() const override { return false; }

protected:
    TangentialForceField();

    void makePart() override;
    void updatePart() override { makePart(); }
    void addPartForce(SReal time, ConstPoints x, ConstPoints v, Points f) override;

private:
    std::optional<parts::TangentialLoad> m_load;
};

#if !defined(HEXAPLAST_TANGENTIALFORCEFIELD_CPP)
extern template class HEXAPLAST_SOFA_API TangentialForceField<Vec3Types>;
#endif

}  // namespace hexaplast::sofa_plugin
