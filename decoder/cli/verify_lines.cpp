// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_lines.hpp"

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "decoder/grade/symbol_grade.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/verify_rules.hpp"

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
  const auto stale = object.find("stale");
  file.stale = stale != object.end() && stale->is_boolean() && stale->get<bool>();
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

TagStatus status_from(const std::string& name) {
  constexpr std::array kAll{TagStatus::ok,        TagStatus::misprinted, TagStatus::unreadable,
                            TagStatus::duplicate, TagStatus::cut_off,    TagStatus::misplaced,
                            TagStatus::doubtful};
  const auto named = [&](TagStatus status) { return to_string(status) == name; };
  const auto found = std::ranges::find_if(kAll, named);
  return found == kAll.end() ? TagStatus::unknown : *found;
}

constexpr std::size_t kLongestLine = 64U << 20U;  // longer than any of `verify`

// A line without its end, or its first kLongestLine + 1 bytes; nothing at the stream's end.
std::optional<std::string> next_line(std::istream& stream) {
  constexpr int kEnd = std::istream::traits_type::eof();
  std::streambuf& buffer = *stream.rdbuf();
  int next = buffer.sbumpc();
  if (next == kEnd) return std::nullopt;
  std::string line;
  for (; next != kEnd && next != '\n' && line.size() <= kLongestLine; next = buffer.sbumpc()) {
    line += static_cast<char>(next);
  }
  return line;
}

// Where the file's last whole line ends.
Result<off_t> end_of_lines(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  if (!stream) return fail(path.string() + ": cannot be read");
  for (off_t at = stream.tellg(); at > 0; --at) {
    stream.seekg(at - 1);
    if (stream.get() == '\n') return at;
  }
  return 0;
}

}  // namespace

VerifiedFile verified_file(const FileReport& report) {
  VerifiedFile file{report.file.string(), report.sha256,
                    report.revision,      {},
                    report.findings,      {report.rules.begin(), report.rules.end()},
                    report.stale};
  for (const TagFinding& tag : report.tags) {
    VerifiedTag found{tag.tag, to_string(tag.status), tag.rule,     tag.message,
                      "",      tag.crop_file,         std::nullopt, ""};
    if (const VerifyRule* rule = find_verify_rule(tag.rule)) found.remedy = rule->remedy;
    if (tag.grade) found.grade = tag.grade->grade;
    if (tag.grade && tag.grade->grade < 4) found.blame = to_string(tag.grade->worst);
    file.tags.push_back(std::move(found));
  }
  return file;
}

FileReport counted_report(const VerifiedFile& file) {
  FileReport report;
  report.file = file.file;
  report.findings = file.findings;
  report.stale = file.stale;
  for (const VerifiedTag& tag : file.tags) {
    TagFinding finding;
    finding.status = status_from(tag.status);
    finding.tag = tag.tag;
    report.tags.push_back(std::move(finding));
  }
  return report;
}

Result<VerifyLineCounts> read_verify_lines(const std::filesystem::path& path,
                                           const std::function<void(const VerifiedFile&)>& take) {
  std::ifstream stream(path);
  if (!stream || std::filesystem::is_directory(path)) {
    return fail(path.string() + ": cannot be read, expected the output of `verify --json`");
  }
  VerifyLineCounts counts;
  while (const std::optional<std::string> read = next_line(stream)) {
    const std::string& line = *read;
    if (line.size() > kLongestLine) {
      return fail(path.string() +
                  ": a line of more than 64 MiB, expected the output of `verify --json`");
    }
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
  return counts;
}

void tell_broken_lines(const std::string& file, const VerifyLineCounts& counts) {
  if (counts.broken == 0) return;
  fmt::print(stderr, "{}: {} not of `verify --json` and left out\n", file,
             counts.broken == 1 ? "1 line is" : fmt::format("{} lines are", counts.broken));
}

Result<void> prepare_to_append(const std::filesystem::path& path) {
  struct stat file {};
  struct stat output {};
  if (::stat(path.c_str(), &file) != 0 || ::fstat(STDOUT_FILENO, &output) != 0) return {};
  if (file.st_dev != output.st_dev || file.st_ino != output.st_ino) return {};
  const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
  if (flags < 0 || (flags & O_APPEND) == 0) {
    return fail(path.string() +
                ": is overwritten by this run's output, expected `>>` instead of `>`");
  }
  const Result<off_t> end = end_of_lines(path);
  if (!end) return fail(end.error().message);
  if (*end != file.st_size && ::ftruncate(STDOUT_FILENO, *end) != 0) {
    return fail(path.string() + ": its last line is cut short and cannot be removed");
  }
  return {};
}

}  // namespace tagsmith
