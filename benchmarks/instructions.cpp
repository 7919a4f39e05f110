// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast_instructions STAGE COUNT: carries out one stage COUNT times on a bar of 1,024 hexahedra, with the kernels
// for AVX2 and one thread. Run under callgrind with two counts, the difference is what the stage takes, whatever the
// machine does besides (scripts/count_instructions).
//
//   STAGE  operator_double, operator_mixed, linearize, flow
#include <cstdlib>
#include <iostream>
#include <string>

#include "bench/bar.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/base/simd.hpp"

namespace {

using namespace hexaplast;

template <class T>
void multiply(const ChunkedOperator<T>& op, int count) {
  const Partition& partition = op.partition();
  AlignedVector<T> p(4 * static_cast<std::size_t>(partition.num_slots), T(1)), Ap = slot_vector<T>(partition);
  for (int product = 0; product < count; ++product)
    for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, T(1), p.data(), Ap.data());
}

void carry_out(const std::string& stage, int count) {
  const bool flows = stage == "flow";
  bench::Bar bar({.size = 1000,
                  .mode = flows ? bench::Mode::kPlastic : bench::Mode::kElastic,
                  .precision = stage == "operator_double" ? Precision::kDouble : Precision::kMixed});
  Body& body = bar.body();
  PointArray x = 1.01 * bar.positions();
  x.col(0) += 0.1 * x.col(2);
  body.linearize(x);

  if (stage == "operator_double" || stage == "operator_mixed") {
    KernelSystem system;
    body.to_kernels(-1, system);
    if (system.double_operator)
      multiply(*system.double_operator, count);
    else
      multiply(*system.single_operator, count);
  } else if (stage == "linearize") {
    for (int time = 0; time < count; ++time) body.linearize(x *= 1.0001);
  } else if (flows) {
    for (int time = 0; time < count; ++time) body.flow(x, bench::kBarDt);
  } else {
    throw InputError("stage " + stage + ": must be operator_double, operator_mixed, linearize or flow");
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
