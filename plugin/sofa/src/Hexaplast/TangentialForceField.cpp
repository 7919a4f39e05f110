// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_TANGENTIALFORCEFIELD_CPP
#include <Hexaplast/registration.h>

#include <Hexaplast/TangentialForceField.inl>

namespace hexaplast::sofa_plugin
{

template class HEXAPLAST_SOFA_API TangentialForceField<Vec3Types>;

void registerTangentialForceField(sofa::core::ObjectFactory* factory)
{
    register_component<TangentialForceField<Vec3Types>>(factory, attributes::kTangentialForceField);
}

}  // namespace hexaplast::sofa_plugin
