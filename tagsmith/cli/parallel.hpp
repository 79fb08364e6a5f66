// SPDX-License-Identifier: Apache-2.0
// Many tasks at once, their results in order.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace tagsmith::detail {

// What is done with a finished task, e.g. printing its result.
using Delivery = std::function<void()>;

// Calls work(0) ... work(count - 1), up to `jobs` at once (0 = as many as cores the process may
// use), and each one's delivery one at a time in the order of the numbers, as soon as its turn
// comes. Only a few results wait at any time.
void run_in_order(std::size_t count, int jobs, const std::function<Delivery(std::size_t)>& work);

// The same, where deliver(i, result) receives what work(i) returned.
template <class Work, class Deliver>
void run_in_order(std::size_t count, int jobs, const Work& work, const Deliver& deliver) {
  run_in_order(count, jobs, [&](std::size_t i) -> Delivery {
    const auto result = std::make_shared<decltype(work(i))>(work(i));
    return [&deliver, i, result] { deliver(i, *result); };
  });
}

// A bar on standard error for work that has taken longer than a second; nothing when standard error
// is no terminal. The bar is wiped at the end of its scope.
class ProgressBar {
 public:
  // `what` is counted: "images".
  ProgressBar(std::string what, std::size_t total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // One more is done. `print` runs while the bar is hidden.
  void advance(const std::function<void()>& print);

 private:
  void wipe();
  void draw();

  std::string what_;
  std::size_t total_;
  std::size_t done_ = 0;
  double start_seconds_;
  bool on_terminal_;
  bool drawn_ = false;
};

// Works as run_in_order does below a bar that counts `what`, and is hidden during a delivery.
template <class Work, class Deliver>
void run_below_bar(std::string what, std::size_t count, int jobs, const Work& work,
                   const Deliver& deliver) {
  ProgressBar bar(std::move(what), count);
  run_in_order(count, jobs, work,
               [&](std::size_t i, auto& result) { bar.advance([&] { deliver(i, result); }); });
}

}  // namespace tagsmith::detail
