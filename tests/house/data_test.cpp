// SPDX-License-Identifier: Apache-2.0
// Every file in surveys/ and templates/ is used: what is YAML loads, and so does every run; a photo
// belongs to a run.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

namespace fs = std::filesystem;

namespace tagsmith::detail::house {
namespace {

std::vector<fs::path> data_files(const std::string& extension) {
  std::vector<fs::path> files;
  for (const char* folder : {"surveys", "templates"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && (extension.empty() || entry.path().extension() == extension)) {
        files.push_back(entry.path());
      }
    }
  }
  std::ranges::sort(files);
  return files;
}

// A calibration is read with the rig that names it.
bool is_named_by_a_rig(const fs::path& calibration) {
  const std::string name = "calibration: " + calibration.filename().string();
  return std::ranges::any_of(data_files(".yaml"), [&](const fs::path& file) {
    return file.parent_path() == calibration.parent_path() &&
           read_file(file)->find(name) != std::string::npos;
  });
}

// The findings about a YAML file, by the key it begins with.
std::string findings_of(const fs::path& file) {
  const std::string text = *read_file(file);
  const auto has = [&](const std::string& key) {
    return text.starts_with(key) || text.find("\n" + key) != std::string::npos;
  };
  if (has("survey:")) return to_string(read_survey(file)->diagnostics);
  if (has("rig:")) return to_string(read_rig(file)->diagnostics);
  if (has("tag:")) return to_string(read_template(file)->diagnostics);
  if (has("camera_matrix:")) {
    return is_named_by_a_rig(file) ? "" : "is a calibration that no rig beside it names";
  }
  return "is neither a survey nor a rig nor a template nor a calibration";
}

}  // namespace

TEST_CASE("every YAML file that is shipped loads without a finding") {
  const std::vector<fs::path> files = data_files(".yaml");
  CHECK(files.size() >= 8);
  for (const fs::path& file : files) {
    CAPTURE(file.string());
    CHECK(findings_of(file) == "");
  }
}

TEST_CASE("every run that is shipped loads, and every photo belongs to one") {
  std::set<fs::path> used;
  const std::vector<fs::path> files = data_files(".csv");
  CHECK(files.size() >= 3);
  for (const fs::path& file : files) {
    CAPTURE(file.string());
    const Result<Rig> rig = load_rig(file.parent_path() / "rig.yaml");
    REQUIRE(rig.has_value());
    const Result<Run> run = load_run(file, *rig);
    REQUIRE_MESSAGE(run.has_value(), run.error().message);
    CHECK(!run->measurements.empty());
    for (const Measurement& measurement : run->measurements) {
      for (const auto& [camera, seen] : measurement.cameras) {
        if (!seen.image.empty()) used.insert(seen.image.lexically_normal());
      }
    }
  }
  std::set<fs::path> photos;
  for (const fs::path& file : data_files(".jpg")) photos.insert(file);
  CHECK(photos == used);
}

TEST_CASE("the data folders hold nothing else") {
  for (const fs::path& file : data_files("")) {
    const std::string extension = file.extension().string();
    CHECK_MESSAGE((extension == ".yaml" || extension == ".csv" || extension == ".jpg" ||
                   extension == ".json"),
                  file.string());
  }
}

}  // namespace tagsmith::detail::house
