// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith {
namespace {

using Json = nlohmann::ordered_json;

// Rounded so that the shortest text of the number has that many decimals.
double with_decimals(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

// Rounded to that many digits.
double with_digits(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return 0;
  return with_decimals(value,
                       digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
}

std::string check_digit_name(bool sum10_holds, bool gs1_holds) {
  if (sum10_holds && gs1_holds) return "both";
  if (sum10_holds) return "sum10";
  return gs1_holds ? "gs1" : "none";
}

Json to_json(const FrameCorners& corners) {
  Json list = Json::array();
  for (const PixelPoint& corner : corners) {
    list.push_back({with_decimals(corner.x, 3), with_decimals(corner.y, 3)});
  }
  return list;
}

Json to_json(const Reading& reading, const std::vector<Survey>& surveys) {
  return {{"digits", to_string(reading.digits)},
          {"check_digit", check_digit_name(reading)},
          {"position", coded_position(reading.digits, surveys)},
          {"corners", to_json(reading.corners)},
          {"module_px", with_decimals(reading.module_px, 3)},
          {"confidence", reading.confidence},
          {"method", to_string(reading.method)}};
}

Json to_json(const FramelessReading& reading, const std::vector<Survey>& surveys) {
  return {{"digits", to_string(reading.digits)},
          {"check_digit", check_digit_name(reading)},
          {"position", coded_position(reading.digits, surveys)},
          {"corners", nullptr},
          {"bars", to_json(reading.bars)},
          {"module_px", with_decimals(reading.module_px, 3)},
          {"confidence", reading.confidence},
          {"method", "frameless"}};
}

// What was measured, as a share (widths: modules); nothing where grading has no single number.
std::optional<double> value_of(const ScanParameters& scan, GradeParameter parameter) {
  switch (parameter) {
    case GradeParameter::decode:
      return std::nullopt;
    case GradeParameter::symbol_contrast:
      return scan.symbol_contrast;
    case GradeParameter::minimum_reflectance:
      return scan.least_reflectance;
    case GradeParameter::minimum_edge_contrast:
      return scan.minimum_edge_contrast;
    case GradeParameter::modulation:
      return scan.modulation;
    case GradeParameter::defects:
      return scan.defects;
    case GradeParameter::decodability:
      return scan.decodability;
    case GradeParameter::quiet_zone:
      return scan.quiet_zone;
  }
  return std::nullopt;
}

// Means over the scans, of the parameters that were graded.
Json grade_parameters(const SymbolGrade& grade) {
  Json object = Json::object();
  for (std::size_t i = 0; i < kGradeParameters; ++i) {
    const auto parameter = static_cast<GradeParameter>(i);
    double value = 0;
    double points = 0;
    bool graded = !grade.scans.empty();
    for (const ScanGrade& scan : grade.scans) {
      graded = graded && scan.grades[i].has_value();
      points += scan.grades[i].value_or(0);
      value += value_of(scan.parameters, parameter).value_or(0);
    }
    if (!graded) continue;
    const auto count = static_cast<double>(grade.scans.size());
    Json entry{{"grade", with_decimals(points / count, 2)}};
    if (value_of(grade.scans.front().parameters, parameter)) {
      entry["value"] = with_decimals(value / count, 4);
    }
    object[to_string(parameter)] = std::move(entry);
  }
  return object;
}

void add_grade(const TagFinding& tag, Json& object) {
  if (!tag.grade && tag.grade_reason.empty()) return;
  if (!tag.grade) {
    object["grade"] = nullptr;
    object["grade_reason"] = tag.grade_reason;
    return;
  }
  object["grade"] = with_decimals(tag.grade->grade, 1);
  if (tag.grade->grade < 4) object["grade_blame"] = to_string(tag.grade->worst);
  object["grade_absolute"] = tag.grade->absolute;
  object["grade_parameters"] = grade_parameters(*tag.grade);
}

std::string name_of(HangVerdict verdict) {
  switch (verdict) {
    case HangVerdict::fits:
      return "fits";
    case HangVerdict::off:
      return "off";
    case HangVerdict::doubtful:
      return "doubtful";
    case HangVerdict::unchecked:
      break;
  }
  return "unchecked";
}

Json to_json(const HungTag& hung) {
  Json object{{"verdict", name_of(hung.verdict)}, {"stations", hung.stations}};
  if (!hung.rivals.empty()) object["rivals"] = hung.rivals;
  const bool measured = hung.verdict != HangVerdict::unchecked && hung.offset.sigma.norm() > 0;
  if (!measured) return object;
  const auto triple = [](const Eigen::Vector3d& values, double unit, int decimals) {
    Json list = Json::array();
    for (const double value : values) list.push_back(with_decimals(unit * value, decimals));
    return list;
  };
  const double to_degrees = degrees(1);
  object["offset_mm"] = triple(hung.offset.value, 1e3, 2);
  object["offset_sigma_mm"] = triple(hung.offset.sigma, 1e3, 2);
  object["turn_deg"] = triple(hung.turn.value, to_degrees, 3);
  object["turn_sigma_deg"] = triple(hung.turn.sigma, to_degrees, 3);
  return object;
}

Json to_json(const std::vector<HungTag>& tags) {
  Json list = Json::array();
  for (const HungTag& tag : tags) {
    Json object{{"tag", tag.tag}};
    object.update(to_json(tag));
    if (!tag.message.empty()) object["message"] = tag.message;
    if (!tag.rule.empty()) object["rule"] = tag.rule;
    list.push_back(std::move(object));
  }
  return list;
}

// The lower half, row by row. The digits leave what a fit needs of it.
Json to_json(const CornerCovariance& covariance) {
  Json list = Json::array();
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      list.push_back(with_digits(covariance(row, column), 6));
    }
  }
  return list;
}

Json to_json(const TagFinding& tag) {
  Json object{{"tag", tag.tag.empty() ? Json() : Json(tag.tag)},
              {"status", to_string(tag.status)},
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
  if (!tag.message.empty()) object["message"] = tag.message;
  if (!tag.rule.empty()) object["rule"] = tag.rule;
  if (const VerifyRule* rule = find_verify_rule(tag.rule)) object["remedy"] = rule->remedy;
  if (!tag.crop_file.empty()) object["crop"] = tag.crop_file;
  if (tag.hung) object["hanging"] = to_json(*tag.hung);
  return object;
}

void add_hanging(const std::optional<HungTags>& hung, Json& summary) {
  if (!hung) return;
  summary["hanging"] = to_json(hung->tags);
  Json unplaced = Json::array();
  for (const UnplacedTags& photos : hung->unplaced) {
    unplaced.push_back({{"station", photos.station}, {"tags", to_json(photos.tags)}});
  }
  summary["hanging_unplaced"] = std::move(unplaced);
  summary["hanging_notes"] = hung->notes;
  summary["assumed"] = hung->assumed;
}

Json to_json(const VerifySummary& summary) {
  return {{"files", summary.files},
          {"files_with_findings", summary.files_with_findings},
          {"ok", summary.ok},
          {"unknown", summary.unknown},
          {"misprinted", summary.misprinted},
          {"unreadable", summary.unreadable},
          {"duplicate", summary.duplicate},
          {"cut_off", summary.cut_off},
          {"misplaced", summary.misplaced},
          {"doubtful", summary.doubtful},
          {"stale", summary.stale},
          {"missing", summary.missing}};
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

Json completeness_json(const Survey& survey, const VerifyMerge& merged) {
  const Completeness covered = completeness_of(survey, merged);
  Json unseen = Json::array();
  for (const UnseenStretch& stretch : covered.unseen) unseen.push_back(unseen_json(stretch));
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
  return {
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
      {"unseen", unseen},
      {"by_tag", tags}};
}

Json notes_json(const VerifyMerge& merged) {
  Json notes = Json::array();
  for (const NoteRecord& note : merged.notes) {
    notes.push_back({{"file", note.file}, {"note", note.note}});
  }
  if (const std::string up = noted_up_in_words(merged.noted_up); !up.empty()) {
    notes.push_back({{"file", nullptr}, {"note", up}});
  }
  return notes;
}

std::string line_of(const Json& object) {
  return object.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

GridPoint coded_position(const Digits& digits, const std::vector<Survey>& surveys) {
  PositionCode code;
  for (const Survey& survey : surveys) {
    if (find_tag(survey, digits) != nullptr) code = survey.code;
  }
  GridPoint position = decode_position(code, digits);
  for (double& coordinate : position) coordinate = with_decimals(coordinate, 6);
  return position;
}

std::string check_digit_name(const Reading& reading) {
  return check_digit_name(reading.sum10_holds, reading.gs1_holds);
}

std::string check_digit_name(const FramelessReading& reading) {
  return check_digit_name(reading.sum10_holds, reading.gs1_holds);
}

std::string to_json_line(const ImageReadings& readings, const std::vector<Survey>& surveys) {
  Json tags = Json::array();
  for (const Reading& reading : readings.result.tags) tags.push_back(to_json(reading, surveys));
  for (const FramelessReading& reading : readings.result.frameless.read) {
    tags.push_back(to_json(reading, surveys));
  }
  Json rejected = Json::array();
  for (const Rejection& rejection : readings.result.rejected) {
    rejected.push_back({{"reason", describe(rejection)}, {"corners", to_json(rejection.corners)}});
  }
  for (const FramelessRejection& rejection : readings.result.frameless.rejected) {
    rejected.push_back({{"reason", "no frame: " + describe(rejection)},
                        {"corners", nullptr},
                        {"bars", to_json(rejection.symbol.bars)}});
  }
  return line_of({{"image", readings.image.string()},
                  {"width", readings.width},
                  {"height", readings.height},
                  {"tags", tags},
                  {"rejected", rejected},
                  {"time_ms", with_decimals(readings.time_ms, 3)}});
}

std::string to_json_line(const FileReport& report) {
  Json tags = Json::array();
  for (const TagFinding& tag : report.tags) tags.push_back(to_json(tag));
  Json object{{"file", report.file.string()}, {"tags", tags}, {"findings", report.findings}};
  if (!report.sha256.empty()) object["sha256"] = report.sha256;
  if (!report.revision.empty()) object["revision"] = report.revision;
  if (!report.rules.empty()) object["rules"] = report.rules;
  if (report.pages > 0) object["pages"] = report.pages;
  if (report.width > 0) {
    object["width"] = report.width;
    object["height"] = report.height;
  }
  if (report.orientation) object["orientation"] = *report.orientation;
  if (!report.tags.empty()) object["up"] = to_string(report.up);
  if (!report.notes.empty()) object["notes"] = report.notes;
  if (!report.picture_file.empty()) object["picture"] = report.picture_file;
  if (report.stale) object["stale"] = true;
  return line_of(object);
}

std::string to_json_line(const VerifySummary& summary) {
  return line_of({{"summary", to_json(summary)}});
}

std::string to_json_line(const VerifySummary& summary, const Survey& survey,
                         const VerifyMerge& merged, const std::optional<HungTags>& hung,
                         const SkippedFiles& skipped) {
  Json object = to_json(summary);
  object["skipped"] = skipped;
  object["completeness"] = completeness_json(survey, merged);
  object["placement"] = placement_checked(completeness_of(survey, merged));
  add_hanging(hung, object);
  return line_of({{"summary", object}});
}

std::string report_json_line(const Survey& survey, const VerifyMerge& merged,
                             const std::optional<HungTags>& hung) {
  Json object{{"files", merged.files},
              {"faults", merged.fault_count},
              {"repeated", merged.repeated},
              {"other_revisions", merged.other_revisions},
              {"notes", notes_json(merged)},
              {"completeness", completeness_json(survey, merged)},
              {"placement", placement_checked(completeness_of(survey, merged))}};
  add_hanging(hung, object);
  return line_of({{"summary", object}});
}

}  // namespace tagsmith
