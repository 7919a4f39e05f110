// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sofa/helper/logging/Message.h>
#include <sofa/helper/logging/MessageDispatcher.h>
#include <sofa/helper/logging/MessageHandler.h>

#include <stdexcept>
#include <string>

namespace hexaplast::sofa_plugin::test
{

/// What SOFA's components say while it lives.
class Messages final : public sofa::helper::logging::MessageHandler
{
public:
    Messages() { sofa::helper::logging::MessageDispatcher::addHandler(this); }
    ~Messages() override { sofa::helper::logging::MessageDispatcher::rmHandler(this); }
    void process(sofa::helper::logging::Message& message) override
    {
        m_text += message.messageAsString() + "\n";
        if (message.type() >= sofa::helper::logging::Message::Error) m_errors += message.messageAsString() + "\n";
    }

    std::string getName() const override { return "test"; }
    const std::string& text() const { return m_text; }
    const std::string& errors() const { return m_errors; }
    int count(const std::string& words) const
    {
        int found = 0;
        for (std::size_t at = m_text.find(words); at != m_text.npos; at = m_text.find(words, at + 1)) ++found;
        return found;
    }

private:
    std::string m_text, m_errors;
};

inline std::string replaced(std::string text, const std::string& from, const std::string& to)
{
    const std::size_t at = text.find(from);
    if (at == text.npos) throw std::runtime_error("no '" + from + "' in the scene");
    return text.replace(at, from.size(), to);
}

}  // namespace hexaplast::sofa_plugin::test
