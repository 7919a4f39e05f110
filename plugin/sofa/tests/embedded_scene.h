// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hexaplast/body.hpp"
#include "scene/plugin.hpp"
#include "scene/reader.hpp"

namespace hexaplast::sofa_plugin::test
{

/// A scene in the embedded host.
class EmbeddedScene
{
public:
    explicit EmbeddedScene(const std::filesystem::path& file) : m_loader(m_factory, {HEXAPLAST_PLUGINS})
    {
        m_loader.load("Hexaplast");
        m_scene.emplace(scene::read_scene(file, m_factory, m_loader));
        m_scene->init();
    }
    explicit EmbeddedScene(const std::string& text) : m_loader(m_factory, {HEXAPLAST_PLUGINS})
    {
        m_loader.load("Hexaplast");
        m_scene.emplace(scene::read_scene_text(text, "test.scn", m_factory, m_loader));
        m_scene->init();
    }

    void step() { m_scene->step(); }

    /// [m] of the nodes of all bodies, one body behind the other.
    PointArray positions()
    {
        PointArray all(0, 3);
        m_scene->root().for_each<scene::ForceField>(
            [&](scene::ForceField& field)
            {
                if (!field.body()) return;
                const PointArray& x = field.node().nearest<scene::MechanicalState>()->positions();
                all.conservativeResize(all.rows() + x.rows(), 3);
                all.bottomRows(x.rows()) = x;
            });
        return all;
    }

    /// Of the only component of its class.
    template <class Category>
    std::vector<double> output(const std::string& class_name, const std::string& name)
    {
        std::vector<double> found;
        m_scene->root().for_each<Category>(
            [&](Category& component)
            {
                if (component.class_name() == class_name)
                    found = std::get<std::vector<double>>(component.find_data(name)->value());
            });
        return found;
    }

private:
    scene::Factory m_factory;
    scene::PluginLoader m_loader;
    std::optional<scene::Scene> m_scene;
};

}  // namespace hexaplast::sofa_plugin::test
