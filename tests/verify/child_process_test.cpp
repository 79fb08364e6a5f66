// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <unistd.h>

#include <doctest/doctest.h>

#include "decoder/verify/rasterize.hpp"

namespace tagsmith::detail {

using std::chrono::milliseconds;

TEST_CASE("a program's output, messages and exit code come back") {
  const auto output = run_process({"sh", "-c", "cat; echo out; echo err >&2; exit 3"});
  REQUIRE(output.has_value());
  CHECK(output->exit_code == 3);
  CHECK(output->out == "out\n");
  CHECK(output->err == "err\n");
}

TEST_CASE("arguments reach the program as they are, without a shell") {
  const auto output = run_process({"printf", "%s|", "a b", "$(id)", "; ls", "*", ""});
  REQUIRE(output.has_value());
  CHECK(output->out == "a b|$(id)|; ls|*||");
}

TEST_CASE("output and messages come back where standard input is closed") {
  const int standard_input = ::dup(STDIN_FILENO);
  ::close(STDIN_FILENO);
  const auto output = run_process({"sh", "-c", "echo err >&2; exec 2>&-; sleep 0.05; echo out"});
  ::dup2(standard_input, STDIN_FILENO);
  ::close(standard_input);
  REQUIRE(output.has_value());
  CHECK(output->out == "out\n");
  CHECK(output->err == "err\n");
}

TEST_CASE("output larger than a pipe's buffer is read whole") {
  const auto output = run_process({"sh", "-c", "head -c 1000000 /dev/zero; echo end >&2"});
  REQUIRE(output.has_value());
  CHECK(output->out.size() == 1000000);
  CHECK(output->err == "end\n");
}

TEST_CASE("a program that is not there, hangs, floods or crashes is told") {
  const auto absent = run_process({"tagsmith-no-such-program"});
  REQUIRE(!absent.has_value());
  CHECK(absent.error().message.find("tagsmith-no-such-program: not found") == 0);

  const auto before = std::chrono::steady_clock::now();
  const auto hanging = run_process({"sleep", "30"}, {.time = milliseconds(100)});
  REQUIRE(!hanging.has_value());
  CHECK(hanging.error().message == "sleep: did not end within 100 ms");
  CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(10));

  const auto flooding = run_process({"yes"}, {.output_bytes = 100000});
  REQUIRE(!flooding.has_value());
  CHECK(flooding.error().message == "yes: wrote more than 100000 bytes");

  const auto crashing = run_process({"sh", "-c", "kill -9 $$"});
  REQUIRE(crashing.has_value());
  CHECK(crashing->exit_code == 128 + 9);
}

}  // namespace tagsmith::detail
