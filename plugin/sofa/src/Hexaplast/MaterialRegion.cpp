// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/MaterialRegion.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>

namespace hexaplast::sofa_plugin
{

using sofa::core::objectmodel::BaseContext;
using sofa::core::objectmodel::ComponentState;

MaterialRegion::Field* MaterialRegion::body() const
{
    return l_body ? l_body.get() : this->getContext()->template get<Field>(BaseContext::SearchUp);
}

void MaterialRegion::init()
{
    attempt(
        *this,
        [&]
        {
            checkLink(l_body, "body");
            if (!body())
                throw InputError("needs a HexahedronElastoplasticFEMForceField in its node or above, or a link to one");
        });
}

void MaterialRegion::reinit()
{
    if (Field* field = body()) field->reinit();
}

std::optional<std::vector<double>> MaterialRegion::given(const Row<Material>& row) const
{
    const auto* data = this->findData(std::string(row.name));
    data->updateIfDirty();  // where it follows another one
    if (!data->isSet()) return std::nullopt;
    if (const auto* number = dynamic_cast<const Data<SReal>*>(data)) return {{number->getValue()}};
    return reals(dynamic_cast<const Data<VecReal>&>(*data).getValue());
}

std::vector<int> MaterialRegion::hexahedraIn(const std::vector<Hexahedron>& body,
                                             const std::vector<int>* ofTopology) const
{
    std::optional<std::vector<int>> nodes, numbers;
    if (d_hexahedra.isSet())
    {
        nodes.emplace();
        for (const auto& hexahedron : d_hexahedra.getValue())
            nodes->insert(nodes->end(), hexahedron.begin(), hexahedron.end());
    }
    if (d_indices.isSet()) numbers = wholeNumbers(d_indices.getValue());
    if (numbers && ofTopology && d_indices.getParent())
        for (int& number : *numbers)
            if (number < static_cast<int>(ofTopology->size())) number = (*ofTopology)[static_cast<std::size_t>(number)];
    return parts::region_hexahedra(nodes, numbers, body);
}

std::optional<parts::MaterialRegion> MaterialRegion::values(const std::vector<Hexahedron>& ofBody,
                                                            const std::vector<int>* ofTopology)
{
    std::optional<parts::MaterialRegion> found;
    const bool isAccepted =
        attempt(*this,
                [&]
                {
                    checkLink(l_body, "body");
                    for (const Row<Material>& row : material_rows())
                        if (this->findData(std::string(row.name))) checkWord(row.name);
                    d_hexahedra.updateIfDirty();
                    d_indices.updateIfDirty();
                    const bool follows = d_hexahedra.getParent() || d_indices.getParent();
                    const int counter = d_hexahedra.getCounter() + d_indices.getCounter();
                    const bool isKnown = m_hexahedra && ofTopology && (follows || counter == m_counter);
                    if (!isKnown) m_hexahedra = hexahedraIn(ofBody, ofTopology);
                    m_counter = counter;
                    found = parts::material_region([this](const Row<Material>& row) { return given(row); },
                                                   *m_hexahedra, this->getContext()->getDt());
                });
    if (isAccepted) this->d_componentState.setValue(ComponentState::Valid);
    return found;
}

[[maybe_unused]] const bool kMaterialRegionIsRegistered =
    registerComponent<MaterialRegion>(attributes::kMaterialRegion);

}  // namespace hexaplast::sofa_plugin
