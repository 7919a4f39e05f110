// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/base/parallel.hpp"

/// One thread unless a test asks for more: the meshes are small, and ctest runs the tests side by side.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  hexaplast::set_num_threads(1);
  return RUN_ALL_TESTS();
}
