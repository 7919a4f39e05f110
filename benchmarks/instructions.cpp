// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_instructions STAGE COUNT: carries out one stage COUNT times on a bar of 1,024 hexahedra, with the kernels
// for AVX2 and one thread, after a first time that does not count. Callgrind collects what hexaplast_counted takes and
// nothing around it (scripts/count_instructions), so that the figure is the same on every machine with this compiler.
//
//   STAGE  operator_double, operator_mixed, linearize, flow (in mixed precision); paper_product, paper_linearize,
//          paper_flow: of the paper's method, by the plain implementation
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>

#include "base/simd.hpp"
#include "bench/bar.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

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

void carry_out(const std::string& name, int count) {
  const bool is_paper = name.starts_with("paper_"), flows = name.ends_with("flow");
  const bool is_double = is_paper || name == "operator_double";
  bench::Bar bar({.size = 1000,
                  .mode = flows ? bench::Mode::kPlastic : bench::Mode::kElastic,
                  .precision = is_double ? Precision::kDouble : Precision::kMixed,
                  .element = is_paper ? published_element() : Settings()});
  Body& body = bar.body();
  PointArray x = 1.01 * bar.positions();
  x.col(0) += 0.1 * x.col(2);
  body.linearize(x);
  MatrixFreeSystem system;
  body.add_operator(-1, system);
  const std::size_t size = 4 * static_cast<std::size_t>(body.state().model.partition->num_slots);
  AlignedVector<double> p(size, 1.0), Ap(size, 0.0);
  PointArray product = PointArray::Zero(x.rows(), 3);
  AlignedVector<float> single_p(size, 1.0F), single_Ap(size, 0.0F);

  std::function<void()> stage, before = [] {};
  if (name == "operator_double") {
    stage = [&] { multiply(*system.bodies[0].double_operator, p, Ap); };
  } else if (name == "operator_mixed") {
    stage = [&] { multiply(*system.bodies[0].single_operator, single_p, single_Ap); };
  } else if (name == "paper_product") {
    stage = [&] { body.add_stiffness_product(1, bar.positions(), product); };
  } else if (name.ends_with("linearize")) {
    stage = [&] { body.linearize(x *= 1.0001); };
  } else if (flows) {
    before = [&] { body.linearize(body.mesh().positions()); };  // as the step before its flow
    stage = [&] { body.flow(x, bench::kBarDt); };
  } else {
    throw InputError("stage " + name + ": is none of those that the head of benchmarks/instructions.cpp lists");
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
