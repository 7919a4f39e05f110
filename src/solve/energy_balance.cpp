// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/energy_balance.hpp"

namespace hexaplast {

double EnergyBalance::error() const {
  return initial + load_work + support_work + recovery_work + change_work - damping_loss - numerical_loss - flow_loss -
         kinetic - elastic;  // eq. 48
}

EnergyBalance& EnergyBalance::operator+=(const EnergyBalance& other) {
  kinetic += other.kinetic;
  elastic += other.elastic;
  initial += other.initial;
  load_work += other.load_work;
  support_work += other.support_work;
  damping_loss += other.damping_loss;
  numerical_loss += other.numerical_loss;
  recovery_work += other.recovery_work;
  change_work += other.change_work;
  flow_loss += other.flow_loss;
  return *this;
}

void EnergyBalance::begin(double kinetic_now, double elastic_now) {
  *this = {.kinetic = kinetic_now, .elastic = elastic_now, .initial = kinetic_now + elastic_now};
}

void EnergyBalance::add_step(const StepEnergy& step, double kinetic_now, double elastic_now, double recovery) {
  load_work += step.load_work;
  support_work += step.support_work;
  damping_loss += step.damping_loss;
  numerical_loss += step.numerical_loss;
  recovery_work += recovery;
  kinetic = kinetic_now;
  elastic = elastic_now;
}

void EnergyBalance::add_motion_of_supports(double kinetic_now, double elastic_now) {
  support_work += kinetic_now - kinetic + elastic_now - elastic;
  kinetic = kinetic_now;
  elastic = elastic_now;
}

void EnergyBalance::add_flow(double elastic_now) {
  flow_loss += elastic - elastic_now;
  elastic = elastic_now;
}

void EnergyBalance::add_change(double elastic_now) {
  change_work += elastic_now - elastic;
  elastic = elastic_now;
}

}  // namespace hexaplast
