// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/simulation/Node.h>

#include <filesystem>
#include <string>

namespace hexaplast::sofa_plugin::test
{

using VecReal = sofa::type::vector<SReal>;

/// A scene in SOFA, initialised and reset as runSofa does.
class SofaScene
{
public:
    static SofaScene from_file(const std::filesystem::path& file);
    static SofaScene from_text(const std::string& text);
    ~SofaScene();
    SofaScene(SofaScene&&) = default;

    void step();
    void reset();

    template <class T>
    T& only()
    {
        T* found = nullptr;
        root_->getContext()->get(found, sofa::core::objectmodel::BaseContext::SearchDown);
        if (!found) throw std::runtime_error("no such component in the scene");
        return *found;
    }

    /// The component of this name, wherever it is, and a value for one of its Data, as a scene file gives it.
    SofaComponent& named(const std::string& name);
    void set(const std::string& name, const std::string& data, const std::string& value);

    sofa::core::objectmodel::BaseContext& root() { return *root_->getContext(); }
    MechanicalState& state() { return *dynamic_cast<MechanicalState*>(field().getMState()); }
    using Field = HexahedronElastoplasticFEMForceField;
    Field& field() { return only<Field>(); }
    const Body& body()
    {
        const Body* found = field().body();
        if (!found) throw std::runtime_error("no body in the scene");
        return *found;
    }

    void move_to(const PointArray& x)
    {
        auto nodes = state().writePositions();
        nodes.wref().resize(static_cast<std::size_t>(x.rows()));
        view(nodes.wref()) = x;
    }
    PointArray positions() { return view(state().readPositions().ref()); }
    PointArray velocities() { return view(state().readVelocities().ref()); }

private:
    explicit SofaScene(sofa::simulation::Node::SPtr root);
    sofa::simulation::Node::SPtr root_;
};

/// What a Data of a component holds.
template <class T>
const T& value_of(const SofaComponent& component, const std::string& data)
{
    return dynamic_cast<const Data<T>&>(*component.findData(data)).getValue();
}

}  // namespace hexaplast::sofa_plugin::test
