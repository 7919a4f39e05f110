// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/parallel.hpp"

#include "hexaplast/base/hash.hpp"
#include "support/compare.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

/// Sets the number of threads for one scope.
class Threads {
 public:
  explicit Threads(int count) : before_(num_threads()) { set_num_threads(count); }
  ~Threads() { set_num_threads(before_); }

 private:
  int before_;
};

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 7}) {
    const Threads scope(threads);
    std::vector<int> visits(1003, 0);
    parallel_for(1003, [&](int i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(1003, 1)) << threads << " threads";
  }
}

TEST(Dot, HasTheSameBitsForAnyThreadCount) {
  support::Random random(61);
  const PointArray a = random.field(5003, 1), b = random.field(5003, 1);
  const Threads one(1);
  const double expected = dot(a, b);
  EXPECT_NEAR(expected, a.cwiseProduct(b).sum(), 1e-11);
  for (const int threads : {2, 3, 4, 7}) {
    const Threads scope(threads);
    EXPECT_EQ(dot(a, b), expected) << threads << " threads";
  }
}

TEST(StateHash, IsXxh64) {
  StateHash empty;
  EXPECT_EQ(empty.text(), "ef46db3751d8e999");  // the published value of the empty input
  StateHash whole, parts;
  whole.add("hexaplast", 9);
  parts.add("hexa", 4);
  parts.add("plast", 5);
  EXPECT_EQ(whole.value(), parts.value());
  EXPECT_NE(whole.value(), empty.value());
}

}  // namespace
}  // namespace hexaplast
