// SPDX-License-Identifier: LGPL-2.1-or-later
// first_kernels [--check]: checks the first kernels for a GPU against the formulas of the library in double precision,
// and measures them at three sizes; --check: no times. Compiled by a C++ compiler instead of nvcc it checks alone, on
// the CPU. scripts/gpu_check reads its lines of JSON.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "device/plastic.cuh"
#include "reference.hpp"

namespace hexaplast::one_number {
namespace {

using gpu::Answers;
using Numbers = std::vector<double>;

constexpr int kIterations = 25;
constexpr double kEdge = 0.003, kMu = 1724, kLambda = 15517;  // [m], [Pa]: 5 kPa, Poisson's ratio .45
constexpr gpu::FlowNumbers kRule{.rate_dt = 0.05, .hardening = 0.2};

using device::Array;
using device::copy_on_device;
using device::launch;

struct Size {
  int x, y, z;  ///< multiples of 4, 4, 2
  int count() const { return x * y * z; }
};

int place_of(int e, int count, int k) { return (e / kWidth * count + k) * kWidth + e % kWidth; }

/// Gm of the G, both as on the device.
Numbers mean_of(const Numbers& G) {
  Numbers mean(G.size() / 12);
  for (int e = 0; e < static_cast<int>(G.size() / 72); ++e) {
    Mat<double> inverse[8];
    for (int k = 0; k < 72; ++k) inverse[k % 8].m[k / 24][k / 8 % 3] = G[place_of(e, 72, k)];
    const Mat<double> Gm = mean_plastic_inverse(inverse);
    const double lower[6] = {Gm(0, 0), Gm(1, 0), Gm(2, 0), Gm(1, 1), Gm(2, 1), Gm(2, 2)};
    for (int k = 0; k < 6; ++k) mean[place_of(e, 6, k)] = lower[k];
  }
  return mean;
}

/// A sheared grid of boxes of different sizes, turned, stretched and distorted, in bricks of 4 x 4 x 2; nodes are
/// numbered by the first brick that has them.
struct Grid {
  std::vector<std::uint8_t> local, sorted;
  std::vector<std::uint16_t> begin;
  std::vector<int> node, partial_begin, partial;
  std::vector<double4_32a> rest_x, x;
  std::vector<float> rest, mean;
  std::vector<float4> mass;  // of each axis
  Numbers G, tau;
  int num_bricks, num_nodes;

  explicit Grid(const Size& size) : num_bricks(size.count() / kWidth) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> about(-1, 1);
    place_nodes(size, [&] { return about(random); });
    for (const double4_32a& X : rest_x) {
      const double u = 1.08 * X.x + 0.03 * kEdge * about(random), v = 0.97 * X.y + 0.03 * kEdge * about(random);
      x.push_back({0.8 * u - 0.6 * v + 1, 0.6 * u + 0.8 * v, 1.02 * X.z + 0.03 * kEdge * about(random), 0});
    }
    mass.assign(num_nodes, {}), rest.resize(size.count() * kRestNumbers);
    G.resize(size.count() * 72), tau.resize(size.count() * 8);
    for (int e = 0; e < size.count(); ++e) {
      Mat<double> edges;
      for (int n = 0; n < 3; ++n) {
        const double4_32a from = rest_x[node_of(e, 0)], to = rest_x[node_of(e, kEdgeNeighbour[0][n])];
        edges(n, 0) = to.x - from.x, edges(n, 1) = to.y - from.y, edges(n, 2) = to.z - from.z;
      }
      double volume;
      const Mat<double> dual = reciprocal(edges, volume);
      const auto set = [&](int k, double a) { rest[place_of(e, kRestNumbers, k)] = static_cast<float>(a); };
      for (int k = 0; k < 9; ++k) set(k, dual.m[k / 3][k % 3]);
      set(9, volume), set(10, kMu), set(11, kLambda), set(12, kRule.rate_dt), set(13, kRule.hardening);  // in 1 s
      for (const int k : {14, 15}) set(k, std::numeric_limits<double>::infinity());  // nothing breaks
      for (int c = 0; c < 8; ++c) {
        // h^2 K / M about 9: sound crosses three edges in a step
        float4& m = mass[node_of(e, c)];
        m.x = m.y = m.z = m.x + static_cast<float>((2 * kMu + kLambda) * volume / (9 * 8 * kEdge * kEdge));
        for (int k = 0; k < 9; ++k) G[place_of(e, 72, 8 * k + c)] = (k % 4 == 0) + 0.03 * about(random);
        tau[place_of(e, 8, c)] = 0.02 * kMu * (1 + 0.3 * about(random));
      }
    }
    const Numbers exact = mean_of(G);
    mean.assign(exact.begin(), exact.end());
  }
  void place_nodes(const Size& size, const std::function<double()>& about) {
    const int count[3] = {size.x, size.y, size.z};
    Numbers plane[3];
    for (int n = 0; n < 3; ++n) {
      plane[n].push_back(0);
      for (int k = 0; k < count[n]; ++k) plane[n].push_back(plane[n].back() + kEdge * (1 + 0.2 * about()));
    }
    std::vector<int> number((size.x + 1) * (size.y + 1) * (size.z + 1), -1);
    std::vector<std::vector<int>> places;  // of each node
    local.resize(size.count() * 8), node.assign(num_bricks * kNodes, -1);
    int brick = 0;
    for (int K = 0; K < size.z; K += 2)
      for (int J = 0; J < size.y; J += 4)
        for (int I = 0; I < size.x; I += 4, ++brick) {
          for (int t = 0; t < 75; ++t) {
            const int i = I + t % 5, j = J + t / 5 % 5, k = K + t / 25;
            int& n = number[(k * (size.y + 1) + j) * (size.x + 1) + i];
            if (n < 0) {
              n = static_cast<int>(rest_x.size());
              const double Y = plane[1][j], Z = plane[2][k], X = plane[0][i] + 0.2 * Y + 0.1 * Z;
              rest_x.push_back({X, Y + 0.15 * Z, Z, 0});
              places.emplace_back();
            }
            node[brick * kNodes + t] = n;
            places[n].push_back(brick * kNodes + t);
          }
          std::vector<std::uint8_t> corners[kNodes];
          for (int c = 0; c < 8; ++c)
            for (int lane = 0; lane < kWidth; ++lane) {
              const auto& s = kCornerSign[c];
              const int i = lane % 4 + (s[0] > 0), j = lane / 4 % 4 + (s[1] > 0), k = lane / 16 + (s[2] > 0);
              local[(brick * 8 + c) * kWidth + lane] = static_cast<std::uint8_t>((k * 5 + j) * 5 + i);
              corners[(k * 5 + j) * 5 + i].push_back(static_cast<std::uint8_t>(c * kWidth + lane));
            }
          begin.push_back(0);
          for (const auto& of_node : corners) {
            sorted.insert(sorted.end(), of_node.begin(), of_node.end());
            begin.push_back(static_cast<std::uint16_t>(begin.back() + of_node.size()));
          }
        }
    num_nodes = static_cast<int>(rest_x.size());
    partial_begin.push_back(0);
    for (const std::vector<int>& of_node : places) {
      partial.insert(partial.end(), of_node.begin(), of_node.end());
      partial_begin.push_back(static_cast<int>(partial.size()));
    }
  }
  int node_of(int e, int c) const { return node[e / kWidth * kNodes + local[place_of(e, 8, c)]]; }
};

struct History {
  explicit History(const Grid& grid) : G(grid.G), tau(grid.tau), strain(Numbers(grid.tau.size())), mean(grid.mean) {}
  std::size_t bytes() const { return G.bytes() + tau.bytes() + strain.bytes() + mean.bytes(); }
  Array<double> G, tau, strain;
  Array<float> mean;  ///< Gm
};

/// A body on the device.
struct Body {
  explicit Body(const Grid& from) : grid(from) {}

  void linearize_at(const History& history) {
    launch(linearize, blocks, kBricksOfBlock * kWidth, at, rest, float(kEdge), x, history.G, history.mean, coef, weight,
           partial, 0.05f, status);
  }
  void flow_to(const History& before, History& after) {
    launch(flow, blocks, kBricksOfBlock * kWidth, at, rest, FlowRule{.dt = 1}, x,
           Plastic<const double>{before.G, before.tau, before.strain}, before.mean,
           Plastic<double>{after.G, after.tau, after.strain}, status, value);
    launch(find_mean, blocks, kBricksOfBlock * kWidth, at, after.G, after.mean);
  }
  void multiply_by(const Direction& d) {
    launch(multiply, blocks, kBricksOfBlock * kWidth, at, coef, weight, d, partial);
  }
  void sum(const Direction& d) {
    launch(sum_nodes, node_blocks, kNodesOfBlock, at, NodalSystem{1, mass, nullptr, nullptr}, partial, d, p, Ap,
           block_sum, scalars);
  }
  void add_step() {
    launch(update, node_blocks, kNodesOfBlock, at.num_nodes, static_cast<float4*>(nullptr), Blocks{},
           Factor{0, &at_scalars()->alpha}, p, Ap, dv, r, block_sum, scalars);
  }
  Direction next() const { return {p, r, nullptr, {}, {0, &at_scalars()->beta}}; }
  Scalars* at_scalars() const { return scalars; }
  /// From 0.
  void solve(int iterations) {
    copy_on_device(r, rhs, r.bytes());
    for (float4* const vector : {static_cast<float4*>(p), static_cast<float4*>(dv), static_cast<float4*>(Ap)})
      copy_on_device(vector, zero, zero.bytes());
    copy_on_device(scalars, start, sizeof(Scalars));
    add_step();  // rr
    for (int k = 0; k < iterations; ++k) {
      multiply_by(next());
      sum(next());
      add_step();
    }
  }
  const Grid& grid;
  Array<std::uint8_t> local{grid.local}, sorted{grid.sorted}, status{std::size_t(grid.num_bricks * kWidth)};
  Array<std::uint16_t> begin{grid.begin};
  Array<int> node{grid.node}, partial_begin{grid.partial_begin}, places{grid.partial};
  Array<double4_32a> x{grid.x};
  Array<float> rest{grid.rest}, weight{std::size_t(grid.num_bricks * 2 * kWidth)}, value{status.size()};
  Array<float4> mass{grid.mass};
  Array<std::uint32_t> present{std::vector<std::uint32_t>(grid.num_bricks, ~0u)};
  Array<uint4> coef{std::size_t(grid.num_bricks * kWords * kWidth)};
  std::size_t num_nodes = grid.num_nodes;
  Array<float4> partial{std::size_t(grid.num_bricks * kNodes)}, p{num_nodes}, Ap{num_nodes}, r{num_nodes},
      dv{num_nodes}, rhs{num_nodes}, zero{std::vector<float4>(num_nodes)};
  Array<double> block_sum{2 * (num_nodes / kNodesOfBlock + 1)};
  Array<Scalars> scalars{1}, start{std::vector<Scalars>{{.alpha = 0, .beta = 0, .rz = 1, .finished = 0}}};
  Layout at{grid.num_bricks, grid.num_nodes, local, sorted, begin, node, partial_begin, places, present};
  int blocks = (grid.num_bricks + kBricksOfBlock - 1) / kBricksOfBlock;
  int node_blocks = (grid.num_nodes + kNodesOfBlock - 1) / kNodesOfBlock;
};

std::vector<float4> random_vector(int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> about(-1, 1);
  std::vector<float4> to(count);
  for (float4& a : to) a = {about(random), about(random), about(random), 0};
  return to;
}
Numbers numbers_of(const std::vector<float4>& from) {
  Numbers to;
  for (const float4& a : from) to.insert(to.end(), {a.x, a.y, a.z});
  return to;
}
/// Sums at the nodes, of the sums of bricks.
Numbers nodal(const Grid& grid, const std::vector<float4>& partial) {
  const Numbers of = numbers_of(partial);
  Numbers sums(3 * grid.num_nodes);
  for (int n = 0; n < grid.num_nodes; ++n)
    for (int k = grid.partial_begin[n]; k < grid.partial_begin[n + 1]; ++k)
      for (int c = 0; c < 3; ++c) sums[3 * n + c] += of[3 * grid.partial[k] + c];
  return sums;
}
Numbers product_of(const Grid& grid, const std::vector<Answers>& elements, const Numbers& u) {
  Numbers sums(u.size());
  for (int e = 0; e < static_cast<int>(elements.size()); ++e) {
    double at[8][3];
    for (int k = 0; k < 24; ++k) at[k / 3][k % 3] = u[3 * grid.node_of(e, k / 3) + k % 3];
    elements[e].multiply(at);
    for (int k = 0; k < 24; ++k) sums[3 * grid.node_of(e, k / 3) + k % 3] += at[k / 3][k % 3];
  }
  return sums;
}
double dot(const Numbers& a, const Numbers& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}
Numbers difference(Numbers a, const Numbers& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] -= b[k];
  return a;
}
double error_in_norm(const Numbers& found, const Numbers& right) {
  const Numbers error = difference(found, right);
  return std::sqrt(dot(error, error) / dot(right, right));
}
double greatest_error(const Numbers& found, const Numbers& right) {
  double greatest = 0;
  for (const double error : difference(found, right))
    if (!(std::abs(error) <= greatest)) greatest = std::abs(error);  // NaN stays
  return greatest;
}

void print_row(const char* json, const auto&... values) {
  std::printf(json, values...);
  std::puts("");
}
void bound(const Size& size, const char* what, double error, double limit) {
  print_row(R"({"check": "%s", "hexahedra": %d, "error": %g, "limit": %g})", what, size.count(), error, limit);
}

/// Every kernel against the formulas in double precision.
void compare(const Size& size) {
  const Grid grid(size);
  Body body(grid);
  History before(grid), after(grid);
  const double modulus = 2 * kMu + kLambda;
  Numbers force(3 * grid.num_nodes), G(grid.G.size()), tau(grid.tau.size()), strain(grid.tau.size());
  std::vector<Answers> right;
  double fraction = 0;
  for (int e = 0; e < size.count(); ++e) {
    gpu::Hexahedron of;
    of.mu = kMu, of.lambda = kLambda;
    for (int c = 0; c < 8; ++c) {
      std::memcpy(of.X[c], &grid.rest_x[grid.node_of(e, c)], sizeof of.X[c]);
      std::memcpy(of.x[c], &grid.x[grid.node_of(e, c)], sizeof of.x[c]);
      for (int k = 0; k < 9; ++k) of.G[c][k] = grid.G[place_of(e, 72, 8 * k + c)];
      of.tau[c] = grid.tau[place_of(e, 8, c)];
    }
    const Answers& found = right.emplace_back(gpu::answers(of, kRule));
    fraction = std::max(fraction, found.fraction);
    for (int c = 0; c < 8; ++c) {
      for (int k = 0; k < 3; ++k) force[3 * grid.node_of(e, c) + k] += found.force[c][k];
      for (int k = 0; k < 9; ++k) G[place_of(e, 72, 8 * k + c)] = found.G[c][k];
      tau[place_of(e, 8, c)] = found.tau[c], strain[place_of(e, 8, c)] = found.strain[c];
    }
  }

  body.linearize_at(before);
  bound(size, "force / ((2 mu + lambda) edge^2)",
        greatest_error(nodal(grid, body.partial.values()), force) / (modulus * kEdge * kEdge), 2e-6);

  body.p.set(random_vector(grid.num_nodes));
  body.rhs.set(random_vector(grid.num_nodes));
  const Numbers p = numbers_of(random_vector(grid.num_nodes));
  std::vector<Answers> stored = right;  // with the half coefficients of the device
  const std::vector<uint4> words = body.coef.values();
  const std::vector<float> weight = body.weight.values();
  for (int e = 0; e < size.count(); ++e) {
    const auto stored_at = [&](int word, int k) {
      const StoredHalf half = half_of(words[place_of(e, kWords, word)], k);
      return double(load_as(&half));
    };
    for (int k = 0; k < 72; ++k) stored[e].coef[k] = k % 9 < 8 ? stored_at(k / 9, k % 9) : stored_at(8, k / 9);
    for (int k = 0; k < kByHexahedron; ++k) stored[e].coef[72 + k] = stored_at(9 + k / 8, k % 8);
    for (int k = 0; k < 2; ++k) stored[e].weight[k] = weight[place_of(e, 2, k)];
  }
  body.multiply_by({body.p, nullptr, nullptr, {}});
  const Numbers product = nodal(grid, body.partial.values());  // halves round by 5e-4
  bound(size, "product, of its coefficients", error_in_norm(product, product_of(grid, stored, p)), 1e-6);
  bound(size, "product, of exact ones", error_in_norm(product, product_of(grid, right, p)), 5e-4);

  Numbers r = p, d(r.size()), dv(r.size());  // conjugate gradients in double precision
  double rr = dot(r, r), beta = 0;
  for (int k = 0; k < kIterations; ++k) {
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = r[i] + beta * d[i];
    Numbers Ad = product_of(grid, stored, d);
    for (std::size_t i = 0; i < d.size(); ++i) Ad[i] += grid.mass[i / 3].x * d[i];
    const double alpha = rr / dot(d, Ad);
    for (std::size_t i = 0; i < d.size(); ++i) dv[i] += alpha * d[i], r[i] -= alpha * Ad[i];
    const double next = dot(r, r);
    beta = next / rr, rr = next;
  }
  body.solve(kIterations);
  bound(size, "25 iterations", error_in_norm(numbers_of(body.dv.values()), dv), 1e-4);

  body.flow_to(before, after);
  const std::vector<std::uint8_t> status = body.status.values();
  bound(size, "hexahedra that the flow leaves over", double(std::count(status.begin(), status.end(), kIsLeft)), 0);
  bound(size, "G after the flow, per unit of fraction", greatest_error(after.G.values(), G) / fraction, 1e-6);
  bound(size, "tau after the flow / (2 mu + lambda)", greatest_error(after.tau.values(), tau) / modulus, 2e-6);
  bound(size, "strain of the flow, per unit of fraction", greatest_error(after.strain.values(), strain) / fraction,
        1e-6);
  const std::vector<float> mean = after.mean.values();
  bound(size, "Gm after the flow", greatest_error(Numbers(mean.begin(), mean.end()), mean_of(G)), 5e-7);
}

/// Repeats of a step have the same bits; emulation goes backwards in every other one.
void compare_repeats(const Size& size, int repeats) {
  const Grid grid(size);
  Body body(grid);
  History before(grid), after(grid);
  body.rhs.set(random_vector(grid.num_nodes));
  const auto hash_of_step = [&] {
    std::uint64_t hash = 14695981039346656037u;
    const auto add = [&](const auto& of) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(of.data());
      for (std::size_t k = 0; k < of.size() * sizeof(of[0]); ++k) hash = (hash ^ bytes[k]) * 1099511628211u;
    };
    body.linearize_at(before);
    add(body.partial.values()), add(body.coef.values());
    body.solve(5);
    add(body.dv.values());
    body.flow_to(before, after);
    add(after.G.values()), add(after.tau.values()), add(after.mean.values());
    return hash;
  };
  const std::uint64_t first = hash_of_step();
  int others = 0;
  for (int k = 1; k < repeats; ++k) {
#ifndef __CUDACC__
    goes_backwards = k % 2 == 1;
#endif
    others += hash_of_step() != first;
  }
  print_row(R"({"hash": "%016llx", "hexahedra": %d})", static_cast<unsigned long long>(first), size.count());
  bound(size, "other hashes in repeats", others, 0);
}

#ifdef __CUDACC__
/// [us] of one of the calls that follow one another in a graph: the median of 60 graphs.
double time_of(int calls, const std::function<void()>& call) {
  cudaGraph_t graph;
  cudaGraphExec_t ready;
  device::check(cudaStreamBeginCapture(device::stream, cudaStreamCaptureModeGlobal));
  for (int k = 0; k < calls; ++k) call();
  device::check(cudaStreamEndCapture(device::stream, &graph));
  device::check(cudaGraphInstantiate(&ready, graph, 0));
  cudaEvent_t from, to;
  device::check(cudaEventCreate(&from));
  device::check(cudaEventCreate(&to));
  Numbers times;
  for (int k = -5; k < 60; ++k) {
    float ms;
    device::check(cudaEventRecord(from, device::stream));
    device::check(cudaGraphLaunch(ready, device::stream));
    device::check(cudaEventRecord(to, device::stream));
    device::check(cudaEventSynchronize(to));
    device::check(cudaEventElapsedTime(&ms, from, to));
    if (k >= 0) times.push_back(1e3 * ms / calls);
  }
  std::sort(times.begin(), times.end());
  device::check(cudaEventDestroy(from));
  device::check(cudaEventDestroy(to));
  device::check(cudaGraphExecDestroy(ready));
  device::check(cudaGraphDestroy(graph));
  return times[times.size() / 2];
}

/// Times at one size.
void measure(const Size& size) {
  const Grid grid(size);
  Body body(grid);
  History before(grid), after(grid);
  const int count = size.count(), calls = count > 500000 ? 5 : 20;
  body.linearize_at(before);
  for (Array<float4>* const vector : {&body.p, &body.r, &body.rhs}) vector->set(random_vector(grid.num_nodes));
  body.scalars.set(body.start.values());
  const auto row = [&](const char* name, double bytes, int repeats, const std::function<void()>& call) {
    print_row(R"({"time": "%s", "hexahedra": %d, "us": %g, "B/hexahedron": %g})", name, count, time_of(repeats, call),
              bytes);
  };
  // bytes as kernels ask for them: a brick has 75 nodes
  const double in_brick = 75.0 / kWidth, nodes = double(grid.num_nodes) / count, corners = 8 + 4 * in_brick;
  const double sums = 8 + (2 * (kNodes + 1) + 16.0 * kNodes) / kWidth, product = 256 + 8 + corners + sums;
  const double place = 48 + 24 + corners + 32 * in_brick;
  row("product", product + 16 * in_brick, calls, [&] { body.multiply_by({body.p, nullptr, nullptr, {}}); });
  row("product, p = r + beta p", product + 32 * in_brick, calls, [&] { body.multiply_by(body.next()); });
  row("sum of nodes, p.Ap", 84 * nodes + 20 * in_brick, calls, [&] { body.sum(body.next()); });
  row("update, r.r", 96 * nodes, calls, [&] { body.add_step(); });
  row("25 iterations", kIterations * (product + 52 * in_brick + 180 * nodes), 1, [&] { body.solve(kIterations); });
  row("linearize", place + 576 + 256 + 8 + sums, calls, [&] { body.linearize_at(before); });
  row("flow", place + 24 + 2 * 704 + 1, calls, [&] { body.flow_to(before, after); });
  const auto memory = [&](const char* name, auto... bytes) {
    print_row(R"({"memory": "%s", "hexahedra": %d, "B/hexahedron": %g})", name, count, double((bytes + ...)) / count);
  };
  memory("layout", body.local.bytes(), body.sorted.bytes(), body.begin.bytes(), body.node.bytes(),
         body.partial_begin.bytes(), body.places.bytes());
  memory("vectors", 6 * body.p.bytes(), body.mass.bytes(), body.x.bytes(), body.partial.bytes());
  memory("coefficients", body.coef.bytes(), body.weight.bytes());
  memory("history", before.bytes());
  memory("rest", body.rest.bytes());
}
#endif

void run([[maybe_unused]] bool has_times) {
  constexpr Size kSmall{8, 8, 4};
#ifdef __CUDACC__
  cudaDeviceProp device;
  int clock = 0, width = 0;
  device::check(cudaGetDeviceProperties(&device, 0));
  device::check(cudaDeviceGetAttribute(&clock, cudaDevAttrMemoryClockRate, 0));
  device::check(cudaDeviceGetAttribute(&width, cudaDevAttrGlobalMemoryBusWidth, 0));
  device::check(cudaStreamCreate(&device::stream));
  print_row(R"({"device": "%s", "multiprocessors": %d, "GB/s": %g, "compiler": "nvcc %d.%d.%d"})", device.name,
            device.multiProcessorCount, 2.0 * clock * (width / 8) * 1e-6, __CUDACC_VER_MAJOR__, __CUDACC_VER_MINOR__,
            __CUDACC_VER_BUILD__);
  compare({16, 16, 8});
  compare_repeats(kSmall, 10);
  compare_repeats({32, 32, 20}, 10);
  if (!has_times) return;
  {
    const std::size_t gigabyte = std::size_t(1) << 30;
    Array<char> from(gigabyte), to(gigabyte);
    print_row(R"({"copy": "on the device", "GB/s": %g})",
              2e-3 * gigabyte / time_of(1, [&] { copy_on_device(to, from, gigabyte); }));
  }
  for (const Size& size : {Size{32, 32, 20}, Size{64, 40, 40}, Size{128, 100, 80}}) measure(size);
#else
  compare(kSmall);
  compare_repeats(kSmall, 2);
#endif
}

}  // namespace
}  // namespace hexaplast::one_number

int main(int argc, char** argv) { hexaplast::one_number::run(argc < 2 || std::string(argv[1]) != "--check"); }
