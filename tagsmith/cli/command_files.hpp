// SPDX-License-Identifier: Apache-2.0
// The files that a command reads and writes: no output is an input or another output.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Collects the files of one command, each with its role there, in the words of messages: "the
// survey", "--html". Empty paths are options that were not given.
class CommandFiles {
 public:
  void reads(const std::filesystem::path& path, const std::string& role);

  // The file and those that it names: template, calibrations, photos.
  void reads(const Survey& survey);
  void reads(const Rig& rig);
  void reads(const Run& run);

  void writes(const std::filesystem::path& path, const std::string& role);

  // A folder for files whose names are not known before the work.
  void writes_into(const std::filesystem::path& folder, const std::string& role);

  // Fails when an output is an input, or another output, by whatever links; when it is a folder,
  // or `-`; and when no file can be created in its folder. Streams never conflict.
  Result<void> check() const;

  // Fails when the file is an input: for outputs whose names become known during the work.
  Result<void> check_no_input(const std::filesystem::path& output, const std::string& role) const;

 private:
  struct NamedFile {
    std::filesystem::path path;
    std::string role;
  };
  Result<void> check_folders() const;

  std::map<std::string, NamedFile> inputs_;  // by device and inode; those that exist
  std::vector<NamedFile> outputs_;
  std::vector<NamedFile> folders_;
};

// Writes the files, those of one folder together or not at all. Links are kept, and streams are
// written as by write_file.
Result<void> publish_files(const std::vector<SheetFile>& files);

}  // namespace tagsmith::detail
