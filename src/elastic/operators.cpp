// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/elastic/operators.hpp"

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/kinematics/polar.hpp"
#include "hexaplast/material/corotated.hpp"

namespace hexaplast {

void update_rest_operators(const Model& model, const History& history, Linearization& at) {
  if (at.material_version == history.version) return;
  at.rest.resize(model.mesh.num_elements());
  parallel_for(model.mesh.num_elements(), [&](int e) {
    at.rest[e] = history.alive[e]
                     ? rest_operator(gather(history.material, model.mesh.hexahedra()[e]), model.settings.gradient)
                     : removed_operator();
  });
  at.material_version = history.version;
}

//   f_a = - sum_i V/8 P_i g~_ia,   P = R sigma(S)                                                             eq. 15
void linearize(const Model& model, const History& history, ConstPoints x, Linearization& at) {
  update_rest_operators(model, history, at);
  at.rotation.resize(model.mesh.num_elements());
  at.corner_force.resize(model.mesh.num_elements());

  parallel_for(model.mesh.num_elements(), [&](int e) {
    const RestOperator& rest = at.rest[e];
    std::array<Mat3, kCorners> tensors = deformation_gradients(rest, gather(x, model.mesh.hexahedra()[e]));
    for (int i = 0; i < kCorners; ++i) {
      const Polar F = polar(tensors[i]);
      at.rotation[e][i] = F.R;
      tensors[i] = F.R * stress(F.S, model.lame[e]);
    }
    at.corner_force[e] = -rest.volume / kCorners * gradient_transpose(rest, tensors);
  });
}

void add_force(const Model& model, const Linearization& at, Points f) { scatter(model.mesh, at.corner_force, f); }

//   df_a = - sum_i V/8 dP_i g~_ia,   dF~_i = sum_b dx_b (x) g~_ib                                             eq. 16
void add_stiffness_product(const Model& model, const Linearization& at, double factor, ConstPoints dx,
                           std::vector<ElementPoints>& corner, Points df) {
  parallel_for(model.mesh.num_elements(), [&](int e) {
    const RestOperator& rest = at.rest[e];
    std::array<Mat3, kCorners> tensors = deformation_gradients(rest, gather(dx, model.mesh.hexahedra()[e]));
    for (int i = 0; i < kCorners; ++i) tensors[i] = stress_increment(at.rotation[e][i], tensors[i], model.lame[e]);
    corner[e] = -factor * rest.volume / kCorners * gradient_transpose(rest, tensors);
  });
  scatter(model.mesh, corner, df);
}

//   K_ab = - sum_i V/8 [ mu (g_a . g_b) I + mu r_b r_a^T + lambda r_a r_b^T ],   r_a = R_i g~_ia              eq. 17
void add_stiffness_blocks(const Model& model, const Linearization& at, double factor, BlockMatrix& K) {
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const Lame& k = model.lame[e];
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const double weight = -factor * at.rest[e].volume / kCorners;

    std::array<ElementPoints, kCorners> gradient, turned;
    for (int i = 0; i < kCorners; ++i) {
      gradient[i] = sample_gradient(at.rest[e], i);
      turned[i] = gradient[i] * at.rotation[e][i].transpose();
    }
    for (int a = 0; a < kCorners; ++a) {
      for (int b = 0; b < kCorners; ++b) {
        Mat3 block = Mat3::Zero();
        for (int i = 0; i < kCorners; ++i) {
          const Eigen::RowVector3d ra = turned[i].row(a), rb = turned[i].row(b);
          block += k.mu * gradient[i].row(a).dot(gradient[i].row(b)) * Mat3::Identity() + k.mu * rb.transpose() * ra +
                   k.lambda * ra.transpose() * rb;
        }
        K.add(corners[a], corners[b], weight * block);
      }
    }
  }
}

double energy(const Model& model, const History& history, ConstPoints x) {
  double sum = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!history.alive[e]) continue;
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const RestOperator rest = rest_operator(gather(history.material, corners), model.settings.gradient);
    double density = 0;
    for (const Mat3& F : deformation_gradients(rest, gather(x, corners)))
      density += energy_density(polar(F).S, model.lame[e]);
    sum += rest.volume / kCorners * density;  // eq. 18
  }
  return sum;
}

}  // namespace hexaplast
