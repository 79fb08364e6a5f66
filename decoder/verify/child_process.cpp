// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/child_process.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <sys/wait.h>

namespace tagsmith::detail {
namespace {

constexpr std::size_t kErrorBytes = 64U << 10U;

// A pipe whose ends close themselves, and do not leak into other children.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) ends_ = {-1, -1};
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool ok() const { return ends_[0] >= 0; }
  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void close_writer() { close_end(1); }

 private:
  void close_end(std::size_t end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

// Starts argv[0] with its output going into the pipes.
Result<pid_t> spawn(const std::vector<std::string>& argv, const Pipe& out, const Pipe& err) {
  std::vector<char*> arguments;
  arguments.reserve(argv.size() + 1);
  for (const std::string& argument : argv) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.writer(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.writer(), STDERR_FILENO);
  pid_t pid = 0;
  const int error =
      ::posix_spawnp(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return fail(argv[0] + ": not found, is it installed?");
  if (error != 0) return fail(argv[0] + ": cannot be started: " + std::strerror(error));
  return pid;
}

int wait_for(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Appends what the descriptor holds; false at its end.
bool drain(int descriptor, std::string& text) {
  std::array<char, 1U << 16U> buffer;
  const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR;
  text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

// Reads both streams until they end. The message of what went wrong, empty when nothing did.
std::string collect(int out, int err, const ProcessLimits& limits, ProcessOutput& output) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point deadline = Clock::now() + limits.time;
  std::array<pollfd, 2> streams{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) {
      return "did not end within " + std::to_string(limits.time.count()) + " ms";
    }
    if (::poll(streams.data(), streams.size(), static_cast<int>(left.count())) < 0) {
      if (errno == EINTR) continue;
      return std::string("cannot be listened to: ") + std::strerror(errno);
    }
    if (streams[0].revents != 0 && !drain(out, output.out)) streams[0].fd = -1;
    if (streams[1].revents != 0 && !drain(err, output.err)) streams[1].fd = -1;
    if (output.err.size() > kErrorBytes) output.err.resize(kErrorBytes);
    if (output.out.size() > limits.output_bytes) {
      return "wrote more than " + std::to_string(limits.output_bytes) + " bytes";
    }
  }
  return {};
}

}  // namespace

Result<ProcessOutput> run_process(const std::vector<std::string>& argv,
                                  const ProcessLimits& limits) {
  Pipe out;
  Pipe err;
  if (!out.ok() || !err.ok()) return fail(argv[0] + ": no pipe for its output");
  const Result<pid_t> pid = spawn(argv, out, err);
  if (!pid) return fail(pid.error().message);
  out.close_writer();
  err.close_writer();
  ProcessOutput output;
  const std::string problem = collect(out.reader(), err.reader(), limits, output);
  if (!problem.empty()) ::kill(*pid, SIGKILL);
  output.exit_code = wait_for(*pid);
  if (!problem.empty()) return fail(argv[0] + ": " + problem);
  return output;
}

}  // namespace tagsmith::detail
