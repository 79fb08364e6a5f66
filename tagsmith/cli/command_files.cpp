// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/command_files.hpp"

#include <set>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/staged_files.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

// A key that is the same for all names of an existing file: device and inode. Empty if it does not
// exist.
std::string identity_of(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return fmt::format("{}:{}", status.st_dev, status.st_ino);
}

fs::path folder_of(const fs::path& file) {
  const fs::path folder = file.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

// For a file that does not exist: its path without detours.
std::string identity_or_name(const fs::path& path) {
  std::string identity = identity_of(path);
  if (!identity.empty()) return identity;
  std::error_code ignored;
  const fs::path target = behind_links(path);
  return (fs::weakly_canonical(folder_of(target), ignored) / target.filename()).string();
}

}  // namespace

void CommandFiles::reads(const fs::path& path, const std::string& role) {
  if (const std::string identity = identity_of(path); !identity.empty()) {
    inputs_.emplace(identity, NamedFile{path, role});
  }
}

void CommandFiles::reads(const Survey& survey) {
  reads(survey.file, "the survey");
  reads(survey.tag_template.file, "the survey's template");
  reads(survey.tag_template.logo.file, "the template's logo");
}

void CommandFiles::reads(const Rig& rig) {
  reads(rig.file, "the rig");
  for (const RigCamera& camera : rig.cameras) reads(camera.calibration, "a calibration of the rig");
}

void CommandFiles::reads(const Run& run) {
  reads(run.file, "the run");
  for (const Measurement& measurement : run.measurements) {
    for (const auto& [name, seen] : measurement.cameras) reads(seen.image, "a photo of the run");
  }
}

void CommandFiles::writes(const fs::path& path, const std::string& role) {
  if (!path.empty()) outputs_.push_back({path, role});
}

void CommandFiles::writes_into(const fs::path& folder, const std::string& role) {
  if (!folder.empty()) folders_.push_back({folder, role});
}

Result<void> CommandFiles::check() const {
  std::map<std::string, const NamedFile*> outputs;
  for (const NamedFile& output : outputs_) {
    if (is_stream(output.path)) continue;
    if (output.path == "-") {
      return fail(
          fmt::format("{} -: expected the name of a file; /dev/stdout is standard output, "
                      "./- a file of that name",
                      output.role));
    }
    if (auto spares = check_no_input(output.path, output.role); !spares) return spares;
    const auto [other, is_new] = outputs.emplace(identity_or_name(output.path), &output);
    if (is_new) continue;
    return fail(fmt::format("{} {}: is {} {}, too; give each output a name of its own", output.role,
                            output.path.string(), other->second->role,
                            other->second->path.string()));
  }
  return check_folders();
}

Result<void> CommandFiles::check_no_input(const fs::path& output, const std::string& role) const {
  const auto input = is_stream(output) ? inputs_.end() : inputs_.find(identity_of(output));
  if (input == inputs_.end()) return {};
  return fail(fmt::format("{} {}: would replace {} {}, which is read; give the output another name",
                          role, output.string(), input->second.role, input->second.path.string()));
}

// By creating a file in its place, and removing it.
Result<void> CommandFiles::check_folders() const {
  std::set<fs::path> checked;
  std::error_code ignored;
  const auto check = [&](const fs::path& folder, const std::string& role) -> Result<void> {
    if (!checked.insert(folder).second) return {};
    const Result<StagedFiles> place = StagedFiles::begin(folder);
    return place ? Result<void>{} : fail(role + ": " + place.error().message);
  };
  for (const NamedFile& folder : folders_) {
    if (auto made = check(folder.path, folder.role); !made) return made;
  }
  for (const NamedFile& output : outputs_) {
    if (is_stream(output.path)) continue;
    const fs::path target = behind_links(output.path);
    if (fs::is_directory(target, ignored)) {
      return fail(
          fmt::format("{} {}: is a folder, expected a file", output.role, output.path.string()));
    }
    if (is_write_protected(target)) {
      return fail(
          fmt::format("{} {}: is write-protected, and would be replaced; allow writing to "
                      "it, or give the output another name",
                      output.role, output.path.string()));
    }
    if (auto made = check(folder_of(target), output.role); !made) return made;
  }
  return {};
}

Result<void> publish_files(const std::vector<SheetFile>& files) {
  std::map<fs::path, StagedFiles> folders;
  for (const SheetFile& file : files) {
    if (is_stream(file.path)) continue;
    const fs::path target = behind_links(file.path);
    const fs::path folder = folder_of(target);
    if (!folders.contains(folder)) {
      Result<StagedFiles> staged = StagedFiles::begin(folder);
      if (!staged) return fail(staged);
      folders.emplace(folder, std::move(*staged));
    }
    if (auto added = folders.at(folder).add(target.filename(), file.bytes); !added) return added;
  }
  for (const SheetFile& file : files) {
    if (!is_stream(file.path)) continue;
    if (auto written = write_file(file.path, file.bytes); !written) return written;
  }
  for (auto& [folder, staged] : folders) {
    if (auto published = staged.publish(); !published) return published;
  }
  return {};
}

}  // namespace tagsmith::detail
