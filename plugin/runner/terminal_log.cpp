// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/terminal_log.hpp"

#include <spdlog/sinks/base_sink.h>

#include <cstdio>
#include <mutex>

#include "formats/text.hpp"

namespace hexaplast::runner {
namespace {

class TerminalLog : public spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string line = printable({message.payload.data(), message.payload.size()}) + "\n";
    std::fwrite(line.data(), 1, line.size(), stderr);
  }
  void flush_() override { std::fflush(stderr); }
};

}  // namespace

std::shared_ptr<spdlog::sinks::sink> make_terminal_log() { return std::make_shared<TerminalLog>(); }

}  // namespace hexaplast::runner
