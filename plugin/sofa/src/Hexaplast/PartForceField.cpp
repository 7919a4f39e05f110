// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_PARTFORCEFIELD_CPP
#include <Hexaplast/PartForceField.inl>

namespace hexaplast::sofa_plugin
{

template class HEXAPLAST_SOFA_API PartForceField<Vec3Types>;

}  // namespace hexaplast::sofa_plugin
