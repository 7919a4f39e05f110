// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/releases.h>

#include <memory>
#include <vector>

#include "scene/object.hpp"

namespace hexaplast::sofa_plugin
{

/// Where a component stands: its place in the scene file, or its path in the graph where it does not come from a file.
scene::Place place_of(const SofaComponent& component);

/// The attributes of one of our components as Data of a SOFA component: same names, defaults and help, made from the
/// attribute table. Numbers are Data<int> and Data<SReal>, lists of them Data<vector<unsigned>> and
/// Data<vector<SReal>>, vectors Data<Vec3> and Data<vector<Vec3>>, words and texts Data<string>. Links are the business
/// of the owner, and so are Data that it has already under the name of an attribute.
class AttributeData
{
public:
    AttributeData(SofaComponent& owner, const attributes::Description& description);
    ~AttributeData();

    /// Hands every input that is set, and has changed since the last call for the same guest, to `guest`. Throws
    /// scene::SceneError for a value that is not admissible.
    void give_to(scene::Object& guest);

    /// The same from the beginning: for a guest that knows nothing yet.
    void give_all_to(scene::Object& guest);

    /// Takes every output from `guest`.
    void fetch_from(scene::Object& guest);

    /// The Data of the outputs.
    std::vector<sofa::core::BaseData*> outputs() const;

private:
    struct Entry
    {
        const attributes::Attribute* attribute = nullptr;
        sofa::core::BaseData* data = nullptr;
        std::unique_ptr<sofa::core::BaseData> own = nullptr;  // null where the owner had it already
        int given = -1;                                       // counter of the Data when it was given last
    };

    SofaComponent& m_owner;
    std::vector<Entry> m_entries;
};

}  // namespace hexaplast::sofa_plugin
