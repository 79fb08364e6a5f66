// SPDX-License-Identifier: Apache-2.0
// A set of output files that appears in its folder as a whole or not at all.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// ---- The clean-up when the process receives a signal to end.

// While it exists, SIGINT, SIGTERM and SIGHUP call `clean_up`, on a separate thread, before they
// end the process as they would have without it. Signals that the process ignores (nohup) stay
// ignored. Several may exist at once.
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

  // While the lock is held no clean-up begins: for steps that must be done wholly or not at all.
  [[nodiscard]] static std::unique_lock<std::mutex> hold_off();

 private:
  int number_ = 0;  // 0 = guards nothing
};

// ---- Files.

// Files are collected in a hidden folder inside the target folder; publish() moves them to their
// names. Without publish(), or when it fails, the destructor leaves the disk as it was before,
// folders included; so does an interrupt (SIGINT, SIGTERM, SIGHUP). A process that was killed
// otherwise leaves its hidden folder behind: the next begin() in the same folder removes it.
class StagedFiles {
 public:
  // Makes the folder where it is missing. Fails when files cannot be made in it.
  static Result<StagedFiles> begin(const std::filesystem::path& folder);

  ~StagedFiles();
  StagedFiles(StagedFiles&& other) noexcept
      : folder_(std::move(other.folder_)),
        lock_(std::exchange(other.lock_, -1)),
        made_(std::exchange(other.made_, nullptr)),
        guard_(std::move(other.guard_)) {}
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;
  StagedFiles& operator=(StagedFiles&&) = delete;

  // `name` is a file name without folders. Several threads may add files of different names.
  Result<void> add(const std::filesystem::path& name, std::string_view bytes) const;

  // The path of a file until it is published.
  std::filesystem::path staged(const std::filesystem::path& name) const {
    return made_->staging / name;
  }

  // Replaces files of the same names. Of a link the target is replaced; a file that goes to a
  // stream (is_stream) is written first, and this cannot be undone.
  Result<void> publish();

 private:
  // The files that an interrupt removes. Changed while interrupts are blocked.
  struct Made {
    std::filesystem::path staging;
    std::vector<std::filesystem::path> folders;  // innermost first
    std::atomic<bool> is_interrupted = false;

    void remove() const;
    void remove_while_written() const;
  };

  StagedFiles() = default;
  Result<void> make_folders();
  bool make_staging();

  std::filesystem::path folder_;
  int lock_ = -1;  // descriptor of the staging folder, locked for as long as its process lives
  std::shared_ptr<Made> made_ = std::make_shared<Made>();
  InterruptGuard guard_;
};

}  // namespace tagsmith::detail
