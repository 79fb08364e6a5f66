// SPDX-License-Identifier: Apache-2.0
// What must be tidied up when the process is told to end.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace tagsmith::detail {

// While it lives, SIGINT, SIGTERM and SIGHUP call `clean_up`, on a thread of its own, before they
// end the process as they would have without. Signals that the process ignores (nohup) stay
// ignored. Several may live at once.
class InterruptGuard {
 public:
  InterruptGuard() = default;  // guards nothing
  explicit InterruptGuard(std::function<void()> clean_up);
  ~InterruptGuard();
  InterruptGuard(InterruptGuard&& other) noexcept : number_(std::exchange(other.number_, 0)) {}
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  InterruptGuard& operator=(InterruptGuard&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  // While the lock is held no clean-up begins: for what must be done wholly or not at all.
  [[nodiscard]] static std::unique_lock<std::mutex> hold_off();

 private:
  int number_ = 0;  // 0 = guards nothing
};

}  // namespace tagsmith::detail
