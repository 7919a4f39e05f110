// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/probe.hpp"

#include <Hexaplast/FollowsNodes.h>
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <Hexaplast/table.h>
#include <sofa/core/objectmodel/DataFileName.h>
#include <sofa/simulation/UpdateMappingEndEvent.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "attributes/parts.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/embed.hpp"

namespace hexaplast::sofa_plugin
{

/// Makes one number of a Data after every step, when all components have ended it, wherever they stand.
class Probe final : public TableComponent<SofaComponent>, public FollowsNodes
{
public:
    SOFA_CLASS(Probe, SOFA_TEMPLATE(TableComponent, SofaComponent));

    Data<sofa::type::vector<SReal>>& d_value = data<sofa::type::vector<SReal>>("value");
    Data<sofa::type::vector<sofa::type::Vec3>>& d_points = data<sofa::type::vector<sofa::type::Vec3>>("points");
    Data<SReal> d_reading{initData(&d_reading, SReal(0), "reading", "The number after the latest step.", true, true)};
    sofa::core::objectmodel::DataFileName d_filename{
        initData(&d_filename, "filename", "A CSV file of time [s] and reading, with a line after every step.")};

    // When the Data of all components are there.
    void bwdInit() override
    {
        const bool isAccepted = attempt(*this, [&] { begin(); });
        if (isAccepted) d_componentState.setValue(sofa::core::objectmodel::ComponentState::Valid);
    }
    void reinit() override { bwdInit(); }
    void reset() override
    {
        if (m_probe && !isInvalid(*this)) attempt(*this, [&] { begin(); });
    }

    void handleEvent(sofa::core::objectmodel::Event* event) override
    {
        if (!sofa::simulation::UpdateMappingEndEvent::checkEventType(event) || !mayStep(*this)) return;
        attempt(*this,
                [&]
                {
                    if (!m_probe) begin();  // it was added during the run
                    read();
                    if (!m_file.is_open()) return;
                    m_file << getContext()->getTime() << "," << d_reading.getValue() << std::endl;
                    if (!m_file) throw parts::OptionError("filename", "cannot be written any more");
                });
    }

    void nodesChanged(const MechanicalState& state, const SharedBody& body, std::span<const int>) override
    {
        if (!m_probe || isInvalid(*this)) return;
        const auto* owner = source().getOwner();
        const auto* field = dynamic_cast<const HexahedronElastoplasticFEMForceField*>(owner);
        if (m_points && m_state == &state)
            m_points->follow(body->body().mesh().hexahedra(), body->body().mesh().num_nodes());
        else if (!m_points && (owner == &state || (field && field->part() == body)) &&
                 source().getValueTypeInfo()->size() == 3)
            m_probe->follow(body->body().copies());
    }

protected:
    Probe() : TableComponent(attributes::kProbe) { f_listening.setValue(true); }

private:
    const sofa::core::BaseData& source() const
    {
        const sofa::core::BaseData* data = &d_value;
        while (data->getParent()) data = data->getParent();
        return *data;
    }

    void begin()
    {
        m_file.close();
        m_points.reset();
        m_isLinked = d_value.getParent() != nullptr;
        d_value.update();  // finds a Data of a component that stands behind this one
        const auto* type = source().getValueTypeInfo();
        if (!type->ValidInfo() || !(type->Scalar() || type->Integer()) || type->Text())
            throw parts::OptionError("value", "must lead to numbers or vectors");
        const int width = static_cast<int>(type->size());
        if (width != 1 && width != 3)
            throw parts::OptionError("value", "holds entries of " + std::to_string(width) + " numbers, must be 1 or 3");
        if (width == 1 && findData("component")->isSet())
            throw parts::OptionError("component",
                                     "is given for a value that holds no vectors: its entries are single numbers");
        if (d_points.isSet()) embed(width);
        m_probe.emplace(readOptions<parts::ProbeOptions>(), width);
        read();
        if (d_filename.getValue().empty()) return;
        m_file.open(d_filename.getFullPath());
        m_file.imbue(std::locale::classic());
        m_file.precision(std::numeric_limits<SReal>::max_digits10);
        m_file << "time," << getName() << std::endl;
        if (!m_file) throw parts::OptionError("filename", "'" + d_filename.getFullPath() + "' cannot be written");
    }

    void embed(int width)
    {
        if (findData("indices")->isSet())
            throw parts::OptionError("points", "are given besides indices: entries are the ones or the others");
        m_state = getContext()->get<MechanicalState>();
        auto* topology = getContext()->getMeshTopologyLink();
        if (width != 3 || !m_state || !topology || topology->getHexahedra().empty())
            throw parts::OptionError(
                "points",
                "need one vector per node for a value, as @nodes.position is, and a MechanicalObject "
                "and a topology with hexahedra in the node of the probe or above");
        const SharedBody body = bodyOn(*m_state);  // in the order of its hexahedra, by which the points go on
        m_points.emplace(view(m_state->readRestPositions().ref()),
                         body ? body->body().mesh().hexahedra() : hexahedraOf(*topology), view(d_points.getValue()));
    }

    void read()
    {
        m_probe->set_options(readOptions<parts::ProbeOptions>());
        const sofa::core::BaseData& from = source();
        if (const auto* owner = dynamic_cast<const SofaComponent*>(from.getOwner()))
            requireInScene(*this, "value", *owner);
        if (m_isLinked && &from == &d_value) throw parts::OptionError("value", "leads to nothing any more");
        const auto* type = from.getValueTypeInfo();
        const void* value = from.getValueVoidPtr();
        m_values.resize(type->size(value));
        for (std::size_t i = 0; i < m_values.size(); ++i)
            m_values[i] = type->getScalarValue(value, static_cast<sofa::Size>(i));
        if (m_points)
        {
            PointArray at(m_points->num_points(), 3);
            m_points->apply(
                Eigen::Map<const PointArray>(m_values.data(), static_cast<Eigen::Index>(m_values.size() / 3), 3), at);
            m_values.assign(at.data(), at.data() + at.size());
        }
        const double reading = m_probe->read(m_values);
        if (!std::isfinite(reading)) throw parts::OptionError("value", "holds a number that is not finite");
        d_reading.setValue(reading);
    }

    std::optional<parts::Probe> m_probe;
    std::optional<Embedding> m_points;
    bool m_isLinked = false;                   ///< `value`, to a Data that may leave the scene
    const MechanicalState* m_state = nullptr;  ///< whose nodes move the points
    std::vector<double> m_values;
    std::ofstream m_file;
};

[[maybe_unused]] const bool kProbeIsRegistered = registerComponent<Probe>(attributes::kProbe);

}  // namespace hexaplast::sofa_plugin
