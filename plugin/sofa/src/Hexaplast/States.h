// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/fields.h>
#include <Hexaplast/mappings.h>
#include <Hexaplast/releases.h>

#include <string>
#include <vector>

#include "hexaplast/base/error.hpp"

namespace hexaplast::sofa_plugin
{

/// The states of a system, one behind the other.
class States
{
public:
    struct Entry
    {
        MechanicalState* state;
        int firstNode, numNodes;
    };

    /// Those below that follow no other.
    explicit States(sofa::core::objectmodel::BaseContext& context)
    {
        for (auto* each : allBelow<sofa::core::behavior::BaseMechanicalState>(context))
        {
            if (followsAnother(*each)) continue;
            auto* state = dynamic_cast<MechanicalState*>(each);
            if (!state)
                throw InputError(
                    "the independent MechanicalObjects in its node and below must be of template Vec3, "
                    "which '" +
                    each->getPathName() + "' is not");
            const int numNodes = static_cast<int>(state->getSize());
            m_entries.push_back({state, m_numNodes, numNodes});
            m_numNodes += numNodes;
        }
        if (m_entries.empty()) throw InputError("there is no MechanicalObject in its node and below");
    }

    int numNodes() const { return m_numNodes; }
    const std::vector<Entry>& entries() const { return m_entries; }
    bool areSeveral() const { return m_entries.size() > 1; }

    const Entry* find(const void* state) const
    {
        for (const Entry& entry : m_entries)
            if (entry.state == state) return &entry;
        return nullptr;
    }

    /// field = of(state) of each; to(state) = field.
    template <class Of>
    PointArray read(const Of& of) const
    {
        PointArray field(m_numNodes, 3);
        for (const Entry& entry : m_entries) rows<Points>(field, entry) = view(of(*entry.state));
        return field;
    }
    template <class To>
    void write(ConstPoints field, const To& to) const
    {
        for (const Entry& entry : m_entries)
        {
            sofa::core::objectmodel::Data<Vec3Types::VecDeriv>& data = to(*entry.state);
            Vec3Types::VecDeriv& values = *data.beginEdit();
            values.resize(static_cast<std::size_t>(entry.numNodes));
            view(values) = rows(field, entry);
            data.endEdit();
        }
    }
    PointArray positions() const
    {
        return read([](const MechanicalState& state) -> auto& { return state.readPositions().ref(); });
    }
    PointArray velocities() const
    {
        return read([](const MechanicalState& state) -> auto& { return state.readVelocities().ref(); });
    }

    /// The rows of a field that belong to a state.
    template <class Field>
    static Field rows(Field field, const Entry& entry)
    {
        return Field(field.middleRows(entry.firstNode, entry.numNodes));
    }

private:
    std::vector<Entry> m_entries;
    int m_numNodes = 0;
};

}  // namespace hexaplast::sofa_plugin
