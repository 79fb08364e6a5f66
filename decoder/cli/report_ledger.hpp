// SPDX-License-Identifier: Apache-2.0
// `report --ledger`: what to do about which plate, from all photos that were ever entered.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "decoder/ledger/ledger.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

class CommandFiles;

struct LedgerOptions {
  std::string survey;
  std::vector<std::string> lines;  // of `verify --json`, entered before
  std::string ledger;
  std::string html;  // empty = no page
  bool json = false;
};

// Names the ledger and what SQLite writes beside it as outputs of the command.
void add_ledger_files(const std::string& ledger, CommandFiles& files);

// Enters photos as they arrive, those of one second in one transaction, because each takes some
// twenty milliseconds until it is on the disk. What a killed run did not enter is entered by the
// next one.
class LedgerWriter {
 public:
  // Without a ledger where `path` is empty.
  static Result<LedgerWriter> open(const std::string& path, const std::string& survey);

  // The first failure is returned once, and ends the writing.
  Result<void> add(const VerifiedFile& file);
  Result<void> flush();

  // On standard error, what was entered.
  void print_tally() const;

 private:
  std::string path_;
  std::string survey_;
  std::optional<Ledger> ledger_;
  std::vector<VerifiedFile> waiting_;
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
  LedgerTally tally_;
};

// The exit code: 1 when something must be done now.
Result<int> report_ledger(const LedgerOptions& options);

}  // namespace tagsmith::detail
