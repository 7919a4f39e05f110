// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/BaseObject.h>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

/// What `hexaplast run` records. In SOFA that is the business of Monitor and of scripts, which may read it.
class Probe final : public TableComponent<sofa::core::objectmodel::BaseObject>
{
public:
    SOFA_CLASS(Probe, SOFA_TEMPLATE(TableComponent, sofa::core::objectmodel::BaseObject));

    Data<sofa::type::vector<SReal>> d_value{fromTable(d_value, "value")};
    Data<sofa::type::vector<sofa::Index>> d_indices{fromTable(d_indices, "indices")};
    Data<sofa::type::vector<sofa::type::Vec3>> d_points{fromTable(d_points, "points")};
    DataWord d_component{fromTable(d_component, "component")};
    DataWord d_statistic{fromTable(d_statistic, "statistic")};
    Data<bool> d_change{fromTable(d_change, "change")};

protected:
    Probe() : TableComponent(attributes::kProbe) {}
};

void registerProbe(sofa::core::ObjectFactory* factory) { register_component<Probe>(factory, attributes::kProbe); }

}  // namespace hexaplast::sofa_plugin
