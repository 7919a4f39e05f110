// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/Guest.h>
#include <Hexaplast/registration.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>

#include "attributes/shapes.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

/// A topology of SOFA whose nodes and hexahedra are those of one of ours.
class GuestTopology : public sofa::component::topology::container::constant::MeshTopology
{
public:
    using Inherit = sofa::component::topology::container::constant::MeshTopology;
    SOFA_ABSTRACT_CLASS(GuestTopology, Inherit);

    void init() override
    {
        attempt(*this,
                [&]
                {
                    Guest guest(*this, m_description, m_attributes, nullptr, nullptr);
                    take(guest.as<scene::Topology>());
                });
        Inherit::init();
    }

protected:
    explicit GuestTopology(const attributes::Description& description)
        : m_description(description), m_attributes(*this, description)
    {
    }

private:
    void take(scene::Topology& made)
    {
        auto points = sofa::helper::getWriteOnlyAccessor(d_seqPoints);
        points.resize(made.positions().rows());
        view(points.wref()) = made.positions();
        auto hexahedra = sofa::helper::getWriteOnlyAccessor(d_seqHexahedra);
        hexahedra.clear();
        for (const hexaplast::Hexahedron& corners : made.hexahedra())
        {
            Hexa hexahedron;
            for (std::size_t a = 0; a < corners.size(); ++a) hexahedron[a] = static_cast<sofa::Index>(corners[a]);
            hexahedra.push_back(hexahedron);
        }
    }

    const attributes::Description& m_description;
    AttributeData m_attributes;
};

class TubeGridTopology final : public GuestTopology
{
public:
    SOFA_CLASS(TubeGridTopology, GuestTopology);

protected:
    TubeGridTopology() : GuestTopology(attributes::kTubeGridTopology) {}
};

class SheetGridTopology final : public GuestTopology
{
public:
    SOFA_CLASS(SheetGridTopology, GuestTopology);

protected:
    SheetGridTopology() : GuestTopology(attributes::kSheetGridTopology) {}
};

class SpherePatchGridTopology final : public GuestTopology
{
public:
    SOFA_CLASS(SpherePatchGridTopology, GuestTopology);

protected:
    SpherePatchGridTopology() : GuestTopology(attributes::kSpherePatchGridTopology) {}
};

}  // namespace

void register_topologies(sofa::core::ObjectFactory* factory)
{
    register_component<TubeGridTopology>(factory, attributes::kTubeGridTopology);
    register_component<SheetGridTopology>(factory, attributes::kSheetGridTopology);
    register_component<SpherePatchGridTopology>(factory, attributes::kSpherePatchGridTopology);
}

}  // namespace hexaplast::sofa_plugin
