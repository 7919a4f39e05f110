// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_GRASPFORCEFIELD_CPP
#include <Hexaplast/registration.h>

#include <Hexaplast/GraspForceField.inl>

namespace hexaplast::sofa_plugin
{

template class HEXAPLAST_SOFA_API GraspForceField<Vec3Types>;

void registerGraspForceField(sofa::core::ObjectFactory* factory)
{
    register_component<GraspForceField<Vec3Types>>(factory, attributes::kGraspForceField);
}

}  // namespace hexaplast::sofa_plugin
