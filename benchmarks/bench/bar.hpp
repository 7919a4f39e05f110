// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/instrument_contact.hpp"
#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast::bench {

/// What the body of a measurement does.
enum class Mode {
  kElastic,      ///< no plasticity at all
  kPlasticIdle,  ///< every corner is checked, none yields
  kPlasticPart,  ///< a part at the clamped end yields in every step; the others are checked
  kPlastic       ///< every hexahedron yields in every step
};
std::string_view name(Mode mode);

struct BarSettings {
  int size = 1000;  ///< hexahedra asked for; see cells_for
  Mode mode = Mode::kElastic;
  Precision precision = Precision::kDouble;
  double poisson_ratio = 0.45;
  Settings element = {};    ///< its form; the precision is the one above
  bool is_pressed = false;  ///< gravity leans it on a plate along two thirds of it, with friction: about 1000 contacts
                            ///< of 10 thousand hexahedra
  double young_modulus = 5000;                   ///< [Pa]
  std::optional<std::array<int, 3>> cells = {};  ///< in place of those for `size`
};

inline constexpr double kBarLength = 0.2;      ///< [m]
inline constexpr double kBarDt = 0.01;         ///< [s]
inline constexpr double kYieldingPart = 0.05;  ///< of the hexahedra, where a part yields

/// Cells of a bar of about `size` cubes, its length 16 2^k of them: 8 x 8 x 16, 18 x 18 x 32, 40 x 40 x 64 for 1, 10
/// and 100 thousand.
std::array<int, 3> cells_for(int size);

/// The body that everything is measured on: a soft-tissue bar of .2 m (E = 5 kPa unless told, nu = .45, 1000 kg/m^3),
/// clamped at one end, under gravity across its length. Lumped masses, implicit Euler without damping.
class Bar final : public MechanicalSystem {
 public:
  explicit Bar(const BarSettings& settings);

  struct Step {
    double ms = 0;  ///< wall time of everything: forces, solve, plastic step
    SolveReport solve;
    FlowReport flow;
    int contacts = 0, slipping = 0;
  };
  Step step(LinearSolver& solver);

  /// The velocity increment [m/s] of the next step, which is not taken.
  PointArray increment(LinearSolver& solver);

  /// State hash: step count, positions, velocities, history.
  std::string hash() const;

  const Body& body() const { return body_; }
  Body& body() { return body_; }
  int num_elements() const { return body_.mesh().num_elements(); }
  const Eigen::VectorXd& masses() const { return masses_; }
  const std::vector<int>& fixed() const { return fixed_; }
  const PointArray& positions() const { return x_; }
  const PointArray& velocities() const { return v_; }

  /// [m/s^2] A tenth of the earth's: so soft a bar would collapse, and a collapsed one is no measure of speed.
  static Vec3 gravity() { return {1, 0, 0}; }

  int num_nodes() const override { return body_.mesh().num_nodes(); }
  void compute_force(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override;
  bool add_operator(const OperatorFactors& factors, MatrixFreeSystem& system) const override;
  bool release(double time, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
               Points product) override;
  void constrain(Constraints& constraints) const override;

 private:
  class Terms final : public NodalOperator {
   public:
    void add_product(double factor, ConstPoints p, Points Fp) const override {
      terms->add_stiffness_product(factor, p, Fp);
    }
    const ContactTerms* terms = nullptr;
  };

  Body body_;
  Eigen::VectorXd masses_;  // [kg]
  std::vector<int> fixed_;  // nodes
  PointArray x_, v_;
  std::optional<InstrumentContact> plate_;
  Pose plate_pose_;
  mutable Terms terms_;
  PointArray released_;
  long num_steps_ = 0;
  ImplicitEuler euler_{EulerSettings{}};
};

/// |a - b| / |b| in the norm of kinetic energy.
double relative_error(const Eigen::VectorXd& masses, const PointArray& a, const PointArray& b);

}  // namespace hexaplast::bench
