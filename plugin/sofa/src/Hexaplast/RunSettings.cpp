// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/BaseObject.h>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

/// How long `hexaplast run` runs a scene. In SOFA that is the business of runSofa; scripts may read it.
class RunSettings final : public TableComponent<sofa::core::objectmodel::BaseObject>
{
public:
    SOFA_CLASS(RunSettings, SOFA_TEMPLATE(TableComponent, sofa::core::objectmodel::BaseObject));

    Data<int> d_steps{fromTable(d_steps, "steps")};
    Data<int> d_outputEvery{fromTable(d_outputEvery, "outputEvery")};
    DataWord d_endSections{fromTable(d_endSections, "endSections")};

protected:
    RunSettings() : TableComponent(attributes::kRunSettings) {}
};

void registerRunSettings(sofa::core::ObjectFactory* factory)
{
    register_component<RunSettings>(factory, attributes::kRunSettings);
}

}  // namespace hexaplast::sofa_plugin
