// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/BladeController.h>
#include <Hexaplast/Followers.h>
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/MaterialRegion.h>
#include <Hexaplast/registration.h>
#include <sofa/component/topology/container/grid/SparseGridTopology.h>
#include <sofa/core/behavior/OdeSolver.h>
#include <sofa/core/topology/TopologyChange.h>
#include <sofa/core/visual/VisualParams.h>
#include <sofa/helper/ColorMap.h>
#include <sofa/simulation/UpdateMappingEndEvent.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

#include "attributes/hexaplast.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::sofa_plugin
{

HexahedronElastoplasticFEMForceField::HexahedronElastoplasticFEMForceField()
    : Inherit(attributes::kHexahedronElastoplasticFEMForceField)
{
    parts::HexahedralBody::outputs(
        [this](std::string_view name, const auto& of)
        {
            auto* output = findData(std::string(name));
            const auto compute = [this, output, of]
            {
                if (!works()) return;
                auto value = of(*body(), view(mstate->readPositions().ref()));
                if constexpr (std::is_same_v<decltype(value), std::vector<double>>) value = inTopology(value);
                writeOutput(*output, value);
            };
            m_outputs.push_back(std::make_unique<Outputs>(std::initializer_list{output}, compute));
        });
}

void HexahedronElastoplasticFEMForceField::initPart()
{
    if (!attempt(*this, [&] { checkLink(l_topology, "topology"); })) return;
    if (!l_topology) l_topology.set(getContext()->getMeshTopologyLink());
    if (!l_topology)
    {
        msg_error(this) << "needs a topology with hexahedra in its node or above, or a link to one";
        d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
        return;
    }
    m_regions.clear();  // they told the inputs before
    Inherit::initPart();
    if (hasPart()) othersHaveChanged();
    setOutputsDirty();
}

// Regions are asked when all of them, and the engines that they follow, have had their init.
void HexahedronElastoplasticFEMForceField::bwdInit()
{
    Inherit::bwdInit();
    m_regionsAreReady = true;
    if (works() && othersHaveChanged()) reinit();
}

std::vector<MaterialRegion*> HexahedronElastoplasticFEMForceField::regions() const
{
    if (!m_regionsAreReady) return {};
    std::vector<MaterialRegion*> found = allBelow<MaterialRegion>(*getContext()->getRootContext());
    std::erase_if(found, [this](const MaterialRegion* region) { return region->body() != this; });
    return found;
}

// Regions that were added or removed.
bool HexahedronElastoplasticFEMForceField::othersHaveChanged()
{
    std::vector<MaterialRegion*> present = regions();
    if (present == m_regions) return false;
    for (MaterialRegion* region : present)
        if (std::find(m_regions.begin(), m_regions.end(), region) == m_regions.end()) region->tell(inputs());
    m_regions = std::move(present);
    return true;
}

void HexahedronElastoplasticFEMForceField::makePart()
{
    m_body.reset();
    m_topologyIsLost = m_topologyHasChanged = m_hasAsked = m_hasFlowed = false;
    const std::vector<Hexahedron> hexahedra = hexahedraOf(*l_topology);
    if (hexahedra.empty()) throw InputError("its topology '" + l_topology->getName() + "' has no hexahedra");
    m_fill.clear();
    if (auto* grid = dynamic_cast<sofa::component::topology::container::grid::SparseGridTopology*>(l_topology.get()))
        for (sofa::Index e = 0; e < hexahedra.size(); ++e) m_fill.push_back(grid->getStiffnessCoef(e));
    m_original.resize(hexahedra.size());
    std::iota(m_original.begin(), m_original.end(), 0);

    m_body = std::make_shared<parts::HexahedralBody>(view(mstate->readRestPositions().ref()), hexahedra,
                                                     options(hexahedra), getContext()->getDt());
    passOn(*this, m_body->take_warnings());
}

void HexahedronElastoplasticFEMForceField::updatePart()
{
    requireTopology();
    m_body->set_options(options(body()->mesh().hexahedra()), getContext()->getDt());
    passOn(*this, m_body->take_warnings());
}

parts::HexahedralBodyOptions HexahedronElastoplasticFEMForceField::options(
    const std::vector<Hexahedron>& hexahedra) const
{
    std::vector<parts::MaterialRegion> ofRegions;
    for (MaterialRegion* region : regions())
    {
        std::optional<parts::MaterialRegion> values =
            region->values(hexahedra, m_topologyHasChanged ? &m_original : nullptr);
        if (!values)
            throw InputError("its MaterialRegion '" + region->getName() + "' is invalid (see its error above)");
        ofRegions.push_back(std::move(*values));
    }
    const auto given = [this](const auto& row) -> std::optional<std::vector<double>>
    {
        const auto* data = findData(std::string(row.name));
        if (row.may_be_infinite() && !data->isSet()) return std::nullopt;
        checkWord(row.name);
        if (const auto* word = dynamic_cast<const Data<OptionsGroup>*>(data))
        {
            return {{static_cast<double>(place_of_word(row, word->getValue().getSelectedItem()))}};
        }
        if (const auto* whole = dynamic_cast<const Data<int>*>(data)) return {{static_cast<double>(whole->getValue())}};
        if (const auto* number = dynamic_cast<const Data<SReal>*>(data)) return {{number->getValue()}};
        return reals(dynamic_cast<const Data<VecReal>&>(*data).getValue());
    };
    checkWord("device");
    return parts::body_options(given, data<OptionsGroup>("device").getValue().getSelectedItem(), hexahedra.size(),
                               m_fill, ofRegions);
}

void HexahedronElastoplasticFEMForceField::resetPart()
{
    requireTopology();
    m_hasAsked = m_hasFlowed = false;
    m_body->reset_but_cuts();
    followTopology();
    setOutputsDirty();
}

void HexahedronElastoplasticFEMForceField::loadPart(std::istream& in)
{
    requireTopology();
    std::stringstream before;
    m_body->body().save(before);
    const std::vector<Hexahedron> corners = body()->mesh().hexahedra();
    const auto numBefore = static_cast<std::ptrdiff_t>(body()->copies().num_nodes());
    const bool stayOpen = m_body->load_but_cuts(in);
    m_hasFlowed = false;
    const std::vector<int>& initial = body()->copies().initial();
    const std::vector<int> splitFrom(initial.begin() + numBefore, initial.end());
    std::optional<Followers> followers;
    try
    {
        if (!splitFrom.empty() && !m_regionsAreReady)
            throw InputError("joints of it are open: nodes can split when the scene has had its init");
        if (!splitFrom.empty()) followers.emplace(*this);
    }
    catch (const InputError&)
    {
        m_body->body().load(before);
        throw;
    }
    // given back for the nodes that come here, or without those that stay
    const auto numInitial = static_cast<std::size_t>(body()->copies().num_initial());
    auto x = mstate->readPositions().ref();
    auto v = mstate->readVelocities().ref();
    if (followers) splitTopology(corners, splitFrom);
    for (auto* given : {&x, &v})
        for (std::size_t n = given->size(); n >= numInitial && n < initial.size(); ++n)
            given->push_back((*given)[static_cast<std::size_t>(initial[n])]);
    mstate->writePositions().wref() = x;
    mstate->writeVelocities().wref() = v;
    if (followers) followers->follow({});
    if (stayOpen)
        msg_warning(this) << "joints that are closed in the given state stay open, as nodes in SOFA do not join again";
    followTopology();
    setOutputsDirty();
    tearTopology();
}

void HexahedronElastoplasticFEMForceField::followTopology()
{
    std::vector<bool> isLeft(static_cast<std::size_t>(body()->mesh().num_elements()), false);
    for (const int e : m_original) isLeft[static_cast<std::size_t>(e)] = true;
    const std::span<const unsigned char> alive = body()->alive();
    std::vector<int> gone;
    for (std::size_t e = 0; e < isLeft.size(); ++e)
        if (!isLeft[e] && alive[e]) gone.push_back(static_cast<int>(e));
    if (gone.empty()) return;
    m_body->remove(gone);
    msg_warning(this) << gone.size() << " hexahedra are gone from the topology, and stay so: it gets none back";
}

// Relaxation within a step follows from its length; in an equilibrium it is over.
void HexahedronElastoplasticFEMForceField::beginStep(SReal, SReal dt)
{
    // by its name: an installed SOFA lacks NonLinearFunction.h, which StaticSolver.h includes (v25.06 to v26.06)
    const auto* solver = getContext()->get<sofa::core::behavior::OdeSolver>();
    const bool isStatic = solver && solver->getClassName() == "StaticSolver";
    // a grid is made anew without a word
    if (l_topology->getNbHexahedra() != m_original.size()) m_topologyIsLost = true;
    requireTopology();
    if (!m_hasAsked && m_body->may_open())
    {
        Followers(*this);
        m_hasAsked = true;
    }
    m_body->body().set_time_step(isStatic ? std::numeric_limits<SReal>::infinity() : dt);
}

void HexahedronElastoplasticFEMForceField::endStep(SReal dt)
{
    m_body->end_step(view(mstate->readPositions().ref()), dt);
    m_hasFlowed = true;
    setOutputsDirty();
    if (m_body->report().removed > 0) tearTopology();
}

void HexahedronElastoplasticFEMForceField::setOutputsDirty()
{
    for (const auto& output : m_outputs) output->setDirtyValue();
}

// The body keeps hexahedra that are gone.
std::vector<double> HexahedronElastoplasticFEMForceField::inTopology(const std::vector<double>& ofBody) const
{
    std::vector<double> shown;
    for (const int e : m_original) shown.push_back(ofBody[static_cast<std::size_t>(e)]);
    return shown;
}

void HexahedronElastoplasticFEMForceField::tearTopology()
{
    const std::span<const unsigned char> alive = body()->alive();
    sofa::type::vector<sofa::Index> gone;
    for (std::size_t i = 0; i < m_original.size(); ++i)
        if (!alive[static_cast<std::size_t>(m_original[i])]) gone.push_back(static_cast<sofa::Index>(i));
    if (gone.empty()) return;
    TopologyModifier* modifier = this->modifier();
    if (!modifier) return;  // the body is torn, and what is drawn from the topology is not
    if (modifier->removeIsolated.getValue())
    {
        msg_warning(this)
            << "hexahedra broke, but " << modifier->getName()
            << " would take nodes away with them: removeIsolated must be false. The topology stays whole.";
        return;
    }
    modifier->removeHexahedra(gone);
    modifier->notifyEndingEvent();  // mappings look again, when the numbers of hexahedra are those that stay
}

auto HexahedronElastoplasticFEMForceField::modifier() const -> TopologyModifier*
{
    TopologyModifier* found = nullptr;
    l_topology->getContext()->get(found, sofa::core::objectmodel::BaseContext::Local);
    return found;
}

void HexahedronElastoplasticFEMForceField::expect(BladeController& blade) { m_blades.emplace_back(&blade); }

// Joints open when all components have ended the step, wherever they stand.
void HexahedronElastoplasticFEMForceField::handleEvent(sofa::core::objectmodel::Event* event)
{
    Inherit::handleEvent(event);
    if (!sofa::simulation::UpdateMappingEndEvent::checkEventType(event)) return;
    if (std::exchange(m_hasFlowed, false) && works()) attempt(*this, [&] { openJoints(); });
    m_blades.clear();
}

void HexahedronElastoplasticFEMForceField::openJoints()
{
    const std::vector<int>& torn = m_body->report().torn;
    if (m_blades.empty() && torn.empty()) return;
    std::vector<int> joints;
    std::vector<double> crossings;
    for (const auto& blade : m_blades) blade->addOpened(joints, crossings);
    joints.insert(joints.end(), torn.begin(), torn.end());
    crossings.resize(joints.size(), 0.5);  // tears pass half-way between hexahedra
    if (joints.empty()) return;

    requireTopology();
    std::optional<Followers> followers;
    try
    {
        followers.emplace(*this);
    }
    catch (const InputError& error)
    {
        msg_error(this) << errorAt(*this, "", error.what());
        return;  // what has come during the run cannot follow: the body stays whole
    }
    const std::vector<Hexahedron> before = body()->mesh().hexahedra();
    const std::vector<int> splitFrom = m_body->open(joints, crossings);
    setOutputsDirty();
    if (splitFrom.empty()) return;
    splitTopology(before, splitFrom);
    followers->follow(splitFrom);
}

// Hexahedra come with their new corners and then leave with the old ones, so that what SOFA keeps of them is handed on.
void HexahedronElastoplasticFEMForceField::splitTopology(const std::vector<Hexahedron>& before,
                                                         std::span<const int> splitFrom)
{
    using sofa::type::vector;
    const auto only = [](int index) { return vector<sofa::Index>(1, static_cast<sofa::Index>(index)); };
    vector<vector<sofa::Index>> ofPoints, ofHexahedra;
    for (const int node : splitFrom) ofPoints.push_back(only(node));

    const std::vector<Hexahedron>& present = body()->mesh().hexahedra();
    vector<MeshTopology::Hexahedron> come;
    vector<sofa::Index> leave;
    m_coming.clear();
    for (std::size_t i = 0; i < m_original.size(); ++i)
    {
        const Hexahedron& corners = present[static_cast<std::size_t>(m_original[i])];
        if (corners == before[static_cast<std::size_t>(m_original[i])]) continue;
        come.push_back(hexahedronOf(corners));
        m_coming.push_back(m_original[i]);
        leave.push_back(static_cast<sofa::Index>(i));
        ofHexahedra.push_back(only(static_cast<int>(i)));
    }
    const auto whole = [](const auto& ancestors)
    { return vector<vector<SReal>>(ancestors.size(), vector<SReal>(1, 1)); };
    m_topologyHasChanged = true;
    struct Splitting
    {
        explicit Splitting(bool& is) : m_is(is) { m_is = true; }
        ~Splitting() { m_is = false; }
        bool& m_is;
    } const splitting(m_isSplitting);
    TopologyModifier& topology = *modifier();
    topology.addPoints(static_cast<sofa::Size>(splitFrom.size()), ofPoints, whole(ofPoints), true);
    topology.addHexahedra(come, ofHexahedra, whole(ofHexahedra));
    topology.removeHexahedra(leave);
    topology.notifyEndingEvent();
    m_coming.clear();
}

void HexahedronElastoplasticFEMForceField::requireTopology() const
{
    if (m_topologyIsLost)
        throw InputError(
            "hexahedra may be removed from its topology, but nothing added or renumbered: set "
            "removeIsolated=\"false\" in HexahedronSetTopologyModifier");
}

// A removed hexahedron's place is taken by the last one, in the order of the list.
void HexahedronElastoplasticFEMForceField::handleTopologyChange(sofa::core::topology::Topology* changed)
{
    if (!hasPart() || m_topologyIsLost || changed != l_topology.get()) return;
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
                                if (!m_isSplitting) gone.push_back(m_original[i]);
                                m_original[i] = m_original.back();
                                m_original.pop_back();
                            }
                            break;
                        case sofa::core::topology::HEXAHEDRAADDED:
                            m_original.insert(m_original.end(), m_coming.begin(), m_coming.end());
                            m_topologyIsLost = m_topologyIsLost || !m_isSplitting;
                            break;
                        case sofa::core::topology::POINTSADDED:
                            m_topologyIsLost = m_topologyIsLost || !m_isSplitting;
                            break;
                        case sofa::core::topology::POINTSREMOVED:
                        case sofa::core::topology::POINTSRENUMBERING:
                            m_topologyIsLost = true;
                            break;
                        default:
                            break;
                    }
                }
                requireTopology();
                m_topologyHasChanged = true;
                if (!gone.empty()) m_body->remove(gone);
                setOutputsDirty();
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
    const std::vector<double> strain = nodal_means(body.mesh(), plastic_strains(body), alive);
    const double max = strain.empty() ? 0 : *std::max_element(strain.begin(), strain.end());
    static sofa::helper::ColorMap colours(256, "Blue to Red");
    const auto colour = colours.getEvaluator(0.0, std::max(max, 1e-6));
    const auto faces = body.mesh().boundary_faces(alive);
    std::vector<sofa::type::Vec3> corners;
    std::vector<sofa::type::RGBAColor> shades;
    for (const auto& face : faces)
        for (const int k : {0, 1, 2, 0, 2, 3})
        {  // two triangles: SOFA does not light quads in the colours of their corners
            const int node = face[k];
            corners.emplace_back(x(node, 0), x(node, 1), x(node, 2));
            shades.push_back(colour(strain[node]));
        }
    tool->drawTriangles(corners, shades);

    if (!d_drawPlasticRestShape.getValue()) return;
    const PointArray& material = body.plastic_rest_positions();
    std::vector<sofa::type::Vec3> ends;
    for (const auto& face : faces)
        for (std::size_t k = 0; k < face.size(); ++k)
            for (const int node : {face[k], face[(k + 1) % face.size()]})
                ends.emplace_back(material(node, 0), material(node, 1), material(node, 2));
    tool->drawLines(ends, 1, sofa::type::RGBAColor::gray());
}

[[maybe_unused]] const bool kBodyIsRegistered =
    registerComponent<HexahedronElastoplasticFEMForceField>(attributes::kHexahedronElastoplasticFEMForceField);

}  // namespace hexaplast::sofa_plugin
