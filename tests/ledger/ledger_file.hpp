// SPDX-License-Identifier: Apache-2.0
// Photos to enter in ledgers, and what ledgers hold.
#pragma once

#include <filesystem>
#include <memory>
#include <sqlite3.h>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "decoder/verify/verified_file.hpp"

namespace tagsmith::detail::test {

// Runs SQL on the file and returns its rows, columns set apart by |.
inline std::string query(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* opened = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &opened) == SQLITE_OK);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(opened, sqlite3_close);
  sqlite3_busy_timeout(opened, 60'000);
  std::string rows;
  const auto take = [](void* text, int count, char** values, char**) {
    for (int i = 0; i < count; ++i) {
      *static_cast<std::string*>(text) +=
          std::string(i > 0 ? "|" : "") + (values[i] == nullptr ? "" : values[i]);
    }
    *static_cast<std::string*>(text) += "\n";
    return 0;
  };
  const int code = sqlite3_exec(opened, sql.c_str(), take, &rows, nullptr);
  REQUIRE_MESSAGE(code == SQLITE_OK, sqlite3_errmsg(opened));
  return rows;
}

// All that the ledger says, in an order that does not depend on who wrote first.
inline std::string rows_of(const std::filesystem::path& ledger) {
  return query(ledger,
               "SELECT survey, sha256, file, taken, up_known, revision, program, result, place, "
               "tag, digits, status, rule, message, module_px, grade, contrast, modulation, "
               "decodability, defects, hanging, right_mm, up_mm, out_mm, right_sigma_mm, "
               "up_sigma_mm, out_sigma_mm FROM photo LEFT JOIN plate "
               "ON plate.photo = photo.id ORDER BY survey, sha256, place");
}

// Photo number i, of two plates.
inline VerifiedFile numbered_photo(int i) {
  VerifiedFile file{fmt::format("photo-{}.jpg", i)};
  file.sha256 = fmt::format("{:064x}", i);
  file.revision = "abc";
  file.width = 1280;
  file.height = 960;
  file.taken = "2026-03-31T14:05:09";
  for (const char* tag : {"000L", "001L"}) {
    VerifiedTag& seen = file.tags.emplace_back();
    seen.tag = tag;
    seen.digits = parse_digits("019000000404");
    seen.module_px = 5;
    seen.grade = SymbolGrade{3.5, GradeParameter::modulation, false};
    seen.grade->means[static_cast<std::size_t>(GradeParameter::modulation)] = {3.5, 0.65};
  }
  return file;
}

}  // namespace tagsmith::detail::test
