// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/parallel.hpp"

#include <chrono>
#include <cstdio>
#include <unistd.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>

#include "tagsmith/cli/console.hpp"

namespace tagsmith::detail {
namespace {

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void run_in_order(std::size_t count, int jobs, const std::function<Delivery(std::size_t)>& work) {
  namespace tbb = oneapi::tbb;
  const int cores = tbb::info::default_concurrency();
  const auto threads = static_cast<std::size_t>(jobs > 0 ? jobs : cores);
  // Also limits the threads that the libraries below start; more threads than cores only on
  // request.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  std::size_t next = 0;
  tbb::parallel_pipeline(
      2 * threads,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                          [&](tbb::flow_control& control) {
                                            if (next == count) control.stop();
                                            return next == count ? next : next++;
                                          }) &
          tbb::make_filter<std::size_t, Delivery>(tbb::filter_mode::parallel, work) &
          tbb::make_filter<Delivery, void>(tbb::filter_mode::serial_in_order,
                                           [](const Delivery& deliver) { deliver(); }));
}

ProgressBar::ProgressBar(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      start_seconds_(now_seconds()),
      on_terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { wipe(); }

void ProgressBar::advance(const std::function<void()>& print) {
  wipe();
  print();
  ++done_;
  if (on_terminal_ && done_ < total_ && now_seconds() - start_seconds_ > 1) draw();
}

void ProgressBar::wipe() {
  if (drawn_) to_stderr("\r\033[K");
  drawn_ = false;
}

void ProgressBar::draw() {
  constexpr std::size_t kWidth = 30;
  const std::size_t filled = kWidth * done_ / total_;
  to_stderr("[{}{}] {}/{} {}", std::string(filled, '='), std::string(kWidth - filled, ' '), done_,
            total_, what_);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace tagsmith::detail
