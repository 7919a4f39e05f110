// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/AttributeData.h>
#include <Hexaplast/registration.h>
#include <sofa/core/objectmodel/BaseObject.h>

#include "attributes/hexaplast.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

/// How long `hexaplast run` runs a scene. In SOFA that is the business of runSofa; scripts may read it.
class RunSettings final : public sofa::core::objectmodel::BaseObject
{
public:
    SOFA_CLASS(RunSettings, sofa::core::objectmodel::BaseObject);

protected:
    RunSettings() : m_attributes(*this, attributes::kRunSettings) {}

private:
    AttributeData m_attributes;
};

}  // namespace

void register_settings(sofa::core::ObjectFactory* factory)
{
    register_component<RunSettings>(factory, attributes::kRunSettings);
}

}  // namespace hexaplast::sofa_plugin
