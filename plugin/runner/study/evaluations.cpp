// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/evaluations.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "record/files.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {

std::vector<std::string> assignments(const std::vector<FreeAttribute>& free, const Point& point) {
  std::vector<std::string> words;
  for (std::size_t p = 0; p < free.size(); ++p)
    words.push_back(fmt::format("{}={}", free[p].name, written(free[p].value(point[p]))));
  return words;
}

std::optional<std::vector<double>> evaluate(const Experiments& experiments, const std::vector<FreeAttribute>& free,
                                            const Point& point) {
  try {
    return experiments.run(assignments(free, point));
  } catch (const NumericalError&) {
    return {};
  } catch (const scene::SceneError&) {  // values that do not go together
    return {};
  } catch (const InputError&) {
    return {};
  }
}

Evaluations::Evaluations(const Experiments& experiments, const std::vector<FreeAttribute>& free, int jobs, int threads)
    : experiments_(experiments), free_(free) {
  workers_.reserve(static_cast<std::size_t>(jobs));
  for (int w = 0; w < jobs && jobs > 1; ++w) workers_.push_back(Worker::start(threads));
}

Evaluations::Evaluations(const Experiments& experiments, const std::vector<FreeAttribute>& free,
                         const std::vector<int>& sockets)
    : experiments_(experiments), free_(free) {
  workers_.reserve(sockets.size());
  for (const int socket : sockets) workers_.push_back(Worker::at(socket));
}

const std::vector<double>& Evaluations::first(const Point& point) {
  const std::vector<std::string> words = assignments(free_, point);
  std::optional<std::vector<double>>& found = known_[words];
  if (!found) found = experiments_.run(words);
  return *found;
}

std::vector<std::optional<std::vector<double>>> Evaluations::at(const std::vector<Point>& points) {
  std::vector<Point> unknown;
  std::vector<std::vector<std::string>> words;
  for (const Point& point : points)
    if (std::vector<std::string> of_point = assignments(free_, point);
        !known_.contains(of_point) && std::ranges::find(words, of_point) == words.end()) {
      unknown.push_back(point);
      words.push_back(std::move(of_point));
    }
  std::vector<std::optional<std::vector<double>>> found = run(unknown);
  for (std::size_t k = 0; k < unknown.size(); ++k) known_[words[k]] = std::move(found[k]);

  std::vector<std::optional<std::vector<double>>> values;
  for (const Point& point : points) values.push_back(known_.at(assignments(free_, point)));
  return values;
}

std::vector<std::optional<std::vector<double>>> Evaluations::run(const std::vector<Point>& points) {
  std::vector<std::optional<std::vector<double>>> found;
  if (!workers_.empty()) {
    found = ask_all(workers_, points);
    for (const std::optional<std::vector<double>>& values : found)
      if (values && values->size() != experiments_.num_values())
        throw output::OutputError("a process that evaluates has given the answer to another question");
    return found;
  }
  for (const Point& point : points) found.push_back(evaluate(experiments_, free_, point));
  return found;
}

}  // namespace hexaplast::runner
