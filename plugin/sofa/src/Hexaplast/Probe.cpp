// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/BaseObject.h>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

/// What `hexaplast run` records. In SOFA that is the business of Monitor and of scripts, which may read it.
class Probe final : public sofa::core::objectmodel::BaseObject
{
public:
    SOFA_CLASS(Probe, sofa::core::objectmodel::BaseObject);

    Data<sofa::type::vector<SReal>> d_value{from_table(*this, d_value, row(attributes::kProbe, "value"))};
    Data<sofa::type::vector<sofa::Index>> d_indices{from_table(*this, d_indices, row(attributes::kProbe, "indices"))};
    Data<sofa::type::vector<sofa::type::Vec3>> d_points{from_table(*this, d_points, row(attributes::kProbe, "points"))};
    DataWord d_component{from_table(*this, d_component, row(attributes::kProbe, "component"))};
    DataWord d_statistic{from_table(*this, d_statistic, row(attributes::kProbe, "statistic"))};
    Data<bool> d_change{from_table(*this, d_change, row(attributes::kProbe, "change"))};
};

void registerProbe(sofa::core::ObjectFactory* factory) { register_component<Probe>(factory, attributes::kProbe); }

}  // namespace hexaplast::sofa_plugin
