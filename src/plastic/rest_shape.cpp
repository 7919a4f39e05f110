// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/rest_shape.hpp"

#include "kinematics/polar.hpp"

namespace hexaplast {

Mat3 fit_rotation(const ElementPoints& from, const ElementPoints& to) { return polar(to.transpose() * from).R; }

}  // namespace hexaplast
