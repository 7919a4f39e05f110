// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/FollowsNodes.h>
#include <Hexaplast/ForceBetweenStates.h>
#include <Hexaplast/ForceOnState.h>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "parts/hexahedral_body.hpp"

namespace hexaplast::sofa_plugin
{

/// A part that is a force (parts/force.hpp) as a force field of SOFA. Its Data are the options and outputs of the part,
/// with names, defaults and help of the attribute table.
template <class Part>
class ForceOf : public std::conditional_t<Part::kNumStates == 1, ForceOnState, ForceBetweenStates>, public FollowsNodes
{
public:
    using Inherit = std::conditional_t<Part::kNumStates == 1, ForceOnState, ForceBetweenStates>;
    SOFA_CLASS(SOFA_TEMPLATE(ForceOf, Part), Inherit);
    static std::string GetCustomClassName() { return std::string(Part::description().class_name); }
    static std::string GetCustomTemplateName() { return Vec3Types::Name(); }

    bool hasPart() const override { return m_part.has_value(); }

    void nodesChanged(const MechanicalState& state, const SharedBody& body, std::span<const int> splitFrom) override
    {
        const std::array states = this->states();
        for (std::size_t k = 0; hasPart() && k < Part::kNumStates; ++k)
        {
            if (states[k] != &state) continue;
            m_followed[k] = body;
            m_part->nodes_changed(static_cast<int>(k), body->body().copies(), splitFrom);
        }
    }

protected:
    explicit ForceOf(const Description& description = Part::description()) : Inherit(description, false)
    {
        this->template makeData<Part>();
    }

    parts::Force& forces() const override { return *m_part; }

    // Lists of SOFA's regions have the copies of nodes beside them, where these have split.
    virtual typename Part::Options options() const
    {
        auto options = this->template readOptions<typename Part::Options>();
        const SharedBody body = splitBodyOn(*this->states()[0]);
        const auto isCopy = [&](int node) { return node >= body->body().copies().num_initial(); };
        if constexpr (requires { options.indices.value(); })
        {
            if (body && options.indices) std::erase_if(*options.indices, isCopy);
        }
        else if constexpr (requires { options.indices; })
        {
            if (body) std::erase_if(options.indices, isCopy);
        }
        return options;
    }

    /// Throws InputError where it is not there.
    virtual parts::Surroundings surroundings()
    {
        parts::Surroundings around;
        for (std::size_t k = 0; k < 2; ++k)
        {
            const MechanicalState& state = *this->states()[k];
            const SharedBody body = splitBodyOn(state);
            around.num_nodes[k] = body ? body->body().copies().num_initial() : static_cast<int>(state.getSize());
        }
        return around;
    }

    void makePart() override
    {
        // one that cannot be made leaves the one before, which does nothing as the component is invalid
        const parts::Surroundings around = surroundings();
        const typename Part::Options given = options();
        m_part.reset();
        m_part.emplace(given, around);
        m_followed = {};
        for (const MechanicalState* state : this->states())
            if (const SharedBody body = splitBodyOn(*state)) nodesChanged(*state, body, {});
        sayWarnings();
    }
    /// Whether a body that its nodes have split with has been made anew or is gone.
    bool othersHaveChanged() override
    {
        const std::array states = this->states();
        for (std::size_t k = 0; k < Part::kNumStates; ++k)
            if (m_followed[k] && bodyOn(*states[k]) != m_followed[k]) return true;
        return false;
    }
    void updatePart() override
    {
        if (ForceOf::othersHaveChanged()) return makePart();
        m_part->set_options(options());
        sayWarnings();
    }
    void resetPart() override
    {
        m_part->reset();
        showOutputs();
    }
    void beginStep(SReal time, SReal dt) override { beginPart({.time = time, .dt = dt}); }
    void endStep(SReal) override
    {
        m_part->end_step(positions());
        sayWarnings();
        showOutputs();
    }

    void savePart(std::ostream& out) const override
    {
        SavedState::write(out, this->getClassName(), [this](Archive& archive) { m_part->serialize(archive); });
    }
    void loadPart(std::istream& in) override
    {
        for (const MechanicalState* state : this->states()) takeGivenStateOfBodyOn(*state);
        SavedState::read(in, this->getClassName(), [this](Archive& archive) { m_part->serialize(archive); });
        showOutputs();
    }

    void beginPart(const Step& step)
    {
        const std::array states = this->states();
        m_part->begin_step(step, positions(),
                           {view(states[0]->readVelocities().ref()), view(states[1]->readVelocities().ref())});
        sayWarnings();
    }

    Pair<ConstPoints> positions() const
    {
        const std::array states = this->states();
        return {view(states[0]->readPositions().ref()), view(states[1]->readPositions().ref())};
    }

    void showOutputs()
    {
        Part::outputs(
            [&](std::string_view name, const auto& of)
            {
                using T = std::remove_cvref_t<decltype(std::invoke(of, std::as_const(*m_part)))>;
                writeOutput<T>(*this->findData(std::string(name)), std::invoke(of, std::as_const(*m_part)));
            });
    }
    void sayWarnings() { passOn(*this, m_part->take_warnings()); }

    mutable std::optional<Part> m_part;    ///< which an archive may write to
    std::array<SharedBody, 2> m_followed;  ///< of each state, whose copies the part refers to; null: none has split
};

}  // namespace hexaplast::sofa_plugin
