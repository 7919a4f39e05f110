// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/RigidFrame.h>

#include <memory>
#include <optional>
#include <vector>

#include "attributes/parts.hpp"
#include "parts/blade.hpp"

namespace hexaplast::sofa_plugin
{

/// A blade that moves along its path or with a rigid frame of the scene, and cuts a body. It sees where nodes are at
/// AnimateBeginEvent; its body asks it at the end of the step. Data: plugin/attributes/parts.hpp.
class HEXAPLAST_SOFA_API BladeController final : public TableComponent<SofaComponent>
{
public:
    SOFA_CLASS(BladeController, SOFA_TEMPLATE(TableComponent, SofaComponent));
    using Field = HexahedronElastoplasticFEMForceField;

    sofa::core::objectmodel::SingleLink<BladeController, Field,
                                        sofa::core::objectmodel::BaseLink::FLAG_STOREPATH |
                                            sofa::core::objectmodel::BaseLink::FLAG_STRONGLINK>
        l_body{initLink("body", helpOf("body"))};  ///< that it cuts

    void bwdInit() override;
    void reinit() override { bwdInit(); }
    void reset() override;
    void handleEvent(sofa::core::objectmodel::Event* event) override;
    void draw(const sofa::core::visual::VisualParams* vparams) override;

    /// What it has opened in the step that ends, behind what others have: for its body, which it has told of itself.
    void addOpened(std::vector<int>& joints, std::vector<double>& crossings);

protected:
    BladeController();

private:
    Field* field() const;  ///< that it is to cut now
    parts::BladeOptions options() const;
    void make();
    void beginStep(SReal dt);

    RigidFrame<BladeController> m_frame{*this, helpOf("rigid"), data<int>("rigidIndex")};
    Inputs m_inputs{*this, attributes::kBladeInSofa};
    sofa::core::sptr<Field> m_field;
    std::shared_ptr<const parts::HexahedralBody> m_body;  ///< that the part refers to
    std::optional<parts::Blade> m_part;
    bool m_dataAreAccepted = false;
    bool m_hasAsked = false;  ///< whether joints of the body can be opened
};

}  // namespace hexaplast::sofa_plugin
