// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sofa_scene.h"

#include <sofa/core/ObjectFactory.h>
#include <sofa/helper/system/FileRepository.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/common/SceneLoaderXML.h>
#include <sofa/simulation/common/init.h>
#include <sofa/simulation/graph/init.h>

namespace hexaplast::sofa_plugin::test
{
namespace
{

/// SOFA as runSofa starts it, with our plugin and its own modules within reach.
void start_sofa()
{
    [[maybe_unused]] static const bool started = []
    {
        sofa::simulation::common::init();
        sofa::simulation::graph::init();
        sofa::helper::system::PluginRepository.addFirstPath(HEXAPLAST_SOFA_MODULES);
        auto& manager = sofa::helper::system::PluginManager::getInstance();
        manager.loadPluginByPath(HEXAPLAST_SOFA_PLUGIN);
        sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin("Hexaplast");
        return true;
    }();
}

}  // namespace

SofaScene SofaScene::from_file(const std::filesystem::path& file)
{
    start_sofa();
    return SofaScene(sofa::simulation::node::load(file.string()));
}

SofaScene SofaScene::from_text(const std::string& text)
{
    start_sofa();
    return SofaScene(sofa::simulation::SceneLoaderXML::loadFromMemory("test.scn", text.c_str()));
}

SofaScene::SofaScene(sofa::simulation::Node::SPtr root) : root_(std::move(root))
{
    if (!root_) throw std::runtime_error("SOFA does not load the scene");
    sofa::simulation::node::initRoot(root_.get());
    sofa::simulation::node::reset(root_.get());
}

SofaScene::~SofaScene()
{
    if (root_) sofa::simulation::node::unload(root_);
}

SofaComponent& SofaScene::named(const std::string& name)
{
    std::vector<SofaComponent*> all;
    root().get<SofaComponent>(&all, sofa::core::objectmodel::BaseContext::SearchDown);
    for (SofaComponent* each : all)
        if (each->getName() == name) return *each;
    throw std::runtime_error("no '" + name + "' in the scene");
}

void SofaScene::set(const std::string& name, const std::string& data, const std::string& value)
{
    auto* found = named(name).findData(data);
    if (!found || !found->read(value)) throw std::runtime_error(name + "." + data + " takes no '" + value + "'");
}

void SofaScene::step() { sofa::simulation::node::animate(root_.get(), root_->getDt()); }
void SofaScene::reset() { sofa::simulation::node::reset(root_.get()); }

}  // namespace hexaplast::sofa_plugin::test
