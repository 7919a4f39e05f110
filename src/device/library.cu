// SPDX-License-Identifier: LGPL-2.1-or-later
// The library that a body on a device is computed by: with nvcc for CUDA, with a C++ compiler as emulation on the CPU.
#include "device/device_kernels.hpp"
#include "device/kernels.cuh"

namespace hexaplast::one_number {
namespace {

using device::Array;
using device::launch;

class Kernels final : public DeviceKernels {
 public:
#ifdef __CUDACC__
  Kernels() { device::check(cudaSetDevice(0)); }
#endif

  void set_bricks(const BrickArrays& of) override {
    arrays_ = {};  // before the new ones need the room
    before_ = {};
    after_ = {};
    num_bricks_ = of.num_bricks, num_nodes_ = of.num_nodes, length_ = of.length;
    const std::size_t bricks = of.num_bricks, lanes = bricks * kWidth, nodes = of.num_nodes;
    Arrays& a = arrays_;
    a.local = Array(of.local, lanes * kCorners);
    a.sorted = Array(of.sorted, lanes * kCorners);
    a.begin = Array(of.begin, bricks * (kNodes + 1));
    a.node = Array(of.node, bricks * kNodes);
    a.partial_begin = Array(of.partial_begin, nodes + 1);
    a.places = Array(of.partial, of.partial_begin[nodes]);
    a.present = Array(of.present, bricks);
    a.rest = Array(of.rest, lanes * kRestNumbers);
    a.coef = Array<uint4>(lanes * kWords);
    a.weight = Array<float>(lanes * 2);
    a.value = Array<float>(lanes);
    a.mean = Array<float>(lanes * 6);
    a.status = Array<std::uint8_t>(lanes);
    a.partial = Array<float4>(bricks * kNodes);
    a.x = Array<double4_32a>(nodes);
    for (Array<float4>* vector : {&a.force, &a.diagonal, &a.inverse, &a.others, &a.p, &a.Ap, &a.r, &a.solution})
      *vector = Array<float4>(nodes);
    a.block_sum = Array<double>(3 * (std::max(nodes, lanes) / kNodesOfBlock + 1));
    const Scalars none{};
    a.scalars = Array(&none, 1);
    for (History* history : {&before_, &after_}) *history = History(bricks);
  }
  void set_history(const double* numbers) override {
    before_.numbers.set(numbers);
    find_mean_plastic();
  }
  void get_history(double* numbers) override { before_.numbers.get(numbers); }

  void set_positions(const double* x) override { arrays_.x.set(x); }

  int linearize(float thin_from) override {
    const Arrays& a = arrays_;
    launch(one_number::linearize, blocks(), kBricksOfBlock * kWidth, layout(), a.rest, length_, a.x,
           before_.of(num_bricks_).G, a.mean, a.coef, a.weight, a.partial, thin_from, a.status);
    launch(gather, node_blocks(), kNodesOfBlock, layout(), a.partial, 1.0f, a.force);
    return sums(nullptr, a.status).first;
  }
  void get_force(float* f) override { arrays_.force.get(f); }
  void multiply(float factor, const float* dx, float* df) override {
    const Arrays& a = arrays_;
    a.p.set(dx);
    multiply_by({a.p, nullptr, nullptr, {}});
    launch(gather, node_blocks(), kNodesOfBlock, layout(), a.partial, factor, a.Ap);
    a.Ap.get(df);
  }
  Sums energy(float thin_from) override {
    const Arrays& a = arrays_;
    launch(one_number::energy, blocks(), kBricksOfBlock * kWidth, layout(), a.rest, a.x, before_.of(num_bricks_).G,
           a.mean, a.value, thin_from, a.status);
    return sums(a.value, a.status);
  }

  Sums flow(float dt, float least_det, bool is_true_stress) override {
    const Arrays& a = arrays_;
    const Plastic<double> before = before_.of(num_bricks_);
    launch(one_number::flow, blocks(), kBricksOfBlock * kWidth, layout(), a.rest,
           FlowRule{.dt = dt, .least_det = least_det, .is_true_stress = is_true_stress}, a.x,
           Plastic<const double>{before.G, before.tau, before.strain}, a.mean, after_.of(num_bricks_), a.status,
           a.value);
    return sums(a.value, a.status);
  }
  void get_left(std::uint8_t* is_left) override {
    arrays_.status.get(is_left);
    for (std::size_t e = 0; e < arrays_.status.size(); ++e) is_left[e] = (is_left[e] & kLeft) != 0;
  }
  void get_hexahedron(int place, double (&numbers)[kHistoryNumbers]) override {
    for_each_array(place, [&](int first, int count, double* at) {
      device::copy_rows(numbers + first, sizeof(double), before_.numbers + (at - after_.numbers), kLaneBytes, count);
    });
  }
  void set_hexahedron(int place, const double (&numbers)[kHistoryNumbers]) override {
    for_each_array(place, [&](int first, int count, double* at) {
      device::copy_rows(at, kLaneBytes, numbers + first, sizeof(double), count);
    });
  }
  void take_flow() override {
    std::swap(before_, after_);
    find_mean_plastic();
  }

  void set_system(float factor, const float* diagonal, const float* rest, bool is_scaled) override {
    const Arrays& a = arrays_;
    factor_ = factor;
    arrays_.diagonal.set(diagonal);
    arrays_.others.set(rest);
    if (is_scaled)
      launch(one_number::diagonal, blocks(), kBricksOfBlock * kWidth, layout(), a.coef, a.weight, a.partial);
    launch(invert, node_blocks(), kNodesOfBlock, layout(), is_scaled ? static_cast<float4*>(a.partial) : nullptr,
           factor, a.others, a.inverse);
  }
  Norms start(const float* r, const float* p) override {
    arrays_.r.set(r);
    for (const Array<float4>* vector : {&arrays_.p, &arrays_.Ap, &arrays_.solution})
      device::clear(*vector, vector->bytes());
    if (p) arrays_.p.set(p);
    return advance(0);
  }
  void set_direction(double beta, float* p) override {
    launch(one_number::set_direction, node_blocks(), kNodesOfBlock, num_nodes_, next(beta), arrays_.p);
    arrays_.p.get(p);
  }
  double product(bool has_direction, double beta, const float* others) override {
    const Arrays& a = arrays_;
    const Direction d = has_direction ? Direction{a.p, nullptr, nullptr, {}} : next(beta);
    if (others) arrays_.others.set(others);
    multiply_by(d);
    launch(sum_nodes, node_blocks(), kNodesOfBlock, layout(),
           NodalSystem{factor_, a.diagonal, a.inverse, others ? static_cast<float4*>(a.others) : nullptr}, a.partial, d,
           a.p, a.Ap, a.block_sum, a.scalars);
    return scalars().p_Ap;
  }
  Norms advance(double alpha) override {
    const Arrays& a = arrays_;
    launch(update, node_blocks(), kNodesOfBlock, num_nodes_, a.inverse, Factor{alpha, nullptr}, a.p, a.Ap, a.solution,
           a.r, a.block_sum, a.scalars);
    const Scalars now = scalars();
    return {now.rr, now.rz};
  }
  void get_solution(float* x) override { arrays_.solution.get(x); }
  void get_residual(float* r) override { arrays_.r.get(r); }

 private:
  struct Arrays {
    Array<std::uint8_t> local, sorted, status;
    Array<std::uint16_t> begin;
    Array<int> node, partial_begin, places;
    Array<std::uint32_t> present;
    Array<float> rest, weight, value, mean;
    Array<uint4> coef;
    Array<double4_32a> x;
    Array<float4> partial, force, diagonal, inverse, others, p, Ap, r, solution;
    Array<double> block_sum;
    Array<Scalars> scalars;
  };
  /// G, tau and strain, one behind the other.
  struct History {
    History() = default;
    explicit History(std::size_t bricks) : numbers(bricks * kWidth * kHistoryNumbers) {}
    Plastic<double> of(std::size_t bricks) const {
      double* const tau = numbers + bricks * kWidth * 72;
      return {numbers, tau, tau + bricks * kWidth * kCorners};
    }
    Array<double> numbers;
  };
  static constexpr std::size_t kLaneBytes = kWidth * sizeof(double);

  /// visit(first number, how many, where the first one is in the history after a step) for G, tau and strain.
  template <class Visit>
  void for_each_array(int place, const Visit& visit) const {
    const Plastic<double> all = after_.of(num_bricks_);
    const std::size_t brick = place / kWidth, lane = place % kWidth;
    visit(0, 72, all.G + brick * 72 * kWidth + lane);
    visit(72, kCorners, all.tau + brick * kCorners * kWidth + lane);
    visit(80, kCorners, all.strain + brick * kCorners * kWidth + lane);
  }
  void find_mean_plastic() {
    launch(find_mean, blocks(), kBricksOfBlock * kWidth, layout(), before_.of(num_bricks_).G, arrays_.mean);
  }

  int blocks() const { return (num_bricks_ + kBricksOfBlock - 1) / kBricksOfBlock; }
  int node_blocks() const { return (num_nodes_ + kNodesOfBlock - 1) / kNodesOfBlock; }
  Layout layout() const {
    const Arrays& a = arrays_;
    return {num_bricks_, num_nodes_, a.local, a.sorted, a.begin, a.node, a.partial_begin, a.places, a.present};
  }
  Direction next(double beta) const { return {arrays_.p, arrays_.r, arrays_.inverse, {beta, nullptr}}; }
  void multiply_by(const Direction& d) {
    const Arrays& a = arrays_;
    launch(one_number::multiply, blocks(), kBricksOfBlock * kWidth, layout(), a.coef, a.weight, d, a.partial);
  }
  Sums sums(const float* value, const std::uint8_t* status) {
    launch(sum_hexahedra, (num_bricks_ * kWidth + kNodesOfBlock - 1) / kNodesOfBlock, kNodesOfBlock, layout(), value,
           status, arrays_.block_sum, arrays_.scalars);
    const Scalars now = scalars();
    return {now.sum[0], static_cast<int>(now.sum[1]), static_cast<int>(now.sum[2])};
  }
  Scalars scalars() const {
    Scalars now;
    arrays_.scalars.get(&now);
    return now;
  }

  int num_bricks_ = 0, num_nodes_ = 0;
  float length_ = 1, factor_ = 1;
  Arrays arrays_;
  History before_, after_;
};

}  // namespace
}  // namespace hexaplast::one_number

extern "C" __attribute__((visibility("default"))) hexaplast::DeviceKernels* hexaplast_device_kernels(int version) {
  return version == hexaplast::kDeviceVersion ? new hexaplast::one_number::Kernels : nullptr;
}
