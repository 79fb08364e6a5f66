// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/interrupt_guard.hpp"

#include <array>
#include <fcntl.h>
#include <map>
#include <signal.h>
#include <thread>
#include <unistd.h>

namespace tagsmith::detail {
namespace {

struct CleanUps {
  std::mutex mutex;
  std::map<int, std::function<void()>> by_number;
  int last_number = 0;
};

// Never destroyed: the watching thread may look at it until the process is gone.
CleanUps& clean_ups() {
  static auto* const instance = new CleanUps;
  return *instance;
}

// A handler may do next to nothing; it hands the signal to the watching thread.
std::array<int, 2> signal_pipe{-1, -1};

extern "C" void pass_on(int signal) {
  const auto byte = static_cast<unsigned char>(signal);
  [[maybe_unused]] const auto written = ::write(signal_pipe[1], &byte, 1);
}

[[noreturn]] void end_by(int signal) {
  ::signal(signal, SIG_DFL);
  ::raise(signal);
  ::_exit(128 + signal);
}

void watch() {
  unsigned char signal = 0;
  while (::read(signal_pipe[0], &signal, 1) != 1) {
  }
  const std::lock_guard lock(clean_ups().mutex);
  for (const auto& [number, clean_up] : clean_ups().by_number) clean_up();
  end_by(signal);
}

// True when the thread runs and the handlers stand. Done once a process.
bool start_watching() {
  if (::pipe2(signal_pipe.data(), O_CLOEXEC) != 0) return false;
  std::thread(watch).detach();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction present {};
    ::sigaction(signal, nullptr, &present);
    if (present.sa_handler != SIG_DFL) continue;
    struct sigaction handler {};
    handler.sa_handler = pass_on;
    handler.sa_flags = SA_RESTART;
    ::sigaction(signal, &handler, nullptr);
  }
  return true;
}

}  // namespace

InterruptGuard::InterruptGuard(std::function<void()> clean_up) {
  static const bool watching = start_watching();
  if (!watching) return;
  const std::lock_guard lock(clean_ups().mutex);
  number_ = ++clean_ups().last_number;
  clean_ups().by_number.emplace(number_, std::move(clean_up));
}

InterruptGuard::~InterruptGuard() {
  if (number_ == 0) return;
  const std::lock_guard lock(clean_ups().mutex);
  clean_ups().by_number.erase(number_);
}

std::unique_lock<std::mutex> InterruptGuard::hold_off() {
  return std::unique_lock(clean_ups().mutex);
}

}  // namespace tagsmith::detail
