// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/GuestForceField.h>
#include <Hexaplast/registration.h>

#include "attributes/hexaplast.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

class TangentialForceField final : public GuestForceField
{
public:
    SOFA_CLASS(TangentialForceField, GuestForceField);

protected:
    TangentialForceField() : GuestForceField(attributes::kTangentialForceField) {}
};

class GraspForceField final : public GuestForceField
{
public:
    SOFA_CLASS(GraspForceField, GuestForceField);

protected:
    GraspForceField() : GuestForceField(attributes::kGraspForceField) {}
    void stepEnded() override { attributes().fetch_from(*guest()); }
};

}  // namespace

void register_loads(sofa::core::ObjectFactory* factory)
{
    register_component<TangentialForceField>(factory, attributes::kTangentialForceField);
    register_component<GraspForceField>(factory, attributes::kGraspForceField);
}

}  // namespace hexaplast::sofa_plugin
