// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/Base.h>

#include <sstream>

namespace sofa_standin {

enum class Severity { kInfo, kWarning, kError };

struct Message {
  Severity severity;
  std::string text;
};

/// What components have said since the list was cleared: a test reads it.
inline std::vector<Message>& messages() {
  static std::vector<Message> list;
  return list;
}

class MessageStream {
 public:
  explicit MessageStream(Severity severity, const sofa::core::objectmodel::Base* = nullptr) : severity_(severity) {}
  ~MessageStream() { messages().push_back({severity_, text_.str()}); }
  template <class T>
  MessageStream& operator<<(const T& value) {
    text_ << value;
    return *this;
  }

 private:
  Severity severity_;
  std::ostringstream text_;
};

}  // namespace sofa_standin

#define msg_error(...) ::sofa_standin::MessageStream(::sofa_standin::Severity::kError __VA_OPT__(, ) __VA_ARGS__)
#define msg_warning(...) ::sofa_standin::MessageStream(::sofa_standin::Severity::kWarning __VA_OPT__(, ) __VA_ARGS__)
// in a component: said where its printLog asks for it
#define msg_info()                    \
  if (!this->f_printLog.getValue()) { \
  } else                              \
    ::sofa_standin::MessageStream(::sofa_standin::Severity::kInfo)
