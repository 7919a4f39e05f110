// SPDX-License-Identifier: LGPL-2.1-or-later
// What tests of bodies and of their parts begin with.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/moving_body.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "loaded_body.hpp"
#include "mesh/lumped_mass.hpp"
#include "mesh/trilinear.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/golden.hpp"
#include "support/materials.hpp"
#include "support/motion.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
using namespace support;  // NOLINT: of tests alone
}
