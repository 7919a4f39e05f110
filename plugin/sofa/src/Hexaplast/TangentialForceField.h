// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/PartForceField.h>

#include "attributes/parts.hpp"
#include "parts/tangential_load.hpp"

namespace hexaplast::sofa_plugin
{

/// Forces around an axis that turn with the body. Data: plugin/attributes/parts.hpp.
template <class TDataTypes>
class TangentialForceField : public PartForceField<TDataTypes>
{
public:
    SOFA_CLASS(SOFA_TEMPLATE(TangentialForceField, TDataTypes), SOFA_TEMPLATE(PartForceField, TDataTypes));
    using Inherit = PartForceField<TDataTypes>;

    Data<sofa::type::vector<sofa::Index>> d_indices{this->fromTable(d_indices, "indices")};
    Data<int> d_groupSize{this->fromTable(d_groupSize, "groupSize")};
    Data<sofa::type::Vec3> d_axis{this->fromTable(d_axis, "axis")};
    Data<sofa::type::Vec3> d_centre{this->fromTable(d_centre, "centre")};
    Data<sofa::type::vector<SReal>> d_times{this->fromTable(d_times, "times")};
    Data<sofa::type::vector<SReal>> d_forces{this->fromTable(d_forces, "forces")};

    bool hasPart() const override { return m_load.has_value(); }
    bool isInMatrix() const override { return false; }

protected:
    TangentialForceField() : Inherit(attributes::kTangentialForceField) {}

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
