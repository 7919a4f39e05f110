// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <limits>
#include <optional>

#include "attributes/parts.hpp"
#include "attributes/words.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "parts/probe.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

class Probe final : public scene::Probe {
 public:
  Probe() : scene::Probe(attributes::kProbe) {}

  // When the outputs of all components are there.
  void bwd_init() override {
    if (!is_given("value")) reject("value", "is not given: there is nothing to record");
    probe_.emplace(options(), holds_vectors() ? 3 : 1);
    read();
  }
  // What it records changes with every step.
  void refresh() override { probe_->set_options(options()); }

  double read() override {
    return accepted(*this, [&] { return probe_->read(reals("value")); });
  }
  std::string_view unit() override { return source().attribute().unit; }

 private:
  /// The attribute that the value follows in the end.
  scene::Data& source() {
    scene::Data* data = find_data("value");
    while (data->source()) data = data->source();
    return *data;
  }
  bool holds_vectors() {
    const attributes::Type type = source().attribute().type;
    return type == attributes::Type::kVector3 || type == attributes::Type::kVectors3;
  }

  /// The place of a word among those of its attribute.
  template <class Word>
  Word word(std::string_view attribute) {
    const std::vector<std::string_view> words = attributes::split_words(find_data(attribute)->attribute().words);
    return static_cast<Word>(std::ranges::find(words, text(attribute)) - words.begin());
  }
  parts::ProbeOptions options() {
    return {.entries = indices("indices", std::numeric_limits<int>::max()),
            .component = word<parts::ProbeOptions::Component>("component"),
            .statistic = word<parts::ProbeOptions::Statistic>("statistic"),
            .is_change = boolean("change")};
  }

  std::optional<parts::Probe> probe_;
};

}  // namespace

void add_probes(scene::Factory& factory) { factory.add<Probe>(attributes::kProbe); }

}  // namespace hexaplast::components
