// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_INSTRUMENTCONTACTFORCEFIELD_CPP
#include <Hexaplast/registration.h>

#include <Hexaplast/InstrumentContactForceField.inl>

namespace hexaplast::sofa_plugin
{

template class HEXAPLAST_SOFA_API InstrumentContactForceField<Vec3Types>;

void registerInstrumentContactForceField(sofa::core::ObjectFactory* factory)
{
    register_component<InstrumentContactForceField<Vec3Types>>(factory, attributes::kInstrumentContactInSofa);
}

}  // namespace hexaplast::sofa_plugin
