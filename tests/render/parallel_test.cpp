// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/parallel.hpp"

#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace tagsmith::detail {

TEST_CASE("results come in order, whatever is finished first") {
  for (const int jobs : {0, 1, 2, 7}) {
    CAPTURE(jobs);
    std::vector<std::size_t> delivered;
    run_in_order(40, jobs, [&](std::size_t i) -> Delivery {
      std::this_thread::sleep_for(std::chrono::microseconds(i % 3 == 0 ? 2000 : 10));
      return [&delivered, i] { delivered.push_back(i); };
    });
    std::vector<std::size_t> expected(40);
    std::iota(expected.begin(), expected.end(), std::size_t{0});
    CHECK(delivered == expected);
  }
}

TEST_CASE("no more is done at once than was asked") {
  for (const int jobs : {1, 3}) {
    std::atomic<int> running{0};
    std::atomic<int> most{0};
    run_in_order(30, jobs, [&](std::size_t) -> Delivery {
      const int now = ++running;
      int seen = most;
      while (now > seen && !most.compare_exchange_weak(seen, now)) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      --running;
      return [] {};
    });
    CHECK(most <= jobs);
  }
}

TEST_CASE("nothing to do is done at once") {
  run_in_order(0, 4, [](std::size_t) -> Delivery {
    FAIL("there is no piece of work");
    return [] {};
  });
}

}  // namespace tagsmith::detail
