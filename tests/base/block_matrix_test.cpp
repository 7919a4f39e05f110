// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/block_matrix.hpp"

#include "hexaplast/base/error.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

using support::refuses;

using support::dense;

TEST(BlockMatrix, AddsBlocksAndKeepsColumnsAscending) {
  support::Random random(62);
  const Mat3 A = random.matrix(1), B = random.matrix(1), C = random.matrix(1);
  BlockMatrix M(3);
  M.add(1, 2, A);
  M.add(1, 0, B);
  M.add(1, 2, C);
  ASSERT_EQ(M.row(1).size(), 2u);
  EXPECT_EQ(M.row(1)[0].column, 0);
  EXPECT_EQ(M.row(1)[0].block, B);
  EXPECT_EQ(M.row(1)[1].block, A + C);
}

TEST(BlockMatrix, DropsWhatTheLatestAssemblyDidNotTouch) {
  support::Random random(63);
  const Mat3 A = random.matrix(1), B = random.matrix(1);
  BlockMatrix M(3);
  for (const int column : {0, 1, 2}) M.add(1, column, A);
  M.add(0, 0, A);
  const long version = M.pattern_version();
  M.drop_unused();
  EXPECT_EQ(M.pattern_version(), version) << "all of it is used";

  M.clear();
  M.add(1, 2, B);
  EXPECT_EQ(M.pattern_version(), version);
  M.add(2, 1, Mat3::Zero());  // nothing, but added
  M.add(1, 0, B);
  M.drop_unused();
  EXPECT_GT(M.pattern_version(), version + 1);
  EXPECT_TRUE(M.row(0).empty());
  ASSERT_EQ(M.row(1).size(), 2u);
  EXPECT_EQ(M.row(1)[0].column, 0);
  EXPECT_EQ(M.row(1)[1].column, 2);
  EXPECT_EQ(M.row(1)[1].block, B);
  EXPECT_EQ(M.row(2).size(), 1u);

  M.leave_out();
  M.clear();
  EXPECT_FALSE(M.leaves_out());
  M.pin(1, 1);
  M.drop_unused();
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(9, 9);
  expected(4, 4) = 1;
  EXPECT_EQ(dense(M), expected);
  EXPECT_EQ(M.row(1).size(), 1u);
}

TEST(BlockMatrix, PinsOneDegreeOfFreedom) {
  BlockMatrix M(2);
  for (const int row : {0, 1}) {
    for (const int column : {0, 1}) M.add(row, column, Mat3::Ones());
  }
  Eigen::MatrixXd expected = dense(M);
  M.pin(1, 2);
  expected.row(5).setZero();
  expected.col(5).setZero();
  expected(5, 5) = 1;
  EXPECT_EQ(dense(M), expected);
}

TEST(BlockMatrix, RefusesNodesThatItDoesNotHave) {
  BlockMatrix M(3);
  EXPECT_TRUE(refuses<InputError>([&] { M.set_range(2, 2); }, {"nodes [2, 4)", "[0, 3)"}));
  M.set_range(1, 2);
  EXPECT_TRUE(refuses<InputError>([&] { M.add(2, 0, Mat3::Ones()); }, {"node 2", "[0, 2)"}));
  EXPECT_TRUE(refuses<InputError>([&] { M.add(0, -1, Mat3::Ones()); }, {"node -1", "[0, 2)"}));
  EXPECT_TRUE(refuses<InputError>([&] { M.pin(2, 0); }, {"node 2", "[0, 2)"}));
  EXPECT_TRUE(refuses<InputError>([&] { M.pin(0, 3); }, {"axis 3"}));
  EXPECT_TRUE(refuses<InputError>([&] { M.row(3); }, {"node 3", "[0, 3)"}));
}

}  // namespace
}  // namespace hexaplast
