// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_instructions STAGE COUNT: carries out one stage COUNT times on a bar of 1,024 hexahedra, with the kernels
// for AVX2 and one thread, after a first time that does not count. Callgrind collects what hexaplast_counted takes and
// nothing around it (scripts/count_instructions), so that the figure is the same on every machine with this compiler.
//
//   STAGE  operator_double, operator_mixed, linearize, flow; with a colon and the words of `bending` and `volumetric`
//          behind it, of that element: operator_mixed:assumedCorner:volumeRatio
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>

#include "base/simd.hpp"
#include "bench/bar.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/material/rows.hpp"

namespace {

using namespace hexaplast;

template <class T>
void multiply(const ChunkedOperator<T>& op, const AlignedVector<T>& p, AlignedVector<T>& Ap) {
  for (int chunk = 0; chunk < op.partition().num_chunks; ++chunk) op.add_product(chunk, T(1), p.data(), Ap.data());
}

}  // namespace

/// What scripts/count_instructions has callgrind collect: by this name, and nothing around it.
extern "C" [[gnu::noinline]] void hexaplast_counted(const std::function<void()>& stage) { stage(); }

namespace {

/// Sets what the words behind the first colon say.
Settings element_of(std::string words) {
  Settings settings;
  for (const char* member : {"bending", "volumetric"}) {
    const Row<Settings>& row = *find_row(settings_rows(), member, Names::kMembers);
    const std::string word = words.substr(0, words.find(':'));
    const int place = place_of_word(row, word);
    if (place < 0) throw InputError(std::string(member) + " = " + word + ": must " + row.condition());
    row.at.set(settings, place);
    words.erase(0, word.size() + 1);
  }
  return settings;
}

void carry_out(const std::string& stage_and_element, int count) {
  const std::size_t colon = stage_and_element.find(':');
  const std::string name = stage_and_element.substr(0, colon);
  const Settings element =
      colon == std::string::npos ? published_element() : element_of(stage_and_element.substr(colon + 1));
  const bool flows = name == "flow";
  const bool is_double = name == "operator_double" || (flows && element.rest_shape == RestShape::kJoined);
  bench::Bar bar({.size = 1000,
                  .mode = flows ? bench::Mode::kPlastic : bench::Mode::kElastic,
                  .precision = is_double ? Precision::kDouble : Precision::kMixed,
                  .element = element});
  Body& body = bar.body();
  PointArray x = 1.01 * bar.positions();
  x.col(0) += 0.1 * x.col(2);
  body.linearize(x);
  MatrixFreeSystem system;
  body.describe(-1, system);
  const std::size_t size = 4 * static_cast<std::size_t>(body.state().model.partition->num_slots);
  AlignedVector<double> p(size, 1.0), Ap(size, 0.0);
  AlignedVector<float> single_p(size, 1.0F), single_Ap(size, 0.0F);

  std::function<void()> stage, before = [] {};
  if (name == "operator_double") {
    stage = [&] { multiply(*system.bodies[0].double_operator, p, Ap); };
  } else if (name == "operator_mixed") {
    stage = [&] { multiply(*system.bodies[0].single_operator, single_p, single_Ap); };
  } else if (name == "linearize") {
    stage = [&] { body.linearize(x *= 1.0001); };
  } else if (flows) {
    before = [&] { body.linearize(body.mesh().positions()); };  // as the step before its flow
    stage = [&] { body.flow(x, bench::kBarDt); };
  } else {
    throw InputError("stage " + name + ": must be operator_double, operator_mixed, linearize or flow");
  }
  before();
  stage();  // the first also makes what is kept
  for (int time = 0; time < count; ++time) {
    before();
    hexaplast_counted(stage);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: hexaplast_instructions STAGE COUNT\n";
    return 2;
  }
  try {
    set_num_threads(1);
    set_simd_target("AVX2");
    carry_out(argv[1], std::atoi(argv[2]));
  } catch (const InputError& error) {
    std::cerr << "hexaplast_instructions: error: " << error.what() << '\n';
    return 2;
  }
}
