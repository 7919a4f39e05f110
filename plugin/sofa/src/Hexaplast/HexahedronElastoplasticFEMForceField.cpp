// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_HEXAHEDRONELASTOPLASTICFEMFORCEFIELD_CPP
#include <Hexaplast/registration.h>

#include <Hexaplast/HexahedronElastoplasticFEMForceField.inl>

namespace hexaplast::sofa_plugin
{

template class HEXAPLAST_SOFA_API HexahedronElastoplasticFEMForceField<Vec3Types>;

[[maybe_unused]] const bool kBodyIsRegistered = registerComponent<HexahedronElastoplasticFEMForceField<Vec3Types>>(
    attributes::kHexahedronElastoplasticFEMForceField);

}  // namespace hexaplast::sofa_plugin
