// SPDX-License-Identifier: LGPL-2.1-or-later
// The library that a body on a device is computed by: with nvcc for CUDA, with a C++ compiler as emulation on the CPU.
#include "device/cycle.cuh"
#include "device/device_kernels.hpp"

namespace hexaplast::one_number {
namespace {

using device::Array;
using device::launch;

/// The arrays of a Layout.
struct LayoutOnDevice {
  LayoutOnDevice() = default;
  explicit LayoutOnDevice(const LayoutArrays& of)
      : num_bricks(of.num_bricks),
        num_nodes(of.num_nodes),
        local(of.local, lanes() * kCorners),
        sorted(of.sorted, lanes() * kCorners),
        begin(of.begin, static_cast<std::size_t>(num_bricks) * (kNodes + 1)),
        node(of.node, static_cast<std::size_t>(num_bricks) * kNodes),
        partial_begin(of.partial_begin, num_nodes + 1),
        places(of.partial, of.partial_begin[num_nodes]),
        present(of.present, num_bricks) {}

  std::size_t lanes() const { return static_cast<std::size_t>(num_bricks) * kWidth; }
  int blocks() const { return (num_bricks + kBricksOfBlock - 1) / kBricksOfBlock; }
  int node_blocks() const { return (num_nodes + kNodesOfBlock - 1) / kNodesOfBlock; }
  operator Layout() const {
    return {num_bricks, num_nodes, local, sorted, begin, node, partial_begin, places, present};
  }

  int num_bricks = 0, num_nodes = 0;
  Array<std::uint8_t> local, sorted;
  Array<std::uint16_t> begin;
  Array<int> node, partial_begin, places;
  Array<std::uint32_t> present;
};

struct MapOnDevice {
  MapOnDevice() = default;
  explicit MapOnDevice(const MapArrays& of)
      : num_rows(of.num_rows),
        first(of.first, num_rows + 1),
        column(of.column, of.first[num_rows]),
        weight(of.weight, of.first[num_rows]) {}
  operator Map() const { return {num_rows, first, column, weight}; }

  int num_rows = 0;
  Array<int> first, column;
  Array<float> weight;
};

/// A mesh of multigrid; the finest one has the vectors alone.
struct Level {
  explicit Level(int num_nodes) {
    for (Array<float4>* vector : {&x, &r, &d, &diagonal, &inverse, &follow}) *vector = Array<float4>(num_nodes);
  }
  explicit Level(const LevelArrays& of) : Level(of.at.num_nodes) {
    at = LayoutOnDevice(of.at);
    rest = Array(of.rest, at.lanes() * 9);
    moduli = Array(of.moduli, at.lanes() * 2 * kCorners);
    child = Array(of.child, at.lanes() * kCorners);
    fine_node = Array(of.fine_node, at.num_nodes);
    placement = MapOnDevice(of.placement);
    restriction = MapOnDevice(of.restriction);
    prolongation = MapOnDevice(of.prolongation);
    positions = Array<double4_32a>(at.num_nodes);
    coef = Array<uint4>(at.lanes() * kCellWords);
    mean = Array<float>(at.lanes() * 6);
    for (Array<float4>* sums : {&of_diagonal, &partial})
      *sums = Array<float4>(static_cast<std::size_t>(at.num_bricks) * kNodes);
  }

  Array<float4> x, r, d, diagonal, inverse, follow;
  std::vector<ChebyshevStep> smoother;

  LayoutOnDevice at;
  Array<float> rest, moduli, mean;
  Array<int> child, fine_node;
  MapOnDevice placement, restriction, prolongation;
  Array<double4_32a> positions;
  Array<uint4> coef;
  Array<float4> of_diagonal, partial;  ///< sums of the bricks: of the diagonal of L, of a product
};

class Kernels final : public DeviceKernels {
 public:
#ifdef __CUDACC__
  Kernels() { device::check(cudaSetDevice(0)); }
#endif

  void set_bricks(const BrickArrays& of) override {
    arrays_ = {};  // before the new ones need the room
    before_ = {};
    after_ = {};
    levels_.clear();
    num_blocks_ = num_terms_ = 0;
    length_ = of.length;
    Arrays& a = arrays_;
    a.at = LayoutOnDevice(of.at);
    const std::size_t bricks = of.at.num_bricks, lanes = a.at.lanes(), nodes = of.at.num_nodes;
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
           before_.of(arrays_.at.num_bricks).G, a.mean, a.coef, a.weight, a.partial, thin_from, a.status);
    launch(gather, node_blocks(), kNodesOfBlock, layout(), a.partial, 1.0f, a.force);
    linearize_levels();
    return sums(nullptr, a.status).first;
  }
  void get_force(float* f) override { arrays_.force.get(f); }
  void multiply(float factor, const float* dx, float* df) override {
    const Arrays& a = arrays_;
    a.p.set(dx);
    multiply_by({a.p, nullptr, nullptr, {}, {}});
    launch(gather, node_blocks(), kNodesOfBlock, layout(), a.partial, factor, a.Ap);
    a.Ap.get(df);
  }
  Sums energy(float thin_from) override {
    const Arrays& a = arrays_;
    launch(one_number::energy, blocks(), kBricksOfBlock * kWidth, layout(), a.rest, a.x,
           before_.of(arrays_.at.num_bricks).G, a.mean, a.value, thin_from, a.status);
    return sums(a.value, a.status);
  }

  Sums flow(float dt, float least_det, bool is_true_stress) override {
    const Arrays& a = arrays_;
    const Plastic<double> before = before_.of(arrays_.at.num_bricks);
    launch(one_number::flow, blocks(), kBricksOfBlock * kWidth, layout(), a.rest,
           FlowRule{.dt = dt, .least_det = least_det, .is_true_stress = is_true_stress}, a.x,
           Plastic<const double>{before.G, before.tau, before.strain}, a.mean, after_.of(arrays_.at.num_bricks),
           a.status, a.value);
    return sums(a.value, a.status);
  }
  void get_status(std::uint8_t* status) override { arrays_.status.get(status); }
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

  Stiffness set_system(float factor, const float* diagonal, const float* rest, bool is_scaled,
                       float break_even) override {
    const Arrays& a = arrays_;
    factor_ = factor;
    has_cycles_ = false;
    arrays_.diagonal.set(diagonal);
    arrays_.others.set(rest);
    num_blocks_ = num_terms_ = 0;
    if (is_scaled)
      launch(one_number::diagonal, blocks(), kBricksOfBlock * kWidth, layout(), a.coef, a.weight, a.partial);
    launch(invert, node_blocks(), kNodesOfBlock, layout(), is_scaled ? static_cast<float4*>(a.partial) : nullptr,
           factor, a.others, break_even, a.inverse, a.block_sum, a.scalars);
    const Scalars now = scalars();
    return {now.sum[0], now.sum[1], now.sum[2]};
  }

  /// From the sums that set_system left.
  void get_diagonal(const int* nodes, int count, float* diagonal) override {
    const Arrays& a = arrays_;
    listed_.assign(nodes, count);
    const Array<float4> found(count);
    launch(gather_diagonal, (count + kNodesOfBlock - 1) / kNodesOfBlock, kNodesOfBlock, layout(), a.partial, factor_,
           a.others, listed_, count, found);
    found.get(diagonal);
  }
  void set_blocks(const int* nodes, const BlockEntry* blocks, int count) override {
    num_blocks_ = count;
    blocks_.assign(blocks, count);
    number_nodes(nodes, count, block_of_node_);
  }
  void set_terms(int num_rows, const int* node, const int* first, const int* column, const double* blocks) override {
    num_terms_ = num_rows;
    term_first_.assign(first, num_rows + 1);
    term_column_.assign(column, first[num_rows]);
    term_block_.assign(blocks, 9 * static_cast<std::size_t>(first[num_rows]));
    of_terms_.reserve(num_rows);
    number_nodes(node, num_rows, term_of_node_);
  }

  void set_levels(const LevelArrays* levels, int count) override {
    levels_.clear();
    levels_.emplace_back(arrays_.at.num_nodes);
    levels_.front().of_diagonal = Array<float4>(arrays_.partial.size());
    for (int k = 0; k < count; ++k) {
      levels_.emplace_back(levels[k]);
      const std::size_t sums = 3 * static_cast<std::size_t>(levels_.back().at.node_blocks());
      if (sums > arrays_.block_sum.size()) arrays_.block_sum = Array<double>(sums);
    }
    linearize_levels();
  }
  void prepare_cycles(bool has_others) override {
    const Arrays& a = arrays_;
    Level& finest = levels_.front();
    has_blocks_in_cycles_ = has_others;
    if (!has_cycles_)
      launch(one_number::diagonal, blocks(), kBricksOfBlock * kWidth, layout(), a.coef, a.weight, finest.of_diagonal);
    has_cycles_ = true;
    launch(set_finest, node_blocks(), kNodesOfBlock, layout(), finest.of_diagonal, factor_, a.diagonal, a.others,
           has_others, has_others ? blocks_of_system() : Blocks{nullptr, nullptr}, finest.diagonal, finest.inverse,
           finest.follow);
    for (std::size_t k = 1; k < levels_.size(); ++k) {
      const Level &finer = levels_[k - 1], &level = levels_[k];
      launch(descend, level.at.node_blocks(), kNodesOfBlock, Layout(level.at), level.of_diagonal, factor_,
             Map(level.restriction), level.fine_node, nodes_of(finer),
             k == 1 ? static_cast<const float4*>(a.diagonal) : nullptr, level.diagonal, level.inverse, level.follow);
    }
  }
  double start_lanczos(int k, const float* first) override {
    const Level& level = levels_[k];
    for (const Array<float4>* vector : {&level.d, &level.r}) device::clear(*vector, vector->bytes());
    level.x.set(first);
    return advance_lanczos(k, 1, 0, 0);
  }
  double multiply_lanczos(int k, float scale) override {
    const Arrays& a = arrays_;
    multiply_level(k);
    launch(one_number::multiply_lanczos, node_blocks(k), kNodesOfBlock, layout(k), nodes_of(levels_[k]), partial(k),
           a.block_sum, a.scalars);
    return scale * static_cast<double>(scale) * scalars().sum[0];
  }
  double advance_lanczos(int k, float scale, float along, float before) override {
    launch(one_number::advance_lanczos, node_blocks(k), kNodesOfBlock, nodes_of(levels_[k]), scale, along, before,
           arrays_.block_sum, arrays_.scalars);
    return scalars().sum[0];
  }
  void set_smoother(int k, const ChebyshevStep* steps, int count) override {
    levels_[k].smoother.assign(steps, steps + count);
  }
  double precondition() override {
    const Arrays& a = arrays_;
    const Level& finest = levels_.front();
    device::copy_on_device(finest.r, a.r, a.r.bytes());
    device::clear(finest.x, finest.x.bytes());
    cycle(0);
    launch(finish, node_blocks(), kNodesOfBlock, nodes_of(finest), a.r, a.block_sum, a.scalars);
    return scalars().sum[0];
  }

  Norms start(const float* r, const float* p) override {
    arrays_.r.set(r);
    for (const Array<float4>* vector : {&arrays_.p, &arrays_.Ap, &arrays_.solution})
      device::clear(*vector, vector->bytes());
    if (p) arrays_.p.set(p);
    return advance(0);
  }
  void set_direction(double beta, float* p) override {
    launch(one_number::set_direction, node_blocks(), kNodesOfBlock, num_nodes(), next(beta), arrays_.p);
    arrays_.p.get(p);
  }
  double product(bool has_direction, double beta, const float* others) override {
    const Arrays& a = arrays_;
    const Direction d = has_direction ? Direction{a.p, nullptr, nullptr, {}, {}} : next(beta);
    if (others) arrays_.others.set(others);
    multiply_by(d);
    if (num_terms_ > 0)
      launch(multiply_terms, (num_terms_ + kNodesOfBlock - 1) / kNodesOfBlock, kNodesOfBlock,
             Terms{num_terms_, term_first_, term_column_, term_block_}, d, of_terms_);
    launch(sum_nodes, node_blocks(), kNodesOfBlock, layout(),
           NodalSystem{factor_, a.diagonal, a.inverse, others ? static_cast<float4*>(a.others) : nullptr,
                       num_terms_ > 0 ? static_cast<int*>(term_of_node_) : nullptr, of_terms_},
           a.partial, d, a.p, a.Ap, a.block_sum, a.scalars);
    return scalars().p_Ap;
  }
  Norms advance(double alpha) override {
    const Arrays& a = arrays_;
    launch(update, node_blocks(), kNodesOfBlock, num_nodes(), a.inverse, blocks_of_system(), Factor{alpha, nullptr},
           a.p, a.Ap, a.solution, a.r, a.block_sum, a.scalars);
    const Scalars now = scalars();
    return {now.rr, now.rz};
  }
  void get_solution(float* x) override { arrays_.solution.get(x); }
  void get_residual(float* r) override { arrays_.r.get(r); }

 private:
  struct Arrays {
    LayoutOnDevice at;
    Array<std::uint8_t> status;
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
    const Plastic<double> all = after_.of(arrays_.at.num_bricks);
    const std::size_t brick = place / kWidth, lane = place % kWidth;
    visit(0, 72, all.G + brick * 72 * kWidth + lane);
    visit(72, kCorners, all.tau + brick * kCorners * kWidth + lane);
    visit(80, kCorners, all.strain + brick * kCorners * kWidth + lane);
  }
  void find_mean_plastic() {
    launch(find_mean, blocks(), kBricksOfBlock * kWidth, layout(), before_.of(arrays_.at.num_bricks).G, arrays_.mean);
  }

  /// to: per node its number among those, or -1.
  void number_nodes(const int* nodes, int count, Array<int>& to) {
    listed_.assign(nodes, count);
    if (static_cast<int>(to.size()) != num_nodes()) to = Array<int>(num_nodes());
    device::fill(to, to.bytes());
    launch(one_number::number_nodes, (count + kNodesOfBlock - 1) / kNodesOfBlock, kNodesOfBlock, listed_, count, to);
  }
  /// What the cells of the coarse meshes are where the nodes are now.
  void linearize_levels() {
    for (std::size_t k = 1; k < levels_.size(); ++k) {
      const Level &finer = levels_[k - 1], &level = levels_[k];
      const LayoutOnDevice& at = level.at;
      launch(place_nodes, at.node_blocks(), kNodesOfBlock, Map(level.placement), k == 1 ? arrays_.x : finer.positions,
             level.positions);
      launch(linearize_cells, at.blocks(), kBricksOfBlock * kWidth, Layout(at), level.rest, level.moduli, level.child,
             length_, level.positions, k == 1 ? arrays_.mean : finer.mean, level.coef, level.mean);
      launch(diagonal_of_cells, at.blocks(), kBricksOfBlock * kWidth, Layout(at), level.coef, level.moduli,
             level.of_diagonal);
    }
  }
  /// partial = L d
  void multiply_level(std::size_t k) {
    const Level& level = levels_[k];
    if (k == 0) return multiply_by({level.d, nullptr, nullptr, {}, {}});
    launch(multiply_cells, level.at.blocks(), kBricksOfBlock * kWidth, Layout(level.at), level.coef, level.moduli,
           level.d, level.partial);
  }
  const float4* partial(std::size_t k) const { return k == 0 ? arrays_.partial : levels_[k].partial; }
  /// has_product: d has what r is still to be less A times.
  void smooth_level(std::size_t k, bool has_product, bool leaves_residual) {
    const Level& level = levels_[k];
    for (const ChebyshevStep& step : level.smoother) {
      if (has_product) multiply_level(k);
      launch(smooth, node_blocks(k), kNodesOfBlock, layout(k), nodes_of(level), has_product ? partial(k) : nullptr,
             step);
      has_product = true;
    }
    if (!leaves_residual) return;
    multiply_level(k);
    launch(subtract, node_blocks(k), kNodesOfBlock, layout(k), nodes_of(level), partial(k));
  }
  void cycle(std::size_t k) {
    if (k + 1 == levels_.size()) return smooth_level(k, false, false);
    const Level &level = levels_[k], &coarser = levels_[k + 1];
    smooth_level(k, false, true);
    launch(restrict_residual, node_blocks(k + 1), kNodesOfBlock, Map(coarser.restriction), nodes_of(level),
           nodes_of(coarser));
    cycle(k + 1);
    launch(prolong, node_blocks(k), kNodesOfBlock, Map(coarser.prolongation), coarser.x, nodes_of(level));
    smooth_level(k, true, false);
  }

  int num_nodes() const { return arrays_.at.num_nodes; }
  int blocks() const { return arrays_.at.blocks(); }
  const LayoutOnDevice& at(std::size_t k) const { return k == 0 ? arrays_.at : levels_[k].at; }
  int node_blocks(std::size_t k = 0) const { return at(k).node_blocks(); }
  Layout layout(std::size_t k = 0) const { return at(k); }
  Blocks blocks_of_system() const {
    return num_blocks_ > 0 ? Blocks{block_of_node_, blocks_} : Blocks{nullptr, nullptr};
  }
  LevelNodes nodes_of(const Level& level) const {
    const bool has_blocks = &level == &levels_.front() && has_blocks_in_cycles_;
    return {static_cast<int>(level.x.size()),
            factor_,
            level.diagonal,
            level.inverse,
            level.follow,
            has_blocks ? blocks_of_system() : Blocks{nullptr, nullptr},
            level.x,
            level.r,
            level.d};
  }
  /// z + beta p
  Direction next(double beta) const {
    const Arrays& a = arrays_;
    if (has_cycles_) return {a.p, levels_.front().x, nullptr, {}, {beta, nullptr}};
    return {a.p, a.r, a.inverse, blocks_of_system(), {beta, nullptr}};
  }
  void multiply_by(const Direction& d) {
    const Arrays& a = arrays_;
    launch(one_number::multiply, blocks(), kBricksOfBlock * kWidth, layout(), a.coef, a.weight, d, a.partial);
  }
  Sums sums(const float* value, const std::uint8_t* status) {
    const int count = static_cast<int>(arrays_.at.lanes());
    launch(sum_hexahedra, (count + kNodesOfBlock - 1) / kNodesOfBlock, kNodesOfBlock, layout(), value, status,
           arrays_.block_sum, arrays_.scalars);
    const Scalars now = scalars();
    return {now.sum[0], static_cast<int>(now.sum[1]), static_cast<int>(now.sum[2])};
  }
  Scalars scalars() const {
    Scalars now;
    arrays_.scalars.get(&now);
    return now;
  }

  float length_ = 1, factor_ = 1;
  Arrays arrays_;
  History before_, after_;
  std::vector<Level> levels_;  // from fine to coarse; empty until cycles are asked for
  bool has_cycles_ = false, has_blocks_in_cycles_ = false;
  int num_blocks_ = 0, num_terms_ = 0;  // of the present system
  Array<int> listed_, block_of_node_, term_of_node_, term_first_, term_column_;
  Array<BlockEntry> blocks_;
  Array<double> term_block_;
  Array<float4> of_terms_;
};

}  // namespace
}  // namespace hexaplast::one_number

extern "C" __attribute__((visibility("default"))) hexaplast::DeviceKernels* hexaplast_device_kernels(int version) {
  return version == hexaplast::kDeviceVersion ? new hexaplast::one_number::Kernels : nullptr;
}
