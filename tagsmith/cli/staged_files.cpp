// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/staged_files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <fcntl.h>
#include <limits>
#include <map>
#include <optional>
#include <signal.h>
#include <stdlib.h>
#include <string>
#include <system_error>
#include <thread>
#include <unistd.h>

#include <sys/file.h>

#include "tagsmith/base/file.hpp"

namespace tagsmith::detail {

// ---- Interrupts.

namespace {

struct CleanUps {
  std::mutex mutex;
  std::map<int, std::function<void()>> by_number;
  int last_number = 0;
};

// Never destroyed: the watching thread may use it until the process ends.
CleanUps& clean_ups() {
  static auto* const instance = new CleanUps;
  return *instance;
}

// A handler may do almost nothing; it passes the signal to the watching thread.
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

// True when the thread runs and the handlers are installed. Done once a process.
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

// ---- Files.

namespace fs = std::filesystem;
namespace {

// A file moved to its place, and where the one it replaced is kept until the whole set is there.
struct Move {
  fs::path target;
  fs::path replaced;  // empty = there was none
};

std::vector<fs::path> missing_folders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path at = folder; !at.empty() && !fs::exists(at, ignored); at = at.parent_path()) {
    missing.push_back(at);
  }
  return missing;
}

void undo(const std::vector<Move>& moves) {
  std::error_code ignored;
  for (const Move& move : moves) {
    fs::remove(move.target, ignored);
    if (!move.replaced.empty()) fs::rename(move.replaced, move.target, ignored);
  }
}

std::vector<fs::path> files_in(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> files;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    files.push_back(at->path());
  }
  std::ranges::sort(files);
  return files;
}

// The file, or a copy of it beside the target of a link that leads elsewhere: that may be on
// another file system, to which no file can be renamed.
Result<fs::path> within_reach(const fs::path& target, const fs::path& file) {
  if (target.parent_path() == file.parent_path().parent_path()) return file;
  std::error_code error;
  const fs::path copy = temporary_beside(target);
  fs::copy_file(file, copy, fs::copy_options::overwrite_existing, error);
  if (!error) return copy;
  std::error_code ignored;
  fs::remove(copy, ignored);
  return fail(target.string() + ": cannot be written: " + error.message());
}

Result<Move> move_to(const fs::path& target, const fs::path& staged) {
  std::error_code error;
  std::error_code ignored;
  Move move{target, {}};
  if (fs::is_directory(target, ignored)) {
    return fail(target.string() + ": is a folder, expected a file or nothing");
  }
  const Result<fs::path> file = within_reach(target, staged);
  if (!file) return fail(file);
  if (fs::exists(fs::symlink_status(target, ignored))) {
    move.replaced = temporary_beside(*file);
    fs::rename(target, move.replaced, error);
    if (error) move.replaced.clear();
  }
  if (!error) fs::rename(*file, target, error);
  if (!error) return move;
  if (!move.replaced.empty()) fs::rename(move.replaced, target, ignored);
  fs::remove(*file, ignored);
  return fail(target.string() + ": cannot be written: " + error.message());
}

// Files whose names are those of streams are written to these, and removed from the set.
Result<void> write_streams(const fs::path& folder, const fs::path& staging) {
  std::error_code error;
  for (const fs::path& file : files_in(staging, error)) {
    const fs::path name = folder / file.filename();
    if (!is_stream(name)) continue;
    const Result<std::string> bytes = read_file(file, std::numeric_limits<std::uintmax_t>::max());
    if (!bytes) return fail(bytes);
    if (auto written = write_file(name, *bytes); !written) return written;
    fs::remove(file, error);
  }
  return {};
}

constexpr std::string_view kStagingPrefix = ".tagsmith-";

// The folder's descriptor with a lock on it; -1 when another process holds the lock. The kernel
// drops the lock when the process ends, however it ends.
int lock_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return -1;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

// Removes the hidden folders of processes that were killed.
void remove_abandoned(const fs::path& folder) {
  std::error_code error;
  for (const fs::path& path : files_in(folder, error)) {
    const std::string name = path.filename().string();
    if (name.size() != kStagingPrefix.size() + 6 || !name.starts_with(kStagingPrefix)) continue;
    const int lock = lock_folder(path);
    if (lock < 0) continue;
    fs::remove_all(path, error);
    ::close(lock);
  }
}

// The file that is in the place of the folder or of one that it lies in.
std::optional<fs::path> file_in_the_way(fs::path folder) {
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (fs::exists(status) && !fs::is_directory(status)) return folder;
  }
  return std::nullopt;
}

}  // namespace

void StagedFiles::Made::remove() const {
  std::error_code ignored;
  if (!staging.empty()) fs::remove_all(staging, ignored);
  for (const fs::path& made : folders) fs::remove(made, ignored);  // only when empty
}

// Threads that had begun to write a file may still create it, and its folder.
void StagedFiles::Made::remove_while_written() const {
  constexpr int kAttempts = 5;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    remove();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  remove();
}

Result<void> StagedFiles::make_folders() {
  const auto whole = InterruptGuard::hold_off();
  std::error_code error;
  made_->folders = missing_folders(folder_);
  fs::create_directories(folder_, error);
  if (!error && fs::is_directory(folder_)) return {};
  const auto file = file_in_the_way(folder_);
  if (file) return fail(file->string() + ": is a file, expected a folder");
  return fail(folder_.string() + ": cannot be made: " + error.message());
}

bool StagedFiles::make_staging() {
  constexpr int kAttempts =
      10;  // another process may treat the folder as abandoned before its lock
  const auto whole = InterruptGuard::hold_off();
  std::error_code ignored;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::string pattern = (folder_ / kStagingPrefix).string() + "XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) break;
    made_->staging = pattern;
    lock_ = lock_folder(made_->staging);
    if (lock_ >= 0 && fs::exists(made_->staging, ignored)) return true;
    if (lock_ >= 0) ::close(std::exchange(lock_, -1));
  }
  return false;
}

Result<StagedFiles> StagedFiles::begin(const fs::path& folder) {
  StagedFiles files;
  files.folder_ = (folder / "").parent_path();  // without a trailing slash
  // Before anything is created that an interrupt would leave.
  files.guard_ = InterruptGuard([made = files.made_] {
    made->is_interrupted = true;
    made->remove_while_written();
  });
  if (auto there = files.make_folders(); !there) return fail(there);
  remove_abandoned(files.folder_);
  if (files.make_staging()) return files;
  return fail(folder.string() +
              ": no file can be written there: " + std::generic_category().message(errno));
}

StagedFiles::~StagedFiles() {
  if (made_) made_->remove();
  if (lock_ >= 0) ::close(lock_);
}

Result<void> StagedFiles::add(const fs::path& name, std::string_view bytes) const {
  if (const std::size_t length = name.string().size(); length > NAME_MAX) {
    return fail((folder_ / name).string() + ": the name has " + std::to_string(length) +
                " bytes, expected at most " + std::to_string(NAME_MAX));
  }
  if (!made_->is_interrupted && write_file(made_->staging / name, bytes)) return {};
  return fail((folder_ / name).string() + ": cannot be written, is the disk full?");
}

Result<void> StagedFiles::publish() {
  // Before interrupts are blocked: a pipe waits for its reader.
  if (auto written = write_streams(folder_, made_->staging); !written) return written;
  const auto whole = InterruptGuard::hold_off();
  std::error_code error;
  std::vector<Move> moves;
  for (const fs::path& file : files_in(made_->staging, error)) {
    const Result<Move> move = move_to(behind_links(folder_ / file.filename()), file);
    if (!move) {
      undo(moves);
      return fail(move);
    }
    moves.push_back(*move);
  }
  if (error) {
    undo(moves);
    return fail(folder_.string() + ": cannot be written: " + error.message());
  }
  for (const Move& move : moves) fs::remove(move.replaced, error);
  return {};
}

}  // namespace tagsmith::detail
