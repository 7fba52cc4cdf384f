#include "app/film/ordered_pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace obscura::app {
namespace {

Conduct<int, int> doubling(int jobs, std::vector<int>& results) {
  Conduct<int, int> parts;
  parts.produce = [n = 0, jobs]() mutable { return n < jobs ? std::optional(n++) : std::nullopt; };
  parts.hire = [] {
    return [](int job) {
      // later jobs are quicker, so that results come out of order
      std::this_thread::sleep_for(std::chrono::microseconds(job % 4 == 0 ? 2000 : 10));
      return 2 * job;
    };
  };
  parts.consume = [&results](int result) {
    results.push_back(result);
    return true;
  };
  return parts;
}

TEST(Conduct, ResultsComeInTheOrderOfTheJobsWhateverTheWorkers) {
  for (const int workers : {1, 2, 8}) {
    std::vector<int> results;
    conduct(doubling(50, results), workers);
    ASSERT_EQ(results.size(), 50u);
    for (int i = 0; i < 50; ++i) EXPECT_EQ(results[std::size_t(i)], 2 * i);
  }
}

TEST(Conduct, JobsUnderWayAreBoundedByTheWorkers) {
  std::vector<int> results;
  auto parts = doubling(200, results);
  int made = 0, most = 0;
  auto produce = parts.produce;
  parts.produce = [&] {
    most = std::max(most, ++made - int(results.size()));
    return produce();
  };
  conduct(parts, 3);
  EXPECT_LE(most, 3 + 2);
}

TEST(Conduct, TheFirstErrorInTheOrderOfTheJobsComesOut) {
  std::vector<int> results;
  auto parts = doubling(50, results);
  parts.hire = [] {
    return [](int job) {
      if (job == 20) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (job >= 20) throw std::runtime_error(std::to_string(job));
      return job;
    };
  };
  try {
    conduct(parts, 4);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "20");
  }
  EXPECT_EQ(results.size(), 20u);
}

TEST(Conduct, AWorkerThatCannotBeHiredIsAnError) {
  std::vector<int> results;
  auto parts = doubling(5, results);
  parts.hire = []() -> std::function<int(int)> { throw std::runtime_error("no context"); };
  EXPECT_THROW(conduct(parts, 2), std::runtime_error);
}

TEST(Conduct, AConsumerMayStop) {
  std::vector<int> results;
  auto parts = doubling(50, results);
  parts.consume = [&](int result) {
    results.push_back(result);
    return results.size() < 7;
  };
  conduct(parts, 2);
  EXPECT_EQ(results.size(), 7u);
}

}  // namespace
}  // namespace obscura::app
