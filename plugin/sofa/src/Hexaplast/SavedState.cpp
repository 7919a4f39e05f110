// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/SavedState.h>

#include <limits>
#include <sstream>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hash.hpp"
#include "hexaplast/base/saved_stream.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

constexpr SavedKind kKind{{'H', 'X', 'P', 'S', 'O', 'F', 'A', 'S'}, 1, "state"};
constexpr std::string_view kDigits = "0123456789abcdef";

std::string toHexadecimal(const std::string& bytes)
{
    std::string text;
    text.reserve(2 * bytes.size());
    for (const char byte : bytes)
    {
        text += kDigits[static_cast<unsigned char>(byte) >> 4];
        text += kDigits[static_cast<unsigned char>(byte) & 15];
    }
    return text;
}

std::string fromHexadecimal(const std::string& text)
{
    std::string bytes;
    bytes.reserve(text.size() / 2);
    int high = -1;
    for (const char digit : text)
    {
        if (digit == ' ' || digit == '\n' || digit == '\r' || digit == '\t') continue;
        const std::size_t value = kDigits.find(digit);
        if (value == std::string_view::npos)
            throw parts::OptionError("state", std::string("holds '") + digit + "', must be hexadecimal digits");
        if (high >= 0) bytes += static_cast<char>(16 * high + static_cast<int>(value));
        high = high >= 0 ? -1 : static_cast<int>(value);
    }
    if (high >= 0) throw parts::OptionError("state", "ends within a byte: a digit is missing");
    return bytes;
}

std::uint64_t identityOf(const std::string& owner)
{
    StateHash hash;
    hash.add(owner.data(), owner.size());
    return hash.value();
}

}  // namespace

SavedState::SavedState(SofaComponent& owner, Save save)
    : d_state(owner.initData(&d_state, "state",
                             "What it keeps from one step to the next (plastic deformation, contacts), in hexadecimal "
                             "digits. One that is given takes effect at the beginning of the next step.")),
      m_save(std::move(save)),
      m_output({&d_state},
               [this]
               {
                   if (m_isGiven || !m_isInitialised) return;
                   std::ostringstream bytes(std::ios::binary);
                   m_save(bytes);
                   m_isComputed = true;
                   d_state.setValue(toHexadecimal(bytes.str()));
                   m_isComputed = false;
               })
{
    d_state.setGroup("State");
    m_edits.addInputs({&d_state});
    m_edits.addCallback(
        [this]
        {
            if (!m_isComputed) m_isGiven = true;
        });
}

void SavedState::take(const Load& load)
{
    const std::string given = d_state.getValue();
    m_isGiven = false;
    hasChanged();
    if (given.empty()) return;
    std::istringstream bytes(fromHexadecimal(given), std::ios::binary);
    std::ostringstream before(std::ios::binary);
    m_save(before);
    try
    {
        load(bytes);
    }
    catch (const std::runtime_error&)
    {
        std::istringstream present(before.str(), std::ios::binary);
        load(present);
        throw;
    }
}

void SavedState::takeFirst(const Load& load, bool keepsGiven)
{
    if (!m_isInitialised && m_isGiven) m_first = d_state.getValue();
    m_isInitialised = true;
    if (!keepsGiven || !m_isGiven)
    {
        m_isGiven = false;
        hasChanged();
        if (m_first.empty()) return;
        d_state.setValue(m_first);
    }
    take(load);
}

void SavedState::write(std::ostream& out, const std::string& owner, const Contents& contents)
{
    write_saved(out, kKind, identityOf(owner), contents);
}

void SavedState::read(std::istream& in, const std::string& owner, const Contents& contents)
{
    const std::vector<std::byte> bytes =
        read_saved(in, kKind, identityOf(owner), static_cast<std::size_t>(in.rdbuf()->in_avail()));
    Archive archive{std::span<const std::byte>(bytes)};
    contents(archive);
    if (archive.rest() != 0) throw InputError("the saved state has bytes too many");
}

}  // namespace hexaplast::sofa_plugin
