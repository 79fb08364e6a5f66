// SPDX-License-Identifier: Apache-2.0
// Why there is one file with a rollback journal, and a photo is identified by its content:
// docs/decisions/0015-files-and-ledger.md.
#include "decoder/ledger/ledger.hpp"

#include <algorithm>
#include <fstream>
#include <sqlite3.h>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "decoder/image/bytes.hpp"
#include "decoder/verify/verify_json.hpp"
#include "tagsmith/base/checksum.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

// "tags", the number that distinguishes a ledger from other SQLite databases.
constexpr std::uint32_t kApplication = 0x74616773;
constexpr std::uint32_t kVersion = 2;
constexpr int kPatience = 60'000;  // milliseconds for which others may keep the file locked

// The tables of docs/formats.md, which says for other readers what the columns mean.
constexpr const char* kTables = R"sql(
CREATE TABLE photo (
  id INTEGER PRIMARY KEY,
  survey TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  file TEXT NOT NULL,
  taken TEXT,
  up_known INTEGER NOT NULL,
  revision TEXT NOT NULL,
  program TEXT NOT NULL,
  result TEXT NOT NULL,
  UNIQUE (survey, sha256)
) STRICT;
CREATE TABLE plate (
  photo INTEGER NOT NULL REFERENCES photo (id),
  place INTEGER NOT NULL,
  tag TEXT NOT NULL,
  digits TEXT,
  status TEXT NOT NULL,
  rule TEXT,
  message TEXT,
  module_px REAL,
  grade REAL,
  contrast REAL,
  modulation REAL,
  decodability REAL,
  defects REAL,
  hanging TEXT,
  right_mm REAL,
  up_mm REAL,
  out_mm REAL,
  right_sigma_mm REAL,
  up_sigma_mm REAL,
  out_sigma_mm REAL,
  PRIMARY KEY (photo, place)
) STRICT, WITHOUT ROWID;
CREATE INDEX plate_by_tag ON plate (tag);
)sql";

constexpr const char* kFromVersion1 = R"sql(
ALTER TABLE plate ADD COLUMN right_sigma_mm REAL;
ALTER TABLE plate ADD COLUMN up_sigma_mm REAL;
ALTER TABLE plate ADD COLUMN out_sigma_mm REAL;
PRAGMA user_version = 2;
)sql";

std::string in_words(sqlite3* database, int code) {
  switch (code & 0xFF) {
    case SQLITE_NOTADB:
      return "is no SQLite database, expected a ledger";
    case SQLITE_CORRUPT:
      return "is damaged: take a copy of it from before, or make a new ledger from photos or lines "
             "of `verify --json`";
    case SQLITE_BUSY:
      return fmt::format("was kept locked by another program for {} s: try again when that ends",
                         kPatience / 1000);
    case SQLITE_READONLY:
      return "cannot be written: allow writing to the file and its folder";
    case SQLITE_FULL:
      return "cannot be written, the disk is full";
    case SQLITE_CANTOPEN:
      return "cannot be opened or made there: is its folder missing?";
    default:
      return fmt::format("does not work as a ledger: {}", sqlite3_errmsg(database));
  }
}

tl::unexpected<Error> failure(const fs::path& path, sqlite3* database, int code) {
  return fail(path.string() + ": " + in_words(database, code));
}

// One statement; places of values count from 1, columns from 0. The first failure is kept.
class Statement {
 public:
  Statement(sqlite3* database, const char* sql) {
    code_ = sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Empty text and absent numbers are NULL, except in columns that allow no NULL.
  Statement& put(const std::optional<double>& value) {
    return keep(value ? sqlite3_bind_double(statement_, ++place_, *value)
                      : sqlite3_bind_null(statement_, ++place_));
  }
  Statement& put(const std::string& text, bool may_be_null = true) {
    if (text.empty() && may_be_null) return keep(sqlite3_bind_null(statement_, ++place_));
    return keep(sqlite3_bind_text64(statement_, ++place_, text.data(), text.size(),
                                    SQLITE_TRANSIENT, SQLITE_UTF8));
  }
  Statement& put_whole(sqlite3_int64 value) {
    return keep(sqlite3_bind_int64(statement_, ++place_, value));
  }

  // True with a row.
  bool step() {
    if (code_ == SQLITE_OK || code_ == SQLITE_ROW) code_ = sqlite3_step(statement_);
    return code_ == SQLITE_ROW;
  }
  // Values of a statement that was stepped through.
  int failed() const { return code_ == SQLITE_DONE || code_ == SQLITE_ROW ? SQLITE_OK : code_; }

  std::string text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes == nullptr ? std::string() : std::string(bytes, size);
  }
  std::optional<double> number(int column) const {
    if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
    return sqlite3_column_double(statement_, column);
  }
  sqlite3_int64 whole(int column) const { return sqlite3_column_int64(statement_, column); }

 private:
  Statement& keep(int code) {
    if (code_ == SQLITE_OK) code_ = code;
    return *this;
  }

  sqlite3_stmt* statement_ = nullptr;
  int code_ = SQLITE_OK;
  int place_ = 0;
};

int execute(sqlite3* database, const char* sql) {
  return sqlite3_exec(database, sql, nullptr, nullptr, nullptr);
}

// The changes from here on are made when commit() returns SQLITE_OK, else none of them.
class Transaction {
 public:
  explicit Transaction(sqlite3* database)
      : database_(database), begun_(execute(database, "BEGIN IMMEDIATE")) {}
  ~Transaction() {
    if (begun_ == SQLITE_OK && !done_) execute(database_, "ROLLBACK");
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  int begun() const { return begun_; }
  int commit() {
    const int code = execute(database_, "COMMIT");
    done_ = code == SQLITE_OK;
    return code;
  }

 private:
  sqlite3* database_;
  int begun_;
  bool done_ = false;
};

tl::unexpected<Error> newer(const fs::path& path, std::uint32_t version) {
  return fail(
      fmt::format("{}: is a ledger of version {}, expected {}: use the newer tagsmith that "
                  "made it",
                  path.string(), version, kVersion));
}

// By its first bytes (SQLite's file format, section 1.3), before SQLite may change anything in it.
Result<void> check_is_ledger(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  if (!fs::is_regular_file(path, ignored)) return fail(path.string() + ": is no regular file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return fail(path.string() + ": cannot be read");
  std::string header(100, '\0');
  stream.read(header.data(), static_cast<std::streamsize>(header.size()));
  header.resize(static_cast<std::size_t>(stream.gcount()));
  if (header.empty()) return {};  // left by a process that was killed when it created the ledger
  Bytes bytes(header, true);
  const std::uint32_t version = bytes.number(60, 4);
  const bool is_ledger = bytes.number(68, 4) == kApplication;
  if (!header.starts_with("SQLite format 3\0"sv) || bytes.beyond() || !is_ledger) {
    return fail(path.string() + ": is no ledger of tagsmith, expected one, or a name that is free");
  }
  return version > kVersion ? newer(path, version) : Result<void>{};
}

// A photo as its line of `verify --json` says it, with that line's rounded numbers; and the line's
// hash, which identifies a result, whatever the files are called.
struct PhotoLine {
  VerifiedFile file;
  std::string result;
};

// Nothing for print files and for files that could not be read.
std::optional<PhotoLine> line_of(const VerifiedFile& verified) {
  if (!verified.is_photo() || verified.sha256.empty()) return std::nullopt;
  std::optional<VerifiedFile> file = verified_file_from(to_json_line(verified));
  if (!file) return std::nullopt;
  VerifiedFile nameless = *file;
  nameless.file.clear();
  nameless.picture.file.clear();
  for (VerifiedTag& tag : nameless.tags) tag.picture.file.clear();
  return PhotoLine{std::move(*file), sha256(to_json_line(nameless))};
}

int insert(sqlite3* database, sqlite3_int64 photo, std::size_t place, const VerifiedTag& tag) {
  Statement row(database,
                "INSERT INTO plate VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
                "?, ?)");
  row.put_whole(photo).put_whole(static_cast<sqlite3_int64>(place)).put(tag.tag);
  row.put(tag.digits ? to_string(*tag.digits) : "").put(to_string(tag.finding.status));
  row.put(tag.finding.rule).put(tag.finding.message);
  row.put(tag.digits ? std::optional(tag.module_px) : std::nullopt);
  row.put(tag.grade ? std::optional(tag.grade->grade) : std::nullopt);
  for (const GradeParameter parameter : kWearParameters) {
    const auto mean = tag.grade ? tag.grade->means[static_cast<std::size_t>(parameter)]
                                : std::optional<ParameterMean>();
    row.put(mean ? mean->value : std::nullopt);
  }
  row.put(tag.hung ? to_string(tag.hung->verdict) : "");
  const bool is_measured = tag.hung && tag.hung->offset.sigma.norm() > 0;
  const auto put_millimetres = [&](const Eigen::Vector3d& metres) {
    for (const double metre : metres) {
      row.put(is_measured ? std::optional(1e3 * metre) : std::nullopt);
    }
  };
  const Measured3 offset = tag.hung ? tag.hung->offset : Measured3{};
  put_millimetres(offset.value);
  put_millimetres(offset.sigma);
  row.step();
  return row.failed();
}

PlateSighting sighting_of(const Statement& row) {
  PlateSighting seen;
  seen.tag = row.text(0);
  seen.digits = row.text(1);
  seen.taken = row.text(2);
  seen.up_known = row.whole(3) != 0;
  seen.finding.status = value_named<TagStatus>(row.text(4), kTagStatuses).value_or(TagStatus::ok);
  seen.finding.rule = row.text(5);
  seen.finding.message = row.text(6);
  seen.module_px = row.number(7).value_or(0);
  seen.grade = row.number(8);
  for (std::size_t i = 0; i < seen.values.size(); ++i) {
    seen.values[i] = row.number(9 + static_cast<int>(i));
  }
  seen.hanging = row.text(13);
  const auto triple = [&](int first) -> std::optional<std::array<double, 3>> {
    if (!row.number(first)) return std::nullopt;
    return std::array{*row.number(first), row.number(first + 1).value_or(0),
                      row.number(first + 2).value_or(0)};
  };
  seen.offset_mm = triple(14);
  seen.offset_sigma_mm = triple(19);
  seen.revision = row.text(17);
  seen.entry = row.whole(18);
  return seen;
}

}  // namespace

Result<Ledger> Ledger::open(const fs::path& path, int flags) {
  if (auto checked = check_is_ledger(path); !checked) return fail(checked);
  sqlite3* opened = nullptr;
  std::error_code failed;
  // By its whole path: SQLite gives some names another meaning, as `:memory:`.
  const int code = sqlite3_open_v2(fs::absolute(path, failed).c_str(), &opened, flags, nullptr);
  Ledger ledger(path, std::shared_ptr<sqlite3>(opened, sqlite3_close));
  if (code != SQLITE_OK) return failure(path, opened, code);
  sqlite3_busy_timeout(opened, kPatience);
  // A ledger that is passed on must contain data, no programs.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  const int durable = execute(opened, "PRAGMA synchronous = FULL");
  if (durable != SQLITE_OK) return failure(path, opened, durable);
  return ledger;
}

Result<Ledger> Ledger::open_to_write(const fs::path& path) {
  Result<Ledger> ledger = open(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  if (!ledger) return ledger;
  if (sqlite3_db_readonly(ledger->database_.get(), "main") == 1) {
    return failure(path, ledger->database_.get(), SQLITE_READONLY);
  }
  if (auto made = ledger->make_tables(); !made) return fail(made);
  return ledger;
}

Result<Ledger> Ledger::open_to_read(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored) || fs::file_size(path, ignored) == 0) {
    return fail(path.string() + ": holds no ledger, make one with `tagsmith verify --ledger`");
  }
  // Changes of a killed process that are incomplete are rolled back, which needs writing.
  return open(path, SQLITE_OPEN_READWRITE);
}

Result<std::uint32_t> Ledger::version() const {
  Statement version(database_.get(), "PRAGMA user_version");
  if (!version.step()) return failure(path_, database_.get(), version.failed());
  return static_cast<std::uint32_t>(version.whole(0));
}

Result<void> Ledger::make_tables() const {
  sqlite3* database = database_.get();
  Transaction transaction(database);
  if (transaction.begun() != SQLITE_OK) return failure(path_, database, transaction.begun());
  const Result<std::uint32_t> present = version();
  if (!present) return fail(present);
  if (*present == kVersion) return {};  // another process was first
  if (*present > kVersion) return newer(path_, *present);
  const std::string sql =
      *present == 1 ? kFromVersion1
                    : fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}; {}",
                                  kApplication, kVersion, kTables);
  if (const int code = execute(database, sql.c_str()); code != SQLITE_OK) {
    return failure(path_, database, code);
  }
  const int code = transaction.commit();
  return code == SQLITE_OK ? Result<void>{} : failure(path_, database, code);
}

// What the ledger has of a photo.
struct Ledger::StoredPhoto {
  std::string result;
  std::string taken;
  std::string revision;
  bool judged = false;  // whether it was judged where its plates hang

  // Whether this result says nothing that the present one does not, or less.
  bool stands_for(const VerifiedFile& file, const std::string& result_of_file) const {
    const bool judges =
        std::ranges::any_of(file.tags, [](const VerifiedTag& tag) { return tag.hung.has_value(); });
    const bool says_less = (judged && !judges) || (!taken.empty() && file.taken.empty());
    return result == result_of_file || (revision == file.revision && says_less);
  }
};

Result<std::optional<Ledger::StoredPhoto>> Ledger::stored_photo(const std::string& survey,
                                                                const std::string& sha256) const {
  Statement photo(database_.get(),
                  "SELECT result, taken, revision, EXISTS (SELECT 1 FROM plate WHERE photo = id "
                  "AND hanging IS NOT NULL) FROM photo WHERE survey = ? AND sha256 = ?");
  photo.put(survey, false).put(sha256);
  if (photo.step()) {
    return StoredPhoto{photo.text(0), photo.text(1), photo.text(2), photo.whole(3) != 0};
  }
  if (photo.failed() != SQLITE_OK) return failure(path_, database_.get(), photo.failed());
  return std::nullopt;
}

Result<void> Ledger::write_photo(const std::string& survey, const VerifiedFile& file,
                                 const std::string& result) const {
  sqlite3* database = database_.get();
  Statement photo(database,
                  "INSERT INTO photo (survey, sha256, file, taken, up_known, revision, program, "
                  "result) VALUES (?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (survey, sha256) DO UPDATE "
                  "SET file = excluded.file, taken = excluded.taken, up_known = excluded.up_known, "
                  "revision = excluded.revision, program = excluded.program, result = "
                  "excluded.result RETURNING id");
  photo.put(survey, false).put(file.sha256).put(file.file.string(), false).put(file.taken);
  photo.put_whole(is_up_known(file.up) ? 1 : 0).put(file.revision, false);
  photo.put(TAGSMITH_VERSION).put(result);
  if (!photo.step()) return failure(path_, database, photo.failed());
  const sqlite3_int64 id = photo.whole(0);
  photo.step();
  Statement earlier(database, "DELETE FROM plate WHERE photo = ?");
  earlier.put_whole(id).step();
  int code = earlier.failed();
  for (std::size_t i = 0; i < file.tags.size() && code == SQLITE_OK; ++i) {
    if (!file.tags[i].tag.empty()) code = insert(database, id, i, file.tags[i]);
  }
  return code == SQLITE_OK ? Result<void>{} : failure(path_, database, code);
}

Result<LedgerTally> Ledger::enter(const std::string& survey, std::span<const VerifiedFile> files) {
  std::vector<PhotoLine> lines;
  for (const VerifiedFile& file : files) {
    if (auto line = line_of(file)) lines.push_back(std::move(*line));
  }
  LedgerTally tally;
  sqlite3* database = database_.get();
  Transaction transaction(database);
  if (transaction.begun() != SQLITE_OK) return failure(path_, database, transaction.begun());
  for (const auto& [file, result] : lines) {
    const Result<std::optional<StoredPhoto>> before = stored_photo(survey, file.sha256);
    if (!before) return fail(before);
    if (*before && (*before)->stands_for(file, result)) {
      ++tally.known;
      continue;
    }
    ++(*before ? tally.replaced : tally.added);
    if (file.taken.empty()) ++tally.undated;
    if (auto written = write_photo(survey, file, result); !written) return fail(written);
  }
  const int code = transaction.commit();
  if (code != SQLITE_OK) return failure(path_, database, code);
  return tally;
}

Result<LedgerCounts> Ledger::count_photos(const std::string& survey, const std::string& last,
                                          const std::string& revision) const {
  Statement row(database_.get(),
                "SELECT count(*), count(*) - count(taken), total(substr(taken, 1, 10) > ?1), "
                "total(taken < ?2), total(revision <> ?3), total(revision <> ?3 AND taken > "
                "(SELECT min(taken) FROM photo WHERE survey = ?4 AND revision = ?3 AND "
                "taken >= ?2)) FROM photo WHERE survey = ?4");
  row.put(last, false).put(std::string(kFirstPhotos), false).put(revision, false);
  row.put(survey, false);
  if (!row.step()) return failure(path_, database_.get(), row.failed());
  const auto count = [&](int column) { return static_cast<std::size_t>(row.whole(column)); };
  return LedgerCounts{count(0), count(1), count(2), count(3), count(4), count(5)};
}

Result<std::vector<std::string>> Ledger::surveys() const {
  Statement row(database_.get(), "SELECT DISTINCT survey FROM photo ORDER BY survey");
  std::vector<std::string> names;
  while (row.step()) names.push_back(row.text(0));
  if (row.failed() != SQLITE_OK) return failure(path_, database_.get(), row.failed());
  return names;
}

Result<void> Ledger::for_each_sighting(
    const std::string& survey, const std::function<void(const PlateSighting&)>& take) const {
  const Result<std::uint32_t> present = version();
  if (!present) return fail(present);
  const std::string sql = fmt::format(
      "SELECT tag, digits, taken, up_known, status, rule, message, module_px, grade, "
      "contrast, modulation, decodability, defects, hanging, right_mm, up_mm, out_mm, "
      "revision, photo.id, {} "
      "FROM plate JOIN photo ON photo.id = plate.photo WHERE survey = ? "
      "ORDER BY tag, taken, sha256, place",
      *present < 2 ? "NULL, NULL, NULL" : "right_sigma_mm, up_sigma_mm, out_sigma_mm");
  Statement row(database_.get(), sql.c_str());
  row.put(survey, false);
  while (row.step()) take(sighting_of(row));
  if (row.failed() != SQLITE_OK) return failure(path_, database_.get(), row.failed());
  return {};
}

}  // namespace tagsmith::detail
