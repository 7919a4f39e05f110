// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/log.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
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

class KeptWarnings::Sink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> texts;

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    std::string text(message.payload.data(), message.payload.size());
    if (message.level == spdlog::level::warn && std::ranges::find(texts, text) == texts.end())
      texts.push_back(std::move(text));
  }
  void flush_() override {}
};

KeptWarnings::KeptWarnings() : sink_(std::make_shared<Sink>()) { spdlog::default_logger()->sinks().push_back(sink_); }

KeptWarnings::~KeptWarnings() { std::erase(spdlog::default_logger()->sinks(), sink_); }

std::vector<std::string> KeptWarnings::texts() const { return sink_->texts; }

}  // namespace hexaplast::runner
