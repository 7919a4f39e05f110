// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/kept_warnings.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

namespace hexaplast::runner {

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
