// SPDX-License-Identifier: Apache-2.0
#include "decoder/ledger/ledger.hpp"

#include <array>
#include <csignal>
#include <functional>
#include <unistd.h>
#include <vector>

#include <doctest/doctest.h>
#include <sys/wait.h>

#include "tagsmith/base/file.hpp"
#include "tests/ledger/ledger_file.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;
using test::numbered_photo;
using test::query;
using test::rows_of;

LedgerTally enter(const fs::path& path, const std::vector<VerifiedFile>& files) {
  Result<Ledger> ledger = Ledger::open_to_write(path);
  REQUIRE_MESSAGE(ledger, ledger.error().message);
  const Result<LedgerTally> tally = ledger->enter("corridor", files);
  REQUIRE_MESSAGE(tally, tally.error().message);
  return *tally;
}

// A process of its own, which ends by itself or by a signal.
pid_t in_process(const std::function<bool()>& work) {
  const pid_t process = fork();
  if (process == 0) _exit(work() ? 0 : 1);
  return process;
}

bool ended_well(pid_t process) {
  int status = 0;
  return waitpid(process, &status, 0) == process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// Photos first to end - 1, each in a transaction of its own.
bool enter_each(const fs::path& path, int first, int end) {
  Result<Ledger> ledger = Ledger::open_to_write(path);
  for (int i = first; i < end && ledger; ++i) {
    const std::array photo{numbered_photo(i)};
    if (!ledger->enter("corridor", photo)) return false;
  }
  return ledger.has_value();
}

std::string refusal_to_write(const fs::path& path) {
  const Result<Ledger> ledger = Ledger::open_to_write(path);
  return ledger ? "" : ledger.error().message;
}

}  // namespace

TEST_CASE("a photo is in the ledger once, with its last result") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db";
  VerifiedFile photo = numbered_photo(1);
  CHECK(enter(path, {photo, photo}).added == 1);
  CHECK(enter(path, {photo}).known == 1);
  photo.file = "copy.jpg";  // the same content elsewhere
  CHECK(enter(path, {photo}).known == 1);
  CHECK(query(path, "SELECT count(*), min(file) FROM photo") == "1|photo-1.jpg\n");
  CHECK(query(path, "SELECT count(*) FROM plate") == "2\n");
  photo.tags.pop_back();
  photo.revision = "def";
  CHECK(enter(path, {photo}).replaced == 1);
  CHECK(query(path, "SELECT revision, tag, modulation FROM photo JOIN plate ON photo = id") ==
        "def|000L|0.65\n");
}

TEST_CASE("photos of another survey stand beside, print files and broken ones are left out") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db";
  VerifiedFile page = numbered_photo(1);
  page.width = 0;
  VerifiedFile broken = numbered_photo(2);
  broken.sha256.clear();
  VerifiedFile undated = numbered_photo(3);
  undated.taken.clear();
  const LedgerTally tally = enter(path, {page, broken, undated});
  CHECK(tally.added == 1);
  CHECK(tally.undated == 1);
  Result<Ledger> ledger = Ledger::open_to_write(path);
  REQUIRE(ledger);
  CHECK(ledger->enter("drift", std::array{undated, numbered_photo(4)})->added == 2);
  CHECK(ledger->count_photos("drift", "2026-12-31", "abc")->photos == 2);
  CHECK(ledger->count_photos("drift", "2026-12-31", "abc")->undated == 1);
  CHECK(ledger->count_photos("corridor", "2026-12-31", "abc")->photos == 1);
  CHECK(ledger->count_photos("none", "2026-12-31", "abc")->photos == 0);
}

TEST_CASE("what is entered is read back") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db";
  VerifiedFile photo = numbered_photo(1);
  photo.up = UpSource::camera;
  VerifiedTag& moved = photo.tags[1];
  moved.finding = {TagStatus::misplaced, "moved", "raise it"};
  moved.hung = HungTag{
      moved.tag, HangVerdict::off, 2, {{0.001, -0.03, 0}, {0.002, 0.002, 0.002}}, {}, {}, "", ""};
  enter(path, {photo});
  const Result<Ledger> ledger = Ledger::open_to_read(path);
  REQUIRE(ledger);
  std::vector<PlateSighting> seen;
  REQUIRE(ledger->for_each_sighting("corridor", [&](const auto& one) { seen.push_back(one); }));
  REQUIRE(seen.size() == 2);
  CHECK(seen[0].tag == "000L");
  CHECK(seen[0].digits == "019000000404");
  CHECK(seen[0].taken == "2026-03-31T14:05:09");
  CHECK(seen[0].up_known);
  CHECK(seen[0].finding.status == TagStatus::ok);
  CHECK(seen[0].module_px == 5);
  CHECK(seen[0].grade == 3.5);
  CHECK(seen[0].values == WearValues{std::nullopt, 0.65, std::nullopt, std::nullopt});
  CHECK_FALSE(seen[0].offset_mm);
  CHECK(seen[1].finding.status == TagStatus::misplaced);
  CHECK(seen[1].finding.rule == "moved");
  CHECK(seen[1].hanging == "off");
  REQUIRE(seen[1].offset_mm);
  CHECK((*seen[1].offset_mm)[1] == doctest::Approx(-30));
  REQUIRE(seen[1].offset_sigma_mm);
  CHECK((*seen[1].offset_sigma_mm)[1] == doctest::Approx(2));
}

TEST_CASE("a ledger of version 1 is read as it is, and gets the new columns by the next photo") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db";
  VerifiedFile photo = numbered_photo(1);
  photo.tags[0].hung = HungTag{
      "000L", HangVerdict::fits, 2, {{0.001, -0.003, 0}, {0.002, 0.002, 0.002}}, {}, {}, "", ""};
  enter(path, {photo});
  query(path,
        "ALTER TABLE plate DROP COLUMN right_sigma_mm; ALTER TABLE plate DROP COLUMN up_sigma_mm; "
        "ALTER TABLE plate DROP COLUMN out_sigma_mm; PRAGMA user_version = 1");
  const auto sightings = [&] {
    std::vector<PlateSighting> seen;
    const Result<Ledger> ledger = Ledger::open_to_read(path);
    REQUIRE(ledger);
    REQUIRE(ledger->for_each_sighting("corridor", [&](const auto& one) { seen.push_back(one); }));
    return seen;
  };
  REQUIRE(sightings().size() == 2);
  CHECK(sightings()[0].offset_mm);
  CHECK_FALSE(sightings()[0].offset_sigma_mm);
  CHECK(query(path, "PRAGMA user_version") == "1\n");
  photo.sha256 = numbered_photo(2).sha256;
  CHECK(enter(path, {photo}).added == 1);
  CHECK(query(path, "PRAGMA user_version") == "2\n");
  REQUIRE(sightings().size() == 4);
  CHECK(std::ranges::count_if(sightings(), [](const PlateSighting& seen) {
          return seen.offset_sigma_mm.has_value();
        }) == 1);
}

TEST_CASE("three processes that write at once lose nothing and double nothing") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "shared.db";
  const fs::path alone = folder.path() / "alone.db";
  std::vector<pid_t> writers;
  for (const int first : {0, 10, 20}) {
    writers.push_back(in_process([&] { return enter_each(path, first, first + 30); }));
  }
  for (const pid_t writer : writers) CHECK(ended_well(writer));
  REQUIRE(enter_each(alone, 0, 50));
  CHECK((rows_of(path) == rows_of(alone)));
  CHECK(query(path, "PRAGMA integrity_check") == "ok\n");
}

TEST_CASE("a run that is killed and repeated leaves what an undisturbed one does") {
  const test::TemporaryFolder folder;
  const fs::path alone = folder.path() / "alone.db";
  REQUIRE(enter_each(alone, 0, 30));
  const std::string expected = rows_of(alone);
  for (const std::size_t photos : {0U, 1U, 7U, 19U}) {
    CAPTURE(photos);
    const fs::path path = folder.path() / fmt::format("killed-{}.db", photos);
    const pid_t writer = in_process([&] { return enter_each(path, 0, 30); });
    // Killed as soon as that many photos are there, wherever it is then.
    while (true) {
      const Result<Ledger> ledger = Ledger::open_to_read(path);
      if (photos == 0 && fs::exists(path)) break;
      const auto count =
          ledger ? ledger->count_photos("corridor", "2026-12-31", "abc") : Result<LedgerCounts>();
      if (count && count->photos >= photos && photos > 0) break;
    }
    kill(writer, SIGKILL);
    waitpid(writer, nullptr, 0);
    CHECK(enter_each(path, 0, 30));
    CHECK((rows_of(path) == expected));
  }
}

TEST_CASE("a transaction that a killed process left half on the disk is taken back") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db";
  REQUIRE(enter_each(path, 0, 3));
  const std::string before = rows_of(path);
  const pid_t writer = in_process([&] {
    sqlite3* database = nullptr;
    sqlite3_open(path.c_str(), &database);
    // With a cache of one page, pages are in the file before the transaction ends.
    sqlite3_exec(database,
                 "PRAGMA cache_size = 1; BEGIN; UPDATE photo SET revision = hex(zeroblob(20000)); "
                 "DELETE FROM plate",
                 nullptr, nullptr, nullptr);
    kill(getpid(), SIGKILL);
    return false;
  });
  CHECK_FALSE(ended_well(writer));
  CHECK(fs::exists(path.string() + "-journal"));
  REQUIRE(enter_each(path, 0, 3));
  CHECK((rows_of(path) == before));
}

TEST_CASE("a file that is no ledger of this version is refused and not touched") {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return folder.path() / name; };
  REQUIRE(write_file(at("text"), "id,left,right\n1,a.jpg,b.jpg\n"));
  REQUIRE(write_file(at("long"), std::string(5000, 'x')));
  query(at("other.db"), "CREATE TABLE contacts (name TEXT)");
  REQUIRE(enter_each(at("newer.db"), 0, 1));
  query(at("newer.db"), "PRAGMA user_version = 3");
  for (const char* name : {"text", "long", "other.db", "newer.db"}) {
    CAPTURE(name);
    const std::string before = read_file(at(name)).value();
    CHECK(refusal_to_write(at(name)).starts_with(at(name).string() + ": is "));
    CHECK_FALSE(Ledger::open_to_read(at(name)));
    CHECK(read_file(at(name)).value() == before);
    CHECK_FALSE(fs::exists(at(name).string() + "-journal"));
  }
  CHECK(refusal_to_write(at("newer.db")).find("version 3, expected 2") != std::string::npos);
  CHECK_FALSE(refusal_to_write(folder.path()).empty());
  CHECK_FALSE(refusal_to_write("/proc/ledger.db").empty());
  CHECK_FALSE(Ledger::open_to_read(at("absent.db")));
  CHECK_FALSE(fs::exists(at("absent.db")));
}

TEST_CASE("a damaged ledger is refused in words, however it is damaged") {
  const test::TemporaryFolder folder;
  const fs::path whole = folder.path() / "whole.db";
  REQUIRE(enter_each(whole, 0, 40));
  const std::string bytes = read_file(whole).value();
  const fs::path path = folder.path() / "damaged.db";
  for (std::size_t page = 1; page * 4096 < bytes.size(); ++page) {
    CAPTURE(page);
    std::string damaged = bytes;
    damaged.replace(page * 4096, 4096, std::string(4096, '\x7f'));
    REQUIRE(write_file(path, damaged));
    const Result<Ledger> ledger = Ledger::open_to_read(path);
    if (!ledger) continue;
    const auto read = ledger->for_each_sighting("corridor", [](const auto&) {});
    CHECK((read || read.error().message.starts_with(path.string() + ": ")));
  }
  REQUIRE(write_file(path, bytes.substr(0, bytes.size() / 2)));
  const Result<Ledger> half = Ledger::open_to_read(path);
  const auto read = half ? half->for_each_sighting("corridor", [](const auto&) {})
                         : Result<void>(tl::unexpected(half.error()));
  REQUIRE_FALSE(read);
  CHECK(read.error().message.find("damaged") != std::string::npos);
}

TEST_CASE("a ledger in a folder that is missing is refused in words") {
  const test::TemporaryFolder folder;
  CHECK(refusal_to_write(folder.path() / "none" / "a.db").ends_with("is its folder missing?"));
}

TEST_CASE("a ledger that cannot be written is refused") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db";
  REQUIRE(enter_each(path, 0, 1));
  fs::permissions(path, fs::perms::owner_read);
  if (geteuid() != 0) CHECK(refusal_to_write(path).find("written") != std::string::npos);
  CHECK(Ledger::open_to_read(path)->count_photos("corridor", "2026-12-31", "abc")->photos == 1);
}

TEST_CASE("names that mean something else to SQLite are names of files") {
  const test::TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  for (const char* name : {":memory:", "file:a.db?mode=memory"}) {
    CHECK(enter_each(name, 0, 2));
    CHECK(fs::file_size(name) > 0);
  }
  fs::current_path(before);
}

}  // namespace tagsmith::detail
