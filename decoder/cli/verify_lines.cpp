// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_lines.hpp"

#include <fstream>

#include <nlohmann/json.hpp>

namespace tagsmith {
namespace {

using nlohmann::json;

std::string text_of(const json& object, const char* key) {
  const auto value = object.find(key);
  return value != object.end() && value->is_string() ? value->get<std::string>() : std::string();
}

std::vector<std::string> texts_of(const json& object, const char* key) {
  std::vector<std::string> texts;
  const auto list = object.find(key);
  if (list == object.end() || !list->is_array()) return texts;
  for (const json& item : *list) {
    if (item.is_string()) texts.push_back(item.get<std::string>());
  }
  return texts;
}

std::optional<VerifiedFile> parse_line(const json& object) {
  if (!object.is_object() || text_of(object, "file").empty()) return std::nullopt;
  const auto tags = object.find("tags");
  if (tags == object.end() || !tags->is_array()) return std::nullopt;
  VerifiedFile file{text_of(object, "file"),      text_of(object, "sha256"),
                    text_of(object, "revision"),  {},
                    texts_of(object, "findings"), texts_of(object, "rules")};
  for (const json& tag : *tags) {
    if (!tag.is_object()) return std::nullopt;
    VerifiedTag found{text_of(tag, "tag"),    text_of(tag, "status"),
                      text_of(tag, "rule"),   text_of(tag, "message"),
                      text_of(tag, "remedy"), text_of(tag, "crop"),
                      std::nullopt,           text_of(tag, "grade_blame")};
    const auto grade = tag.find("grade");
    if (grade != tag.end() && grade->is_number()) found.grade = grade->get<double>();
    file.tags.push_back(std::move(found));
  }
  return file;
}

}  // namespace

Result<VerifyLineCounts> read_verify_lines(const std::filesystem::path& path,
                                           const std::function<void(const VerifiedFile&)>& take) {
  std::ifstream stream(path);
  if (!stream || std::filesystem::is_directory(path)) {
    return fail(path.string() + ": cannot be read, expected the output of `verify --json`");
  }
  VerifyLineCounts counts;
  for (std::string line; std::getline(stream, line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const json object = json::parse(line, nullptr, false);
    if (object.is_object() && object.contains("summary")) continue;
    const std::optional<VerifiedFile> file = parse_line(object);
    if (!file) {
      ++counts.broken;
      continue;
    }
    ++counts.files;
    take(*file);
  }
  if (stream.bad()) return fail(path.string() + ": cannot be read to its end");
  return counts;
}

}  // namespace tagsmith
