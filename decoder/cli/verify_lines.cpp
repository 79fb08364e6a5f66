// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "decoder/grade/symbol_grade.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/cli/console.hpp"

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

// A whole number of a picture's: at most this many pixels wide, or nothing.
int size_of(const json& object, const char* key) {
  constexpr int kMost = 1'000'000;
  const auto value = object.find(key);
  if (value == object.end() || !value->is_number_unsigned()) return 0;
  const auto size = value->get<std::uint64_t>();
  return size <= kMost ? static_cast<int>(size) : 0;
}

// As many numbers as asked for, finite and of a size that pixels have; nothing else.
std::optional<std::vector<double>> numbers_of(const json& list, std::size_t count) {
  constexpr double kMost = 1e7;
  if (!list.is_array() || list.size() != count) return std::nullopt;
  std::vector<double> numbers;
  for (const json& item : list) {
    if (!item.is_number() || !(std::abs(item.get<double>()) < kMost)) return std::nullopt;
    numbers.push_back(item.get<double>());
  }
  return numbers;
}

std::optional<FrameCorners> corners_of(const json& tag) {
  const auto list = tag.find("corners");
  if (list == tag.end() || !list->is_array() || list->size() != 4) return std::nullopt;
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = numbers_of((*list)[i], 2);
    if (!pixel) return std::nullopt;
    corners[i] = {(*pixel)[0], (*pixel)[1]};
  }
  return corners;
}

// Zero where there is none, or what is there is no covariance.
CornerCovariance covariance_of(const json& tag) {
  constexpr std::size_t kHalf = 36;
  const auto list = tag.find("corner_covariance");
  const auto numbers = list == tag.end() ? std::nullopt : numbers_of(*list, kHalf);
  if (!numbers) return CornerCovariance::Zero();
  CornerCovariance covariance;
  std::size_t at = 0;
  for (Eigen::Index row = 0; row < 8; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      covariance(row, column) = covariance(column, row) = (*numbers)[at++];
    }
  }
  const Eigen::LLT<CornerCovariance> root(covariance);
  return root.info() == Eigen::Success ? covariance : CornerCovariance::Zero();
}

// What the line says of where the tag hangs.
void read_hanging(const json& tag, VerifiedTag& found) {
  const auto hanging = tag.find("hanging");
  if (hanging == tag.end() || !hanging->is_object()) return;
  const std::string verdict = text_of(*hanging, "verdict");
  found.of_hanging = verdict == "off" || verdict == "doubtful";
  found.fits = verdict == "fits";
  found.is_placed = found.of_hanging || found.fits;
}

void take_hanging(const TagFinding& tag, VerifiedTag& found) {
  found.fits = tag.hung && tag.hung->verdict == HangVerdict::fits;
  found.is_placed = tag.hung && tag.hung->verdict != HangVerdict::unchecked;
}

UpSource up_from(const std::string& name) {
  constexpr std::array kAll{UpSource::page, UpSource::rig, UpSource::camera, UpSource::doubted};
  const auto named = [&](UpSource source) { return to_string(source) == name; };
  const auto found = std::ranges::find_if(kAll, named);
  return found == kAll.end() ? UpSource::unknown : *found;
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
  file.width = size_of(object, "width");
  file.height = size_of(object, "height");
  if (const int orientation = size_of(object, "orientation");
      orientation >= 1 && orientation <= 8) {
    file.orientation = orientation;
  }
  file.up = up_from(text_of(object, "up"));
  file.notes = texts_of(object, "notes");
  file.picture = text_of(object, "picture");
  for (const json& tag : *tags) {
    if (!tag.is_object()) return std::nullopt;
    VerifiedTag found{text_of(tag, "tag"),    text_of(tag, "status"),
                      text_of(tag, "rule"),   text_of(tag, "message"),
                      text_of(tag, "remedy"), text_of(tag, "crop"),
                      std::nullopt,           text_of(tag, "grade_blame")};
    const auto grade = tag.find("grade");
    if (grade != tag.end() && grade->is_number()) found.grade = grade->get<double>();
    read_hanging(tag, found);
    found.is_read = !text_of(tag, "digits").empty();
    if (file.width > 0) found.corners = corners_of(tag);
    if (found.corners && found.is_read) found.covariance = covariance_of(tag);
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
  VerifiedFile file{report.file.string(),
                    report.sha256,
                    report.revision,
                    {},
                    report.findings,
                    {report.rules.begin(), report.rules.end()},
                    report.stale,
                    report.width,
                    report.height,
                    report.orientation,
                    report.up,
                    report.notes,
                    report.picture_file};
  for (const TagFinding& tag : report.tags) {
    VerifiedTag found{tag.tag, to_string(tag.status), tag.rule,     tag.message,
                      "",      tag.crop_file,         std::nullopt, ""};
    if (const VerifyRule* rule = find_verify_rule(tag.rule)) found.remedy = rule->remedy;
    if (tag.grade) found.grade = tag.grade->grade;
    if (tag.grade && tag.grade->grade < 4) found.blame = to_string(tag.grade->worst);
    take_hanging(tag, found);
    found.is_read = tag.digits.has_value();
    if (report.width > 0) found.corners = tag.corners;
    if (found.corners && found.is_read) found.covariance = tag.corner_covariance;
    file.tags.push_back(std::move(found));
  }
  return file;
}

FileReport report_of(const VerifiedFile& file) {
  FileReport report;
  report.file = file.file;
  report.sha256 = file.sha256;
  report.revision = file.revision;
  report.findings = file.findings;
  report.rules = {file.rules.begin(), file.rules.end()};
  report.stale = file.stale;
  report.width = file.width;
  report.height = file.height;
  report.orientation = file.orientation;
  report.up = file.up;
  report.notes = file.notes;
  report.picture_file = file.picture;
  for (const VerifiedTag& tag : file.tags) {
    TagFinding finding;
    finding.status = status_from(tag.status);
    finding.tag = tag.tag;
    finding.rule = tag.rule;
    finding.message = tag.message;
    finding.crop_file = tag.crop;
    finding.corners = tag.corners.value_or(FrameCorners{});
    finding.corner_covariance = tag.covariance;
    report.tags.push_back(std::move(finding));
  }
  return report;
}

void take_findings(const FileReport& report, VerifiedFile& file) {
  file.findings = report.findings;
  file.rules = {report.rules.begin(), report.rules.end()};
  file.up = report.up;
  file.notes = report.notes;
  for (std::size_t i = 0; i < file.tags.size(); ++i) {
    VerifiedTag& tag = file.tags[i];
    tag.status = to_string(report.tags[i].status);
    tag.rule = report.tags[i].rule;
    tag.message = report.tags[i].message;
    take_hanging(report.tags[i], tag);
    const VerifyRule* rule = find_verify_rule(tag.rule);
    tag.remedy = rule == nullptr ? "" : rule->remedy;
  }
}

void forget_hanging(VerifiedFile& file) {
  for (VerifiedTag& tag : file.tags) {
    if (!tag.of_hanging) continue;
    tag.of_hanging = false;
    std::erase(file.findings, tag.status + ": " + tag.message);
    const std::string rule = tag.rule;
    tag.status = to_string(TagStatus::ok);
    tag.rule.clear();
    tag.message.clear();
    tag.remedy.clear();
    if (std::ranges::find(file.tags, rule, &VerifiedTag::rule) == file.tags.end()) {
      std::erase(file.rules, rule);
    }
  }
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
  to_stderr("{}: {} not of `verify --json` and left out\n", file,
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
