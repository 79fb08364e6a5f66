// SPDX-License-Identifier: Apache-2.0
// The ledger: what photos showed of each plate, run after run, in one SQLite file
// (docs/formats.md).
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/verify/verified_file.hpp"
#include "tagsmith/base/result.hpp"

struct sqlite3;

namespace tagsmith::detail {

// The measures of a symbol that wear and dirt change, in the order of the ledger's columns.
inline constexpr std::array kWearParameters{GradeParameter::symbol_contrast,
                                            GradeParameter::modulation,
                                            GradeParameter::decodability, GradeParameter::defects};
using WearValues = std::array<std::optional<double>, kWearParameters.size()>;

// A plate in a photo, as the ledger has it.
struct PlateSighting {
  std::string tag;     // as the survey called it that it was verified against
  std::string digits;  // as read; empty when unreadable
  std::string taken;   // of the photo; empty = not known
  bool up_known = false;
  Finding finding;
  double module_px = 0;
  std::optional<double> grade;
  WearValues values{};
  std::string hanging;  // verdict; empty = not judged
  std::optional<std::array<double, 3>> offset_mm;
  std::optional<std::array<double, 3>> offset_sigma_mm;  // nothing = entered by version 1
  std::string revision;  // of the survey that it was verified against
  long entry = 0;        // of the photo: greater than those of photos that were entered before
};

struct LedgerCounts {
  std::size_t photos = 0;
  std::size_t undated = 0;
  std::size_t future = 0;           // dated after the day that was asked for
  std::size_t clock_reset = 0;      // dated before kFirstPhotos
  std::size_t other_revisions = 0;  // verified against another state of the survey
  std::size_t mixed_revisions = 0;  // of these, taken after a photo of the present state
};

// No photo of our plates is older (ISO 8601): a camera that says so had its clock reset.
inline constexpr std::string_view kFirstPhotos = "2017-01-01";

// What was done with the photos' results that were to be entered.
struct LedgerTally {
  std::size_t added = 0;
  std::size_t replaced = 0;  // the photo was there with another result
  std::size_t known = 0;     // with this result: nothing was written
  std::size_t undated = 0;   // of those that were written
};

class Ledger {
  struct StoredPhoto;

 public:
  // Makes the file where there is none, and adds the columns that one of an earlier version lacks.
  // Fails without touching the file when it is no ledger, or
  // one of a newer version, and when it cannot be written.
  static Result<Ledger> open_to_write(const std::filesystem::path& path);

  // Fails when there is no ledger.
  static Result<Ledger> open_to_read(const std::filesystem::path& path);

  // Enters photos with their plates, all in one transaction, which is on the disk when this
  // returns. Print files, and files that could not be read, are left out. A result that says less
  // than the present one, without a date or without a judgement of where plates hang, does not
  // replace it. Other processes may write at the same time.
  Result<LedgerTally> enter(const std::string& survey, std::span<const VerifiedFile> files);

  // `last`: the day after which a photo cannot have been taken, as 2026-03-31; `revision`: of the
  // survey now.
  Result<LedgerCounts> count_photos(const std::string& survey, const std::string& last,
                                    const std::string& revision) const;

  // Names of the surveys of which there are photos.
  Result<std::vector<std::string>> surveys() const;

  // Calls `take` with each sighting of the survey's plates, plate by plate.
  Result<void> for_each_sighting(const std::string& survey,
                                 const std::function<void(const PlateSighting&)>& take) const;

 private:
  Ledger(std::filesystem::path path, std::shared_ptr<sqlite3> database)
      : path_(std::move(path)), database_(std::move(database)) {}
  static Result<Ledger> open(const std::filesystem::path& path, int flags);
  Result<void> make_tables() const;
  Result<std::uint32_t> version() const;
  Result<void> write_photo(const std::string& survey, const VerifiedFile& file,
                           const std::string& result) const;
  Result<std::optional<StoredPhoto>> stored_photo(const std::string& survey,
                                                  const std::string& sha256) const;

  std::filesystem::path path_;
  std::shared_ptr<sqlite3> database_;
};

}  // namespace tagsmith::detail
