// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/parallel.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <thread>
#include <vector>

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

/// Adds 1 to each of `count` numbers in a parallel loop.
std::vector<int> visits(int count) {
  std::vector<int> visited(count, 0);
  parallel_for(count, [&](int i) { ++visited[i]; });
  return visited;
}

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 7, 40}) {
    const Threads scope(threads);
    for (const int count : {0, 1, 2, 6, 7, 1003, 100000})
      for (int again = 0; again < 20; ++again)
        ASSERT_EQ(visits(count), std::vector<int>(count, 1)) << threads << " threads, " << count;
  }
}

TEST(ParallelFor, ThrowsOnWhatIsThrownWithin) {
  for (const int threads : {1, 4}) {
    const Threads scope(threads);
    EXPECT_THROW(parallel_for(1000,
                              [](int i) {
                                if (i % 7 == 3) throw std::bad_alloc();
                              }),
                 std::bad_alloc);
    EXPECT_EQ(visits(1003), std::vector<int>(1003, 1)) << "the next loop is whole";
  }
}

// The threads of a loop are there for one caller at a time; the others do their loops by themselves.
TEST(ParallelFor, MayStandInAnotherAndInSeveralThreadsOfTheProgram) {
  const Threads scope(3);
  std::vector<int> sums(50, 0);
  parallel_for(50, [&](int i) {
    for (const int visit : visits(i)) sums[i] += visit;
  });
  for (int i = 0; i < 50; ++i) EXPECT_EQ(sums[i], i);

  std::atomic<int> wrong = 0;
  std::vector<std::thread> callers;
  for (int k = 0; k < 4; ++k)
    callers.emplace_back([&] {
      for (int again = 0; again < 200; ++again) wrong += visits(777) != std::vector<int>(777, 1);
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(wrong, 0);
}

// As Python's multiprocessing does; the threads of the first process are not in the second one.
TEST(ParallelFor, WorksInAProcessThatWasForked) {
  const Threads scope(3);
  ASSERT_EQ(visits(1003), std::vector<int>(1003, 1));
  const pid_t child = fork();
  if (child == 0) _exit(visits(1003) == std::vector<int>(1003, 1) ? 0 : 1);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(visits(1003), std::vector<int>(1003, 1));
}

TEST(ParallelFor, TakesAsManyThreadsAsThereMayBe) {
  const Threads scope(-3);
  EXPECT_EQ(num_threads(), 1);
  const Threads many(1'000'000'000);
  EXPECT_EQ(num_threads(), kMaxThreads);
}

/// Of this process, that run or are about to.
int num_running_threads() {
  int running = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream in(thread.path() / "stat");
    std::string stat;
    std::getline(in, stat);
    const std::size_t name_ends = stat.rfind(')');
    running += name_ends != std::string::npos && stat.substr(name_ends, 3) == ") R";
  }
  return running;
}

// Three that spun for ever would be found running however often one looks.
TEST(ParallelFor, ThreadsThatWaitSleep) {
  const Threads scope(4);
  visits(1003);
  while (num_running_threads() > 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
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
