// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <exception>
#include <fstream>
#include <set>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>

#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using nlohmann::json;

// --- writing ---

void add_grade(const VerifiedTag& tag, Json& object) {
  if (!tag.grade && tag.grade_reason.empty()) return;
  object["grade"] = tag.grade ? Json(with_decimals(tag.grade->grade, 1)) : Json();
  if (!tag.grade) {
    object["grade_reason"] = tag.grade_reason;
    return;
  }
  if (tag.grade->grade < 4) object["grade_blame"] = to_string(tag.grade->worst);
  object["grade_absolute"] = tag.grade->absolute;
  Json& parameters = object["grade_parameters"] = Json::object();
  for (std::size_t i = 0; i < kGradeParameters; ++i) {
    const auto& mean = tag.grade->means[i];
    if (!mean) continue;
    Json& entry = parameters[to_string(static_cast<GradeParameter>(i))];
    entry["grade"] = with_decimals(mean->grade, 2);
    if (mean->value) entry["value"] = with_decimals(*mean->value, 4);
  }
}

Json hanging_of(const HungTag& hung) {
  Json object{{"verdict", to_string(hung.verdict)}, {"stations", hung.stations}};
  if (!hung.rivals.empty()) object["rivals"] = hung.rivals;
  if (hung.verdict == HangVerdict::off) object["odds"] = with_decimals(hung.odds, 1);
  if (!hung.placed.empty()) object["placed"] = hung.placed;
  const bool measured = hung.verdict != HangVerdict::unchecked && hung.offset.sigma.norm() > 0;
  if (!measured) return object;
  const auto triple = [](const Eigen::Vector3d& values, double unit, int decimals) {
    return json_list(values, [&](double value) { return with_decimals(unit * value, decimals); });
  };
  object["offset_mm"] = triple(hung.offset.value, 1e3, 2);
  object["offset_sigma_mm"] = triple(hung.offset.sigma, 1e3, 2);
  object["turn_deg"] = triple(hung.turn.value, degrees(1), 3);
  object["turn_sigma_deg"] = triple(hung.turn.sigma, degrees(1), 3);
  return object;
}

Json to_json(const std::vector<HungTag>& tags) {
  Json list = Json::array();
  for (const HungTag& tag : tags) {
    Json object{{"tag", tag.tag}};
    object.update(hanging_of(tag));
    if (!tag.message.empty()) object["message"] = tag.message;
    if (!tag.rule.empty()) object["rule"] = tag.rule;
    list.push_back(std::move(object));
  }
  return list;
}

Json to_json(const FrameCorners& corners) {
  return json_list(corners, [](const PixelPoint& corner) -> Json {
    return {with_decimals(corner.x, 3), with_decimals(corner.y, 3)};
  });
}

// The lower half, row by row, with as many digits as a fit needs.
Json to_json(const CornerCovariance& covariance) {
  Json list = Json::array();
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      list.push_back(with_digits(covariance(row, column), 6));
    }
  }
  return list;
}

Json to_json(const VerifiedTag& tag) {
  Json object{{"tag", tag.tag.empty() ? Json() : Json(tag.tag)},
              {"status", to_string(tag.finding.status)},
              {"digits", tag.digits ? Json(to_string(*tag.digits)) : Json()},
              {"corners", to_json(tag.corners)}};
  if (tag.digits) {
    object["module_px"] = with_decimals(tag.module_px, 3);
    object["confidence"] = tag.confidence;
  }
  if (tag.digits && tag.page == 0 && !tag.corner_covariance.isZero(0)) {
    object["corner_covariance"] = to_json(tag.corner_covariance);
  }
  add_grade(tag, object);
  if (tag.page > 0) object["page"] = tag.page;
  if (!tag.finding.message.empty()) object["message"] = tag.finding.message;
  if (!tag.finding.rule.empty()) object["rule"] = tag.finding.rule;
  if (const Rule* rule = find_verify_rule(tag.finding.rule)) object["remedy"] = rule->remedy;
  if (!tag.picture.file.empty()) object["crop"] = tag.picture.file;
  if (tag.hung) object["hanging"] = hanging_of(*tag.hung);
  if (!tag.in_place_of.empty()) object["in_place_of"] = tag.in_place_of;
  return object;
}

Json lens_of(const PhotoLens& lens) {
  Json object{{"name", lens.camera}, {"focal_35_mm", lens.focal_35_mm}};
  if (lens.focal_mm > 0) object["focal_mm"] = lens.focal_mm;
  return object;
}

Json to_json(const VerifiedFile& file) {
  Json tags = Json::array();
  for (const VerifiedTag& tag : file.tags) tags.push_back(to_json(tag));
  Json object{
      {"file", file.file.string()}, {"tags", std::move(tags)}, {"findings", findings_of(file)}};
  if (!file.sha256.empty()) object["sha256"] = file.sha256;
  if (!file.revision.empty()) object["revision"] = file.revision;
  if (!file.conditions.empty()) object["conditions"] = file.conditions;
  if (const auto rules = rules_of(file); !rules.empty()) object["rules"] = rules;
  if (!file.mixed.empty()) object["mixed"] = file.mixed;
  if (file.pages > 0) object["pages"] = file.pages;
  if (file.is_photo()) {
    object["width"] = file.width;
    object["height"] = file.height;
  }
  if (file.orientation) object["orientation"] = *file.orientation;
  if (file.lens) object["camera"] = lens_of(*file.lens);
  if (!file.taken.empty()) object["taken"] = file.taken;
  if (!file.tags.empty()) object["up"] = to_string(file.up);
  if (!file.notes.empty()) object["notes"] = file.notes;
  if (!file.picture.file.empty()) object["picture"] = file.picture.file;
  if (file.stale) object["stale"] = true;
  return object;
}

// --- summaries ---

void add_hanging(const std::optional<HungTags>& hung, Json& summary) {
  if (!hung) return;
  summary["hanging"] = to_json(hung->tags);
  summary["hanging_unplaced"] = json_list(hung->unplaced, [](const UnplacedTags& photos) -> Json {
    return {{"station", photos.station}, {"tags", to_json(photos.tags)}};
  });
  summary["hanging_notes"] = hung->notes;
  summary["assumed"] = hung->assumed;
}

Json grade_json(const std::optional<double>& grade) {
  return grade ? Json(with_decimals(*grade, 1)) : Json();
}

Json unseen_json(const UnseenStretch& stretch) {
  return {{"side", to_string(stretch.side)},
          {"from", with_decimals(stretch.from, 3)},
          {"to", with_decimals(stretch.to, 3)},
          {"tags", stretch.tags}};
}

void add_completeness(const Survey& survey, const VerifyMerge& merged, Json& summary) {
  const Completeness covered = completeness_of(survey, merged);
  Json tags = Json::array();
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    Json object{{"tag", tag.name},
                {"status", status_of(record)},
                {"seen", record.seen},
                {"faults", record.faults},
                {"best_grade", grade_json(record.best)},
                {"worst_grade", grade_json(record.worst)}};
    if (!record.blame.empty()) object["grade_blame"] = record.blame;
    if (const std::string upright = upright_of(record); !upright.empty()) {
      object["upright"] = upright;
    }
    if (const std::string placement = placement_of(record); !placement.empty()) {
      object["placement"] = placement;
    }
    tags.push_back(std::move(object));
  }
  summary["completeness"] = {
      {"tags", covered.tags},
      {"seen", covered.seen},
      {"share", with_decimals(covered.share(), 4)},
      {"left", {{"tags", covered.left_tags}, {"seen", covered.left_seen}}},
      {"right",
       {{"tags", covered.tags - covered.left_tags}, {"seen", covered.seen - covered.left_seen}}},
      {"ok", covered.ok},
      {"poor", covered.poor},
      {"faulty", covered.faulty},
      {"upright_unchecked", covered.upright_unchecked},
      {"placement_checked", covered.placement_checked},
      {"placement_unchecked", covered.placement_unchecked},
      {"unseen", json_list(covered.unseen, unseen_json)},
      {"by_tag", tags}};
  summary["placement"] = placement_checked(covered);
  if (!covered.another_drive.empty()) summary["another_drive"] = covered.another_drive;
}

Json notes_json(const VerifyMerge& merged) {
  Json notes = json_list(merged.notes, [](const NoteRecord& note) -> Json {
    return {{"file", note.file}, {"note", note.note}};
  });
  if (const std::string up = noted_up_in_words(merged.noted_up); !up.empty()) {
    notes.push_back({{"file", nullptr}, {"note", up}});
  }
  return notes;
}

// --- reading; a value of another type than to_json writes throws ---

// The default where the key is absent or null.
template <class Value>
Value get_or(const json& object, const char* key, Value absent = {}) {
  const auto value = object.find(key);
  if (value == object.end() || value->is_null()) return absent;
  // A conversion of 1e73 to a whole number is undefined.
  constexpr bool kIsWhole = std::integral<Value> && !std::same_as<Value, bool>;
  if (kIsWhole && !value->is_number_integer()) throw std::out_of_range(key);
  return value->get<Value>();
}

// The same for an enumeration of so many values, by name; for an unknown name, too.
template <class Enum>
Enum named_or(const json& object, const char* key, std::size_t count, Enum absent) {
  return value_named<Enum>(get_or<std::string>(object, key), count).value_or(absent);
}

// A number that pixels may have.
double pixels_from(const json& number) {
  constexpr double kMost = 1e7;
  const auto value = number.get<double>();
  if (!(std::abs(value) < kMost)) throw std::out_of_range("pixels");
  return value;
}

FrameCorners corners_from(const json& list) {
  FrameCorners corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = {pixels_from(list.at(i).at(0)), pixels_from(list.at(i).at(1))};
  }
  return corners;
}

// Zero where the value is no covariance.
CornerCovariance covariance_from(const json& list) {
  CornerCovariance covariance = CornerCovariance::Zero();
  std::size_t at = 0;
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      covariance(row, column) = covariance(column, row) = pixels_from(list.at(at++));
    }
  }
  return cholesky_root(covariance) ? covariance : CornerCovariance::Zero();
}

SymbolGrade grade_from(const json& tag) {
  SymbolGrade grade;
  grade.grade = tag.at("grade").get<double>();
  grade.absolute = get_or(tag, "grade_absolute", false);
  const auto blame = get_or<std::string>(tag, "grade_blame");
  const json means = get_or(tag, "grade_parameters", json::object());
  for (std::size_t i = 0; i < kGradeParameters; ++i) {
    const auto parameter = static_cast<GradeParameter>(i);
    if (to_string(parameter) == blame) grade.worst = parameter;
    const auto mean = means.find(to_string(parameter));
    if (mean == means.end()) continue;
    grade.means[i] = {mean->at("grade").get<double>(), std::nullopt};
    if (mean->contains("value")) grade.means[i]->value = mean->at("value").get<double>();
  }
  return grade;
}

HungTag hung_from(const json& object, const VerifiedTag& tag) {
  HungTag hung;
  hung.tag = tag.tag;
  hung.verdict = named_or(object, "verdict", 4, HangVerdict::unchecked);
  hung.stations = get_or(object, "stations", 0);
  hung.rivals = get_or<std::vector<std::string>>(object, "rivals");
  hung.odds = get_or(object, "odds", 0.0);
  hung.placed = get_or<std::string>(object, "placed");
  const auto triple = [&](const char* key, double unit) {
    const auto values = get_or(object, key, std::array<double, 3>{});
    return Eigen::Vector3d(unit * Eigen::Vector3d(values.data()));
  };
  hung.offset = {triple("offset_mm", 1e-3), triple("offset_sigma_mm", 1e-3)};
  hung.turn = {triple("turn_deg", radians(1)), triple("turn_sigma_deg", radians(1))};
  return hung;
}

VerifiedTag tag_from(const json& object) {
  VerifiedTag tag;
  tag.tag = get_or<std::string>(object, "tag");
  tag.finding.status = value_named<TagStatus>(object.at("status").get<std::string>(), kTagStatuses)
                           .value_or(TagStatus::unknown);
  tag.finding.rule = get_or<std::string>(object, "rule");
  tag.finding.message = get_or<std::string>(object, "message");
  // A line without corners is of an older version, and cannot be used as a reading.
  if (object.contains("corners")) {
    tag.corners = corners_from(object["corners"]);
    tag.digits = parse_digits(get_or<std::string>(object, "digits"));
  }
  tag.module_px = get_or(object, "module_px", 0.0);
  tag.confidence = get_or(object, "confidence", 0.0);
  tag.in_place_of = get_or<std::string>(object, "in_place_of");
  tag.page = get_or(object, "page", 0);
  if (object.contains("corner_covariance")) {
    tag.corner_covariance = covariance_from(object["corner_covariance"]);
  }
  if (object.contains("grade") && !object["grade"].is_null()) tag.grade = grade_from(object);
  tag.grade_reason = get_or<std::string>(object, "grade_reason");
  tag.picture.file = get_or<std::string>(object, "crop");
  if (object.contains("hanging")) tag.hung = hung_from(object["hanging"], tag);
  return tag;
}

int size_from(const json& object, const char* key) {
  constexpr std::uint64_t kMost = 1'000'000;
  return static_cast<int>(std::min(kMost, get_or<std::uint64_t>(object, key)));
}

// Nothing for an object that no photo could have given.
std::optional<PhotoLens> lens_from(const json& object) {
  PhotoLens lens{get_or<std::string>(object, "name"), get_or(object, "focal_mm", 0.0),
                 get_or(object, "focal_35_mm", 0.0)};
  constexpr double kMost = 1e5;  // millimetres
  const bool is_sound = !lens.camera.empty() && lens.focal_35_mm > 0 && lens.focal_35_mm < kMost;
  return is_sound ? std::optional(lens) : std::nullopt;
}

VerifiedFile file_from(const json& object) {
  VerifiedFile file{object.at("file").get<std::string>()};
  file.sha256 = get_or<std::string>(object, "sha256");
  file.revision = get_or<std::string>(object, "revision");
  file.conditions = get_or<std::string>(object, "conditions");
  file.pages = size_from(object, "pages");
  file.width = size_from(object, "width");
  file.height = size_from(object, "height");
  const int orientation = get_or(object, "orientation", 0);
  if (orientation >= 1 && orientation <= 8) file.orientation = orientation;
  if (object.contains("camera")) file.lens = lens_from(object["camera"]);
  file.taken = get_or<std::string>(object, "taken");
  if (!is_moment(file.taken)) file.taken.clear();
  for (const json& tag : object.at("tags").get_ref<const json::array_t&>()) {
    file.tags.push_back(tag_from(tag));
  }
  file.findings = get_or<std::vector<std::string>>(object, "findings");
  file.rules = get_or<std::set<std::string>>(object, "rules");
  file.mixed = get_or<std::vector<std::string>>(object, "mixed");
  // The rest concerns the file as a whole.
  for (const VerifiedTag& tag : file.tags) {
    if (!tag.finding.is_fault()) continue;
    const auto of_tag = [&](const std::string& words) { return words.ends_with(in_words(tag)); };
    std::erase_if(file.findings, of_tag);
    file.rules.erase(tag.finding.rule);
  }
  file.stale = get_or(object, "stale", false);
  file.up = named_or(object, "up", kUpSources, UpSource::unknown);
  file.notes = get_or<std::vector<std::string>>(object, "notes");
  file.picture.file = get_or<std::string>(object, "picture");
  return file;
}

std::optional<VerifiedFile> from_object(const json& object) {
  try {
    return file_from(object);
  } catch (const std::exception&) {  // of nlohmann-json, or a number out of range
    return std::nullopt;
  }
}

}  // namespace

std::string to_json_line(const VerifiedFile& file) { return json_text(to_json(file)); }

std::optional<VerifiedFile> verified_file_from(std::string_view line) {
  return from_object(parse_json(line));
}

std::string verify_summary_line(const Survey& survey, const VerifyMerge& merged,
                                const std::optional<HungTags>& hung,
                                const std::map<std::string, std::size_t>& skipped) {
  Json object{{"files", merged.files + merged.repeated},
              {"files_with_findings", merged.files_with_findings}};
  for (std::size_t i = 0; i < kTagStatuses; ++i) {
    object[to_string(static_cast<TagStatus>(i))] = merged.by_status[i];
  }
  object["stale"] = merged.stale;
  object["photos_without_tag"] = merged.without_tag_count;
  object["missing"] = missing_tags(survey, merged);
  object["skipped"] = skipped;
  add_completeness(survey, merged, object);
  add_hanging(hung, object);
  return json_text({{"summary", object}});
}

std::string report_summary_line(const Survey& survey, const VerifyMerge& merged,
                                const std::optional<HungTags>& hung) {
  Json object{{"files", merged.files},
              {"faults", merged.fault_count},
              {"repeated", merged.repeated},
              {"other_revisions", merged.other_revisions},
              {"photos_without_tag", merged.without_tag_count},
              {"notes", notes_json(merged)}};
  add_completeness(survey, merged, object);
  add_hanging(hung, object);
  return json_text({{"summary", object}});
}

Result<VerifyLineCounts> read_verify_lines(const std::filesystem::path& path,
                                           const std::function<void(VerifiedFile)>& take) {
  constexpr std::size_t kLongestLine = 64U << 20U;  // longer than any of `verify`
  std::ifstream stream(path);
  if (!stream || std::filesystem::is_directory(path)) {
    const Result<std::string> why = read_file(path, 0);
    return why ? fail(path.string() + ": cannot be read") : fail(why);
  }
  VerifyLineCounts counts;
  while (const std::optional<std::string> line = read_line(stream, kLongestLine)) {
    if (line->size() > kLongestLine) {
      return fail(path.string() +
                  ": a line of more than 64 MiB, expected the output of `verify --json`");
    }
    if (line->find_first_not_of(" \t\r") == std::string::npos) continue;
    const json object = parse_json(*line);
    if (object.is_object() && object.contains("summary")) continue;
    std::optional<VerifiedFile> file = from_object(object);
    ++(file ? counts.files : counts.broken);
    if (file) take(std::move(*file));
  }
  return counts;
}

}  // namespace tagsmith::detail
