// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

/// Many small bodies in one process: one after the other, and stepped at once.
namespace hexaplast::bench {

struct BatchOptions {
  std::vector<int> sizes{90, 250, 1000};  ///< hexahedra of each body, about; see batch_cells
  std::vector<int> threads{1, 2};
  int num_bodies = 64;
  bool quick = false;  ///< few steps and repetitions
};

/// One way for the bodies to take their turns, from the best of some repetitions.
struct BatchRate {
  double per_core = 0;  ///< steps of a body per second of processor time, which other programs hardly change
  double speed_up = 1;  ///< by the clock on the wall, over one body after the other on one thread
};

/// Bodies of one kind.
struct BatchRecord {
  int size = 0;           ///< hexahedra of each body
  int bodies = 0;         ///< each with a stiffness of its own
  std::string mode;       ///< elastic, plastic: every hexahedron yields in every step
  std::string precision;  ///< double, mixed
  int threads = 1;
  std::string simd;
  std::string processor;

  BatchRate alone;         ///< one body after the other, on one thread
  BatchRate loops;         ///< one body after the other, its loops on all threads
  BatchRate together;      ///< all bodies make a step at once, each on one thread, then the next
  BatchRate independent;   ///< all bodies at once, each on one thread, without waiting for one another
  std::string state_hash;  ///< of all bodies at the end
};

struct BatchOutcome {
  std::vector<BatchRecord> records;
  std::vector<std::string> failures;  ///< bodies whose state is not that of the same body alone, or that failed
};

/// Cells of a bar of about `size` cubes, ten of them along its length: 3 x 3 x 10, 5 x 5 x 10, 10 x 10 x 10.
std::array<int, 3> batch_cells(int size);

/// Measures every size, mode, precision and number of threads with 25 iterations of conjugate gradients. `on_record`
/// is given each record as soon as it is complete.
BatchOutcome run_batch(const BatchOptions& options, const std::function<void(const BatchRecord&)>& on_record);

/// A sentence for the first body whose hash is another one than alone, with the number of those; none: empty.
std::string differing_bodies(const std::vector<std::string>& alone, const std::vector<std::string>& found);

std::string to_json(const std::vector<BatchRecord>& records);
std::string batch_head();
std::string batch_row(const BatchRecord& record);

}  // namespace hexaplast::bench
