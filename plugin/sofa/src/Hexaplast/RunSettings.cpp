// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/BaseObject.h>

#include "attributes/parts.hpp"

namespace hexaplast::sofa_plugin
{

/// How long `hexaplast run` runs a scene. In SOFA that is the business of runSofa; scripts may read it.
class RunSettings final : public sofa::core::objectmodel::BaseObject
{
public:
    SOFA_CLASS(RunSettings, sofa::core::objectmodel::BaseObject);

    Data<int> d_steps{from_table(*this, d_steps, row(attributes::kRunSettings, "steps"))};
    Data<int> d_outputEvery{from_table(*this, d_outputEvery, row(attributes::kRunSettings, "outputEvery"))};
    DataWord d_endSections{from_table(*this, d_endSections, row(attributes::kRunSettings, "endSections"))};
};

void registerRunSettings(sofa::core::ObjectFactory* factory)
{
    register_component<RunSettings>(factory, attributes::kRunSettings);
}

}  // namespace hexaplast::sofa_plugin
