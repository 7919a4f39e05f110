// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plain/pass.cpp"
#include "hwy/foreach_target.h"
//
#include <algorithm>
#include <cmath>

#include "element/lane_elements-inl.hpp"
#include "hexaplast/base/parallel.hpp"
#include "plain/flow-inl.hpp"
#include "plain/pass.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {
namespace plain = hexaplast::plain;

using V = Lanes<double>;

constexpr int num_groups(int num_elements) { return (num_elements + V::kCount - 1) / V::kCount; }

/// Elements that follow one another, one per lane.
struct Group {
  Group(const std::vector<Hexahedron>& hexahedra, int index) : hexahedra_(hexahedra) {
    const int last = static_cast<int>(hexahedra.size()) - 1;
    for (int lane = 0; lane < V::kCount; ++lane) element[lane] = std::min(index * V::kCount + lane, last);
  }

  /// A bit per lane whose element counts.
  std::uint32_t lanes_of(const std::vector<unsigned char>& counts, int index) const {
    std::uint32_t lanes = 0;
    for (int lane = 0; lane < V::kCount && index * V::kCount + lane < static_cast<int>(hexahedra_.size()); ++lane)
      if (counts[element[lane]]) lanes |= 1u << lane;
    return lanes;
  }

  HEXAPLAST_INLINE CornerLanes<V> corners(const plain::CornerField& of) const {
    CornerLanes<V> at;
    if (of.alike) {
      for (int a = 0; a < kCorners; ++a)
        for (int k = 0; k < 3; ++k) at.at[a][k] = V((*of.alike)(a, k));
      return at;
    }
    const double* from[V::kCount];
    for (int a = 0; a < kCorners; ++a) {
      for (int lane = 0; lane < V::kCount; ++lane)
        from[lane] = of.nodal + 3 * static_cast<std::ptrdiff_t>(hexahedra_[element[lane]][a]);
      for (int k = 0; k < 3; ++k) {
        alignas(64) double numbers[V::kCount];
        for (int lane = 0; lane < V::kCount; ++lane) numbers[lane] = from[lane][k];
        at.at[a][k] = load(numbers);
      }
    }
    return at;
  }

  /// of(element), a number.
  template <class Of>
  HEXAPLAST_INLINE V number(const Of& of) const {
    return gather_numbers(element, of);
  }
  /// of(element), kCount numbers.
  template <int kCount, class Of>
  HEXAPLAST_INLINE void numbers(const Of& of, V* to) const {
    load_elements<kCount>(addresses<const double>(element, [&](int e) { return of(e).data(); }), to);
  }
  template <int kCount, class Of>
  HEXAPLAST_INLINE void store_numbers(const V* from, std::uint32_t lanes, const Of& of) const {
    store_elements<kCount>(from, lanes, addresses<double>(element, [&](int e) { return of(e).data(); }));
  }
  /// of(element), eight rows.
  template <class Of>
  HEXAPLAST_INLINE CornerLanes<V> points(const Of& of) const {
    V n[3 * kCorners];
    numbers<3 * kCorners>(of, n);
    CornerLanes<V> at;
    for (int k = 0; k < 3 * kCorners; ++k) at.at[k % kCorners][k / kCorners] = n[k];
    return at;
  }
  template <class Of>
  HEXAPLAST_INLINE void store_points(const CornerLanes<V>& at, std::uint32_t lanes, const Of& of) const {
    V n[3 * kCorners];
    for (int k = 0; k < 3 * kCorners; ++k) n[k] = at.at[k % kCorners][k / kCorners];
    store_numbers<3 * kCorners>(n, lanes, of);
  }
  /// of(element), a matrix.
  template <class Of>
  HEXAPLAST_INLINE Mat<V> matrix(const Of& of) const {
    V n[9];
    numbers<9>(of, n);
    return {{{n[0], n[3], n[6]}, {n[1], n[4], n[7]}, {n[2], n[5], n[8]}}};
  }
  template <class Of>
  HEXAPLAST_INLINE void store_matrix(const Mat<V>& A, std::uint32_t lanes, const Of& of) const {
    const V n[9] = {A(0, 0), A(1, 0), A(2, 0), A(0, 1), A(1, 1), A(2, 1), A(0, 2), A(1, 2), A(2, 2)};
    store_numbers<9>(n, lanes, of);
  }

  int element[V::kCount];

 private:
  const std::vector<Hexahedron>& hexahedra_;
};

/// The elements of a group at current positions; those that are not there are cubes.
HEXAPLAST_NOINLINE void place(const Model& model, const History& history, ConstPoints x, const Branches& branches,
                              const Group& group, std::uint32_t present, CornerLanes<V>& rest, CornerLanes<V>& current,
                              Element<V>& element) {
  rest = group.corners(history.plastic_rest_positions);
  current = group.corners(x);
  replace_absent(present, rest);
  replace_absent(present, current);
  ElementState<V> state;
  Mat<V> G[kCorners];
  if (!history.plastic_inverse.empty()) {
    for (int i = 0; i < kCorners; ++i)
      G[i] = group.matrix([&](int e) -> const Mat3& { return history.plastic_inverse[e][i]; });
    state.plastic_inverse = G;
  }
  const V mu = group.number([&](int e) { return model.lame[e].mu; }),
          lambda = group.number([&](int e) { return model.lame[e].lambda; });
  BranchLanes<V> of_branches;
  state.branches = load_branches(group.element, branches, mu, lambda, of_branches);
  element.set(rest, current, mu, lambda, model.settings, state);
}

void find_energies(const Model& model, const History& history, ConstPoints x, const Branches& branches,
                   std::vector<double>& energies) {
  const std::vector<Hexahedron>& hexahedra = model.mesh.hexahedra();
  energies.assign(hexahedra.size(), 0);
  parallel_for(num_groups(model.mesh.num_elements()), [&](int index) {
    const Group group(hexahedra, index);
    const std::uint32_t present = group.lanes_of(history.alive, index);
    if (present == 0) return;
    CornerLanes<V> rest, current;
    Element<V> element;
    place(model, history, x, branches, group, present, rest, current, element);
    alignas(64) double numbers[V::kCount];
    store(element.energy(), numbers);
    for (int lane = 0; lane < V::kCount; ++lane)
      if (present >> lane & 1) energies[group.element[lane]] = numbers[lane];
  });
}

class PlacedElements final : public plain::PlacedElements {
 public:
  void place(const Model& model, const History& history, ConstPoints x, const Branches& branches) override {
    const int count = num_groups(model.mesh.num_elements());
    elements_.resize(count);
    present_.resize(count);
    parallel_for(count, [&](int index) {
      const Group group(model.mesh.hexahedra(), index);
      present_[index] = group.lanes_of(history.alive, index);
      CornerLanes<V> rest, current;
      if (present_[index] != 0)
        HWY_NAMESPACE::place(model, history, x, branches, group, present_[index], rest, current, elements_[index]);
    });
  }

  void find_forces(const HexMesh& mesh, std::vector<ElementPoints>& forces) const override {
    for_each(mesh, forces, [](const Group&, const Element<V>& element) { return element.force(); });
  }
  void find_force_increments(const HexMesh& mesh, const plain::CornerField& dx,
                             std::vector<ElementPoints>& increments) const override {
    for_each(mesh, increments,
             [&](const Group& group, const Element<V>& element) { return element.force_increment(group.corners(dx)); });
  }

 private:
  template <class Find>
  void for_each(const HexMesh& mesh, std::vector<ElementPoints>& found, const Find& find) const {
    parallel_for(static_cast<int>(elements_.size()), [&](int index) {
      if (present_[index] == 0) return;
      const Group group(mesh.hexahedra(), index);
      group.store_points(find(group, elements_[index]), present_[index],
                         [&](int e) -> ElementPoints& { return found[e]; });
    });
  }

  AlignedVector<Element<V>> elements_;  // per group
  std::vector<std::uint32_t> present_;
};

std::unique_ptr<plain::PlacedElements> make_placed_elements() { return std::make_unique<PlacedElements>(); }

// ---- plastic flow

/// What the elements of a group have been and are.
HEXAPLAST_NOINLINE void load_history(const Model& model, const History& history, const Group& group,
                                     JoinedHistory<V>& to) {
  const std::size_t maps = model.maps_per_element();
  to.rest_shape = group.points([&](int e) -> const ElementPoints& { return history.rest_shape[e]; });
  group.numbers<kCorners>([&](int e) -> const CornerValues& { return history.yield_stress[e]; }, to.yield_stress);
  group.numbers<kCorners>([&](int e) -> const CornerValues& { return history.plastic_strain[e]; }, to.plastic_strain);
  if (model.can_rotate)
    group.numbers<kCorners>([&](int e) -> const CornerValues& { return history.rotation_yield[e]; }, to.rotation_yield);
  for (int i = 0; i < kCorners; ++i) {
    const std::size_t map = maps == 1 ? 0 : i;
    to.rotation_map[i] = group.matrix([&](int e) -> const Mat3& { return history.rotation_map[e * maps + map]; });
    if (model.tracks_plastic_stretch)
      to.plastic_stretch[i] = group.matrix([&](int e) -> const Mat3& { return history.plastic_stretch[e][i]; });
  }
}
HEXAPLAST_NOINLINE void store_history(const Model& model, const JoinedHistory<V>& from, const Group& group,
                                      std::uint32_t lanes, History& history) {
  group.store_points(from.rest_shape, lanes, [&](int e) -> ElementPoints& { return history.rest_shape[e]; });
  group.store_numbers<kCorners>(from.yield_stress, lanes,
                                [&](int e) -> CornerValues& { return history.yield_stress[e]; });
  group.store_numbers<kCorners>(from.plastic_strain, lanes,
                                [&](int e) -> CornerValues& { return history.plastic_strain[e]; });
  if (model.can_rotate)
    group.store_numbers<kCorners>(from.rotation_yield, lanes,
                                  [&](int e) -> CornerValues& { return history.rotation_yield[e]; });
  for (int i = 0; i < kCorners; ++i) {
    if (model.maps_per_element() > 1)
      group.store_matrix(from.rotation_map[i], lanes,
                         [&](int e) -> Mat3& { return history.rotation_map[e * std::size_t{kCorners} + i]; });
    if (model.tracks_plastic_stretch)
      group.store_matrix(from.plastic_stretch[i], lanes, [&](int e) -> Mat3& { return history.plastic_stretch[e][i]; });
  }
}

HEXAPLAST_NOINLINE InitialElement<V> load_initial(const Model& model, const Group& group) {
  InitialElement<V> initial;
  initial.shape = group.corners(model.mesh.positions());
  for (int k = 0; k < 3; ++k) {
    V mean(0.0);
    for (int a = 0; a < kCorners; ++a) mean += V(1.0 / kCorners) * initial.shape.at[a][k];
    for (int a = 0; a < kCorners; ++a) initial.shape.at[a][k] -= mean;
  }
  EdgeLanes<V> e;
  edges(initial.shape, e);
  for (int i = 0; i < kCorners; ++i) initial.jacobian[i] = V(0.125) * determinant(edges_at(e, i));
  initial.volume = group.number([&](int element) { return model.volume[element]; });
  return initial;
}

/// Of the elements of a group. Returns those, a bit each, that are beyond what lanes can do.
HEXAPLAST_NOINLINE std::uint32_t flow_group(const Model& model, ConstPoints x, double dt,
                                            const std::vector<Mat3>& frames, const History& before, const Group& group,
                                            std::uint32_t present, History& next,
                                            std::vector<plain::ElementOutcome>& outcomes) {
  CornerLanes<V> rest, current;
  Element<V> element;
  place(model, before, x, {}, group, present, rest, current, element);
  JoinedHistory<V> history;
  load_history(model, before, group, history);
  Mat<V> frame;
  if (frames.empty()) {
    set_zero(frame);
    for (int k = 0; k < 3; ++k) frame(k, k) = V(1.0);
  } else {
    frame = group.matrix([&](int e) -> const Mat3& { return frames[e]; });
  }
  const auto per_step = [&](const auto& rate) {
    return group.number([&](int e) { return dt * rate(model.material(e)); });
  };
  const FlowRule<V> rule{.rate_dt = per_step([](const Material& m) { return can_stretch(m) ? m.flow_rate : 0.0; }),
                         .rotation_rate_dt = per_step([](const Material& m) { return m.rotation_flow_rate; }),
                         .hardening = group.number([&](int e) { return model.material(e).hardening; }),
                         .stretches = model.can_stretch,
                         .rotates = model.can_rotate,
                         .dt = dt};
  JoinedFlow<V> flow;
  flow_element(element, rest, current, load_initial(model, group), model.settings, model.tracks_plastic_stretch, rule,
               frame, history, flow);
  const std::uint32_t done = present & ~flow.fails;
  store_history(model, history, group, done, next);
  alignas(64) double dissipated[V::kCount], volume_ratio[V::kCount];
  store(flow.dissipated, dissipated);
  store(flow.volume_ratio, volume_ratio);
  for (int lane = 0; lane < V::kCount; ++lane)
    if (done >> lane & 1)
      outcomes[group.element[lane]] = {.yielded = (flow.yielded >> lane & 1) != 0,
                                       .inverted = (flow.inverted >> lane & 1) != 0,
                                       .skipped = (flow.skipped >> lane & 1) != 0,
                                       .repaired = (flow.repaired >> lane & 1) != 0,
                                       .volume_error = std::abs(volume_ratio[lane] - 1),
                                       .dissipated = dissipated[lane]};
  return present & flow.fails;
}

void flow_elements(const Model& model, ConstPoints x, double dt, const std::vector<Mat3>& frames, const History& before,
                   History& next, std::vector<plain::ElementOutcome>& outcomes) {
  outcomes.assign(model.mesh.num_elements(), {});
  parallel_for(num_groups(model.mesh.num_elements()), [&](int index) {
    const Group group(model.mesh.hexahedra(), index);
    const std::uint32_t present = group.lanes_of(before.alive, index);
    if (present == 0) return;
    const std::uint32_t left = flow_group(model, x, dt, frames, before, group, present, next, outcomes);
    for (int lane = 0; lane < V::kCount; ++lane)
      if (left >> lane & 1) {
        const int e = group.element[lane];
        outcomes[e] = plain::flow_alone(model, x, dt, frames.empty() ? nullptr : &frames[e], before, e, next);
      }
  });
}

// ---- averaging

template <class N>
HEXAPLAST_INLINE void take_mean_out(CornerLanes<N>& u) {
  for (int k = 0; k < 3; ++k) {
    N mean = u.at[0][k];
    for (int a = 1; a < kCorners; ++a) mean += u.at[a][k];
    mean *= N(1.0 / kCorners);
    for (int a = 0; a < kCorners; ++a) u.at[a][k] -= mean;
  }
}

class AveragedElements final : public plain::AveragedElements {
 public:
  Misfit fit(const Model& model, const std::vector<unsigned char>& counts, History& history,
             std::vector<ElementPoints>* gradients) override {
    hexahedra_ = &model.mesh.hexahedra();
    const int count = num_groups(model.mesh.num_elements());
    const std::size_t maps = model.maps_per_element();
    operators_.resize(count);
    misfits_.assign(count, {});
    parallel_for(count, [&](int index) {
      const Group group(*hexahedra_, index);
      Operator& op = operators_[index];
      op.counts = group.lanes_of(counts, index);
      if (op.counts == 0) return;
      CornerLanes<V> x = group.corners(history.plastic_rest_positions), t;
      replace_absent(op.counts, x);
      take_mean_out(x);
      const CornerLanes<V> y = group.points([&](int e) -> const ElementPoints& { return history.rest_shape[e]; });
      Mat<V> Pi;
      if (maps == 1) {
        Pi = safe_polar(outer_sum(x, y)).R;
        group.store_matrix(Pi, op.counts, [&](int e) -> Mat3& { return history.rotation_map[e]; });
      }
      for (int i = 0; i < kCorners; ++i) {
        if (maps > 1) Pi = group.matrix([&](int e) -> const Mat3& { return history.rotation_map[e * maps + i]; });
        for (int k = 0; k < 3; ++k) t.at[i][k] = dot(Pi.m[k], y.at[i]);
      }
      take_mean_out(t);
      CornerLanes<V> gradient;
      V E(0.0), size(0.0);
      for (int i = 0; i < kCorners; ++i)
        for (int k = 0; k < 3; ++k) {
          gradient.at[i][k] = x.at[i][k] - t.at[i][k];
          E += gradient.at[i][k] * gradient.at[i][k];
          size += t.at[i][k] * t.at[i][k];
        }
      const auto sum = [&](V numbers) {
        return hn::GetLane(hn::SumOfLanes(V::Tag(), select_bits(op.counts, numbers, V(0.0)).raw()));
      };
      misfits_[index] = {.E = sum(E), .size = sum(size)};
      if (!gradients) return;
      group.store_points(gradient, op.counts, [&](int e) -> ElementPoints& { return (*gradients)[e]; });
      op.arms = model.turns_isolated_shapes ? t : x;
      // B^T B; the floor keeps the free turn of a shape out that is flattened to a line
      const Mat<V> spread = outer_sum(op.arms, op.arms);
      const V trace = V(1 + 1e-14) * (spread(0, 0) + spread(1, 1) + spread(2, 2));
      Mat<V> inertia = HWY_NAMESPACE::scaled(V(-1.0), spread);
      for (int k = 0; k < 3; ++k) inertia(k, k) += trace;
      V det;
      op.inverse_inertia = reciprocal(inertia, det);  // of a symmetric matrix: its inverse
    });
    Misfit all;
    for (const Misfit& one : misfits_) all.E += one.E, all.size += one.size;
    return all;
  }

  void find_products(const plain::CornerField& field, bool projects,
                     std::vector<ElementPoints>& products) const override {
    parallel_for(static_cast<int>(operators_.size()), [&](int index) {
      const Operator& op = operators_[index];
      if (op.counts == 0) return;
      const Group group(*hexahedra_, index);
      CornerLanes<V> u = group.corners(field);
      take_mean_out(u);  // P u
      if (projects) {
        V moment[3] = {V(0.0), V(0.0), V(0.0)};  // B^T u
        for (int i = 0; i < kCorners; ++i) add_cross(V(1.0), op.arms.at[i], u.at[i], moment);
        V turn[3];
        for (int k = 0; k < 3; ++k) turn[k] = dot(op.inverse_inertia.m[k], moment);
        for (int i = 0; i < kCorners; ++i) {
          for (int k = 0; k < 3; ++k) u.at[i][k] *= V(1 + plain::kRegularisation);
          add_cross(V(-1.0), turn, op.arms.at[i], u.at[i]);
        }
      }
      group.store_points(u, op.counts, [&](int e) -> ElementPoints& { return products[e]; });
    });
  }

 private:
  struct Operator {
    CornerLanes<V> arms;     // [m]
    Mat<V> inverse_inertia;  // [1/m^2] (B^T B)^-1
    std::uint32_t counts = 0;
  };

  const std::vector<Hexahedron>* hexahedra_ = nullptr;
  AlignedVector<Operator> operators_;  // per group
  std::vector<Misfit> misfits_;
};

std::unique_ptr<plain::AveragedElements> make_averaged_elements() { return std::make_unique<AveragedElements>(); }

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast::plain {

HWY_EXPORT(find_energies);
void find_energies(const Model& model, const History& history, ConstPoints x, const Branches& branches,
                   std::vector<double>& energies) {
  HWY_DYNAMIC_DISPATCH(find_energies)(model, history, x, branches, energies);
}

HWY_EXPORT(make_placed_elements);
std::unique_ptr<PlacedElements> make_placed_elements() { return HWY_DYNAMIC_DISPATCH(make_placed_elements)(); }

HWY_EXPORT(flow_elements);
void flow_elements(const Model& model, ConstPoints x, double dt, const std::vector<Mat3>& frames, const History& before,
                   History& next, std::vector<ElementOutcome>& outcomes) {
  HWY_DYNAMIC_DISPATCH(flow_elements)(model, x, dt, frames, before, next, outcomes);
}

HWY_EXPORT(make_averaged_elements);
std::unique_ptr<AveragedElements> make_averaged_elements() { return HWY_DYNAMIC_DISPATCH(make_averaged_elements)(); }

}  // namespace hexaplast::plain
#endif
