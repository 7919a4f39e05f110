// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/registration.h>
#include <sofa/component/topology/container/dynamic/HexahedronSetTopologyModifier.h>
#include <sofa/core/topology/TopologyChange.h>
#include <sofa/core/visual/VisualParams.h>
#include <sofa/helper/ColorMap.h>

#include <Hexaplast/PartForceField.inl>
#include <algorithm>
#include <numeric>

#include "attributes/hexaplast.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::sofa_plugin
{

using sofa::component::topology::container::dynamic::HexahedronSetTopologyModifier;
using sofa::core::objectmodel::ComponentState;
using sofa::type::RGBAColor;

HexahedronElastoplasticFEMForceField::HexahedronElastoplasticFEMForceField()
    : Inherit(attributes::kHexahedronElastoplasticFEMForceField),
      d_drawMaterialShape(initData(&d_drawMaterialShape, false, "drawMaterialShape",
                                   "Draws the edges of the shape that the body has without forces.")),
      l_topology(initLink("topology", "The hexahedra; the topology of the node where it is not given.")),
      m_attributes(*this, attributes::kHexahedronElastoplasticFEMForceField)
{
    for (sofa::core::BaseData* output : m_attributes.outputs()) m_outputs.addOutput(output);
}

void HexahedronElastoplasticFEMForceField::Outputs::update()
{
    cleanDirty();
    if (!m_owner.works()) return;
    m_owner.m_attributes.fetch_from(m_owner.guest());
    m_owner.orderAsTheTopology();
}

void HexahedronElastoplasticFEMForceField::orderAsTheTopology()
{
    if (m_original.size() == static_cast<std::size_t>(body()->mesh().num_elements())) return;
    for (sofa::core::BaseData* output : m_attributes.outputs())
    {
        auto* perHexahedron = dynamic_cast<sofa::core::objectmodel::Data<sofa::type::vector<SReal>>*>(output);
        if (!perHexahedron) continue;
        auto& values = *perHexahedron->beginWriteOnly();
        sofa::type::vector<SReal> left;
        for (const int e : m_original) left.push_back(values[e]);
        values = left;
        perHexahedron->endEdit();
    }
}

void HexahedronElastoplasticFEMForceField::init()
{
    if (!l_topology) l_topology.set(getContext()->getMeshTopologyLink());
    if (!l_topology)
    {
        msg_error() << "needs a topology with hexahedra in its node or above, or a link to one";
        d_componentState.setValue(ComponentState::Invalid);
        return;
    }
    m_original.resize(l_topology->getNbHexahedra());
    std::iota(m_original.begin(), m_original.end(), 0);
    Inherit::init();
    m_outputs.setDirtyValue();
}

void HexahedronElastoplasticFEMForceField::makePart()
{
    m_guest.reset();
    m_guest.emplace(*this, attributes::kHexahedronElastoplasticFEMForceField, m_attributes, mstate.get(),
                    l_topology.get());
}

std::optional<double> HexahedronElastoplasticFEMForceField::energy(SReal, ConstPoints x) const
{
    return body()->energy(x);
}

void HexahedronElastoplasticFEMForceField::resetPart()
{
    m_guest->reset();
    if (works() && m_original.size() < static_cast<std::size_t>(body()->mesh().num_elements()))
    {
        // the topology stays torn, and so does the body
        std::vector<bool> is_left(body()->mesh().num_elements(), false);
        for (const int e : m_original) is_left[e] = true;
        std::vector<int> gone;
        for (int e = 0; e < static_cast<int>(is_left.size()); ++e)
            if (!is_left[e]) gone.push_back(e);
        guest().remove_elements(gone);
    }
    m_outputs.setDirtyValue();
}

void HexahedronElastoplasticFEMForceField::endStep(SReal dt)
{
    m_guest->end_step(dt);
    m_outputs.setDirtyValue();
    if (guest().flow_report()->removed > 0) tearTopology();
}

void HexahedronElastoplasticFEMForceField::tearTopology()
{
    HexahedronSetTopologyModifier* modifier = nullptr;
    l_topology->getContext()->get(modifier, sofa::core::objectmodel::BaseContext::Local);
    if (!modifier) return;  // the body is torn, and what is drawn from the topology is not
    if (modifier->removeIsolated.getValue())
    {
        msg_warning() << "hexahedra broke, but " << modifier->getName()
                      << " would take nodes away with them: removeIsolated must be false. The topology stays whole.";
        return;
    }
    const std::span<const unsigned char> alive = body()->alive();
    sofa::type::vector<sofa::Index> gone;
    for (std::size_t i = 0; i < m_original.size(); ++i)
        if (!alive[m_original[i]]) gone.push_back(static_cast<sofa::Index>(i));
    modifier->removeHexahedra(gone);
}

// A removed hexahedron's place is taken by the last one, in the order of the list.
void HexahedronElastoplasticFEMForceField::handleTopologyChange(sofa::core::topology::Topology* changed)
{
    if (!works() || changed != l_topology.get()) return;
    attempt(*this,
            [&]
            {
                std::vector<int> gone;
                for (auto change = l_topology->beginChange(); change != l_topology->endChange(); ++change)
                {
                    switch ((*change)->getChangeType())
                    {
                        case sofa::core::topology::HEXAHEDRAREMOVED:
                            for (const sofa::Index i :
                                 static_cast<const sofa::core::topology::HexahedraRemoved*>(*change)->getArray())
                            {
                                gone.push_back(m_original[i]);
                                m_original[i] = m_original.back();
                                m_original.pop_back();
                            }
                            break;
                        case sofa::core::topology::HEXAHEDRAADDED:
                        case sofa::core::topology::POINTSREMOVED:
                        case sofa::core::topology::POINTSADDED:
                        case sofa::core::topology::POINTSRENUMBERING:
                            throw InputError(
                                "hexahedra may be removed from its topology, but nothing added or renumbered: set "
                                "removeIsolated=\"false\" in HexahedronSetTopologyModifier");
                        default:
                            break;
                    }
                }
                guest().remove_elements(gone);
                m_outputs.setDirtyValue();
            });
}

void HexahedronElastoplasticFEMForceField::draw(const sofa::core::visual::VisualParams* vparams)
{
    if (!works() || !vparams->displayFlags().getShowForceFields()) return;
    auto* tool = vparams->drawTool();
    const auto lifeCycle = tool->makeStateLifeCycle();
    if (vparams->displayFlags().getShowWireFrame()) tool->setPolygonMode(0, true);
    tool->enableLighting();

    const Body& body = *this->body();
    const auto x = view(mstate->readPositions().ref());
    const std::span<const unsigned char> alive = body.alive();
    const std::vector<double> strain = nodal_means(body.mesh(), body.fields(x).plastic_strain, alive);
    const double most = strain.empty() ? 0 : *std::max_element(strain.begin(), strain.end());
    static sofa::helper::ColorMap colours(256, "Blue to Red");
    const auto colour = colours.getEvaluator(0.0, std::max(most, 1e-6));
    const auto faces = body.mesh().boundary_faces(alive);
    std::vector<sofa::type::Vec3> corners;
    std::vector<RGBAColor> shades;
    for (const auto& face : faces)
        for (const int k : {0, 1, 2, 0, 2, 3})
        {  // two triangles: SOFA does not light quads in the colours of their corners
            const int node = face[k];
            corners.emplace_back(x(node, 0), x(node, 1), x(node, 2));
            shades.push_back(colour(strain[node]));
        }
    tool->drawTriangles(corners, shades);

    if (!d_drawMaterialShape.getValue()) return;
    const PointArray& material = body.plastic_rest_positions();
    std::vector<sofa::type::Vec3> ends;
    for (const auto& face : faces)
        for (std::size_t k = 0; k < face.size(); ++k)
            for (const int node : {face[k], face[(k + 1) % face.size()]})
                ends.emplace_back(material(node, 0), material(node, 1), material(node, 2));
    tool->drawLines(ends, 1, RGBAColor::gray());
}

void registerHexahedronElastoplasticFEMForceField(sofa::core::ObjectFactory* factory)
{
    register_component<HexahedronElastoplasticFEMForceField>(factory,
                                                             attributes::kHexahedronElastoplasticFEMForceField);
}

}  // namespace hexaplast::sofa_plugin
