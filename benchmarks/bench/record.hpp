// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace hexaplast::bench {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Model of the processor, as the system names it.
std::string processor_name();

/// One thread-precision-solver-mode cell of the table. Times are wall times of whole implicit steps.
struct Record {
  // what was measured
  int size = 0;              ///< hexahedra
  std::string shape;         ///< box: every rest shape a parallelepiped at the start; or the name of a scene
  std::string element;       ///< bending and volumetric: "blended sample"; behind them "isolated" rest shapes
  double poisson_ratio = 0;  ///< 0 for scenes
  std::string mode;          ///< elastic, plastic_idle, plastic_part, plastic
  std::string precision;     ///< double, mixed
  std::string solver;        ///< cg, jacobi, multigrid, auto; or the scene's
  std::string target;        ///< what the solver was asked for: "25 its", "1 %", "1e-6"
  int threads = 1;
  std::string simd;  ///< instruction set
  std::string processor;

  // what came out
  double iterations = 0;  ///< per step, mean
  double tolerance = 0;   ///< relative residual at which the solver ends; 0 where it does all its iterations
  double hex_per_ms = 0;  ///< of the fastest step
  double p50_ms = 0;      ///< median of the steps
  double p99_ms = 0;
  double ratio_to_dense_peer = kNotMeasured;  ///< fastest step of the dense peer, elastic, one thread, asked for the
                                              ///< same: / fastest step of ours
  double bytes_per_hex = kNotMeasured;        ///< of everything allocated for body, state and solver
  double residual = 0;                        ///< relative, of the last step
  double velocity_error = kNotMeasured;       ///< of a velocity increment, in the norm of kinetic energy
  double yielded = 0;                         ///< fraction of the hexahedra that yielded in the last step
  std::string state_hash;                     ///< at the end; the same for any number of threads

  // [ns per hexahedron] of the stages, each the fastest of several
  double linearize_ns = kNotMeasured;  ///< gradients, rotations, forces, operator coefficients
  double operator_ns = kNotMeasured;   ///< one product
  double vectors_ns = kNotMeasured;    ///< the rest of one plain conjugate gradient iteration
  double flow_ns = kNotMeasured;       ///< plastic flow, rest shapes
};

/// An array of objects; what was not measured is null.
std::string to_json(const std::vector<Record>& records);

/// What to_json wrote. Throws InputError, naming the file, for anything else.
std::vector<Record> read_json(const std::filesystem::path& file);

std::string table_head();
std::string table_row(const Record& record);

/// One sentence for each record that falls behind the one of the same kind in `baseline`: ratio to the dense peer less
/// than `ratio` of the old one, or a residual of more than 1.1 times after the same iterations. Times are not compared,
/// nor is the ratio of several threads: the peer has one, and whoever takes a processor from the others makes them all
/// wait. A sentence too where no record has one of its kind.
std::vector<std::string> compare(const std::vector<Record>& records, const std::vector<Record>& baseline, double ratio);

/// A sentence for each record whose state hash differs from that of the same body with another number of threads.
std::vector<std::string> differing_hashes(const std::vector<Record>& records);

}  // namespace hexaplast::bench
