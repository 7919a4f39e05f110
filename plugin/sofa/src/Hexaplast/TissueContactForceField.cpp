// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_TISSUECONTACTFORCEFIELD_CPP
#include <Hexaplast/registration.h>

#include <Hexaplast/TissueContactForceField.inl>

namespace hexaplast::sofa_plugin
{

template class HEXAPLAST_SOFA_API TissueContactForceField<Vec3Types>;

void registerTissueContactForceField(sofa::core::ObjectFactory* factory)
{
    register_component<TissueContactForceField<Vec3Types>>(factory, attributes::kTissueContactForceField);
}

}  // namespace hexaplast::sofa_plugin
