// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/point_formats.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/draft/length_units.hpp"
#include "tagsmith/survey/listed_survey.hpp"

namespace tagsmith::detail {
namespace {

// ---- GSI.

struct GsiWord {
  std::string_view index;  // two digits
  char unit = '0';
  bool negative = false;
  std::string_view data;
};

// The word that the line begins with: six characters, a sign, the data, a blank.
std::optional<GsiWord> front_word(std::string_view line, std::size_t data_size) {
  constexpr std::size_t kHead = 7;
  if (line.size() < kHead + data_size || !is_digit(line[0]) || !is_digit(line[1])) {
    return std::nullopt;
  }
  if (line[6] != '+' && line[6] != '-') return std::nullopt;
  return GsiWord{line.substr(0, 2), line[5], line[6] == '-', line.substr(kHead, data_size)};
}

std::string without_zeros(std::string_view data) {
  data = trim(data);
  data.remove_prefix(std::min(data.find_first_not_of('0'), data.size()));
  return std::string(data);
}

// Descriptions are padded with zeros on the left, which hide those of a tag's name.
std::string gsi_description(std::string_view data) {
  std::string text = without_zeros(data);
  const bool is_tag = !text.empty() && (text.back() == 'L' || text.back() == 'R') &&
                      std::all_of(text.begin(), text.end() - 1, is_digit);
  if (is_tag) text.insert(0, 4 - std::min<std::size_t>(4, text.size()), '0');
  return text;
}

// Metres or feet of the last digit; nothing for units of angles.
std::optional<double> last_digit(char unit) {
  static const std::map<char, double> kUnits{
      {'0', 1e-3}, {'1', 1e-3}, {'6', 1e-4}, {'7', 1e-4}, {'8', 1e-5}};
  const auto found = kUnits.find(unit);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

// The twelve digits of a tag, which are padded with zeros; else the text unchanged. Zeros alone are
// an empty word.
std::string gsi_digits(std::string_view data) {
  if (without_zeros(data).empty()) return {};
  constexpr std::size_t kDigits = 12;
  const std::size_t zeros = data.size() - std::min(data.size(), kDigits);
  const bool padded = data.substr(0, zeros).find_first_not_of('0') == std::string_view::npos;
  return std::string(padded ? data.substr(zeros) : data);
}

// The content of one block.
struct GsiBlock {
  std::string name;
  std::optional<std::string> remark;  // word 71
  std::optional<std::string> code;    // word 41
  std::string digits;                 // word 72
  // Words 42 to 49, each without what precedes its sign of equality.
  std::string key;    // word 42
  std::string value;  // the others
  std::array<std::optional<double>, 3> coordinates;
  std::optional<bool> in_feet;  // what the coordinates' words say, the last one
  bool in_two_units = false;    // they differ
};

bool is_feet(char unit) { return unit == '1' || unit == '7'; }

// The word as one of a block's coordinates. False, with a finding, where it is none.
bool put_gsi_length(const GsiWord& word, int number, GsiBlock& block, FindingLog& log) {
  const auto unit = last_digit(word.unit);
  const auto value = parse_number(without_zeros(word.data).empty() ? "0" : word.data);
  if (!unit || !value) {
    log.error({number, 0}, "bad-number",
              fmt::format("word {} is `{}` in unit {}, expected a length", word.index, word.data,
                          word.unit));
    return false;
  }
  const bool in_feet = is_feet(word.unit);
  block.in_two_units = block.in_two_units || block.in_feet.value_or(in_feet) != in_feet;
  block.in_feet = in_feet;
  block.coordinates[static_cast<std::size_t>(word.index[1] - '1')] =
      (word.negative ? -1 : 1) * *value * *unit;
  return true;
}

// What export writes of all tags, into the block's key and value.
void put_listed(const GsiWord& word, GsiBlock& block) {
  const std::size_t sign = word.data.find('=');
  if (word.index[0] != '4' || word.index[1] < '2' || sign == std::string_view::npos) return;
  (word.index == "42" ? block.key : block.value) += word.data.substr(sign + 1);
}

std::optional<GsiBlock> read_block(std::string_view line, int number, FindingLog& log) {
  const bool is_long = line.starts_with('*');
  const std::size_t size = is_long ? 16 : 8;
  if (is_long) line.remove_prefix(1);
  GsiBlock block;
  for (line = trim(line); !line.empty(); line = trim(line)) {
    const auto word = front_word(line, size);
    if (!word) {
      return log.error(
          {number, 0}, "bad-gsi",
          fmt::format("`{}` is no GSI word of {} characters of data", line.substr(0, 24), size),
          "write the file again as GSI-8 or GSI-16");
    }
    if (word->index == "11") block.name = without_zeros(word->data);
    if (word->index == "71") block.remark = gsi_description(word->data);
    if (word->index == "41") block.code = gsi_description(word->data);
    if (word->index == "72") block.digits = gsi_digits(word->data);
    put_listed(*word, block);
    const bool is_length = word->index[0] == '8' && word->index[1] >= '1' && word->index[1] <= '3';
    if (is_length && !put_gsi_length(*word, number, block, log)) return std::nullopt;
    line.remove_prefix(7 + size);
  }
  return block;
}

// ---- RW5.

// For a record: what is behind the head of one of its fields.
std::optional<std::string> rw5_field(const std::vector<std::string>& fields,
                                     std::string_view head) {
  for (const std::string& each : fields) {
    const bool elevation = each.starts_with("EL");
    if (each.starts_with(head) && (elevation == (head == "EL"))) {
      return std::string(trim(std::string_view(each).substr(head.size())));
    }
  }
  return std::nullopt;
}

// Takes the records of a raw file one by one.
class Rw5Points {
 public:
  Rw5Points(RawPoints& result, FindingLog& log) : result_(result), log_(log) {}

  // False when there are too many points.
  bool take(int number, std::string_view line) {
    const std::size_t note = std::min(line.find(",--"), line.size());
    const std::vector<std::string> fields = split(line.substr(0, note), ',');
    const std::string words(note < line.size() ? trim(line.substr(note + 3)) : "");
    if (fields[0] == "MO") take_unit(number, fields);
    if (fields[0] == "SP") return take_point(number, fields, words);
    if (!is_point_description(words)) return true;
    std::optional<std::string> name;
    for (const char* head : {"PN", "FP", "OP"}) {
      if (!name) name = rw5_field(fields, head);
    }
    others_.emplace(name.value_or(""), fields[0]);
    return true;
  }

  void warn_of_rest() const {
    std::map<std::string, int> counts;
    for (const auto& [name, record] : others_) {
      if (!points_.contains(name)) ++counts[record];
    }
    if (counts.empty()) return;
    log_.warning({}, "left-out",
                 "points that no record SP has are left out: " + counted_text(counts),
                 "let the field book compute them, so that they are stored as SP");
  }

 private:
  void take_unit(int number, const std::vector<std::string>& fields) {
    const auto unit = rw5_field(fields, "UN");
    if (!unit) return;
    if (unit_ && *unit_ != *unit) {
      log_.error({number, 0}, "no-units",
                 "the record MO says UN" + unit->substr(0, 20) + ", one before it UN" +
                     unit_->substr(0, 20),
                 "divide the file where its unit changes");
      return;
    }
    unit_ = *unit;
    result_.in_some_feet = *unit == "0";
    if (*unit == "1") result_.metres_per_unit = 1;
    if (*unit == "2") result_.metres_per_unit = kSurveyFoot;
    if (!result_.in_some_feet && !result_.metres_per_unit) result_.unknown_unit = "UN" + *unit;
  }

  bool take_point(int number, const std::vector<std::string>& fields, const std::string& words) {
    const auto number_of = [&](const char* head) {
      return parse_number(rw5_field(fields, head).value_or(""));
    };
    const auto north = number_of("N");
    const auto east = number_of("E");
    const auto height = number_of("EL");
    const std::string name = rw5_field(fields, "PN").value_or("");
    points_.insert(name);
    if (north && east && height) {
      return add_point(result_, {number, name, words, {*east, *north, *height}}, log_);
    }
    log_.error(
        {number, 0}, "bad-number",
        "point " + name.substr(0, 60) + " lacks N, E or EL, expected SP,PN1,N 1,E 1,EL1,--WL");
    return true;
  }

  RawPoints& result_;
  FindingLog& log_;
  std::optional<std::string> unit_;                       // as the first record MO says it
  std::set<std::string> points_;                          // names of those that have a record SP
  std::set<std::pair<std::string, std::string>> others_;  // names and kinds of other records
};

}  // namespace

std::string counted_text(const std::map<std::string, int>& counts) {
  constexpr std::size_t kMost = 10;
  std::string text;
  std::size_t shown = 0;
  for (const auto& [name, count] : counts) {
    if (shown++ == kMost) return text + " ...";
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name.substr(0, 60), count);
  }
  return text;
}

Result<PointFormat> format_of_points(std::string_view text) {
  if (text.starts_with("AutoCAD Binary DXF") || text.starts_with("AC10")) {
    return fail("a binary drawing (DWG or DXF): save it as DXF, ASCII");
  }
  if (text.substr(0, 1024).find('\0') != std::string_view::npos || text.starts_with("\xFF\xFE") ||
      text.starts_with("\xFE\xFF")) {
    return fail("no text in UTF-8: save it as text in UTF-8");
  }
  std::vector<std::string_view> lines;
  for_each_line(text, [&](int, std::string_view line) {
    lines.push_back(trim(line));
    return lines.size() < 100;
  });
  if (lines.empty()) return PointFormat::table;
  if (lines[0].starts_with('<')) {
    const bool landxml = text.substr(0, 4096).find("<LandXML") != std::string_view::npos;
    if (!landxml) return fail("XML, but not LandXML: expected a root element LandXML");
    return PointFormat::landxml;
  }
  if (lines.size() > 1 && (lines[0] == "999" || (lines[0] == "0" && lines[1] == "SECTION"))) {
    return PointFormat::dxf;
  }
  const bool is_long = lines[0].starts_with('*');
  const auto word = front_word(lines[0].substr(is_long ? 1 : 0), is_long ? 16 : 8);
  if (word && (word->index == "11" || word->index == "41")) return PointFormat::gsi;
  const bool rw5 = std::ranges::any_of(lines, [](std::string_view line) {
    return line.starts_with("JB,NM") || line.starts_with("MO,AD") || line.starts_with("SP,PN");
  });
  return rw5 ? PointFormat::rw5 : PointFormat::table;
}

bool add_point(RawPoints& points, RawPoint point, FindingLog& log) {
  if (points.points.size() < kMostPoints) {
    points.points.push_back(std::move(point));
    return true;
  }
  log.error({point.line, 0}, "too-many-points", fmt::format("more than {} points", kMostPoints),
            "divide the file");
  return false;
}

RawPoints gsi_points(std::string_view text, FindingLog& log) {
  RawPoints result;
  std::optional<bool> codes_first;  // by the first block
  std::string code;
  std::size_t uncoded = 0;  // from here on points get the code that follows them
  for_each_line(text, [&](int number, std::string_view line) {
    const auto block = read_block(line, number, log);
    if (!block) return true;
    if (block->code == kListedSurvey) {
      result.listed_line = number;
      result.listed[block->key] = trim(block->value);
      return true;
    }
    if (!codes_first) codes_first = block->code.has_value();
    if (block->code) {
      code = *block->code;
      for (; !*codes_first && uncoded < result.points.size(); ++uncoded) {
        std::string& description = result.points[uncoded].description;
        if (description.empty()) description = code;
      }
    }
    const auto& [x, y, z] = block->coordinates;
    if (!x && !y && !z) return true;
    if (!x || !y || !z) {
      log.error({number, 0}, "bad-number",
                "point " + block->name + " lacks one of words 81, 82, 83",
                "write the file again with east, north and height");
      return true;
    }
    if (block->in_two_units) {
      log.error({number, 0}, "no-units",
                "words 81, 82, 83 of point " + block->name + " are in feet and in metres",
                "write the file again with east, north and height in one unit");
      return false;
    }
    result.in_some_feet = result.in_some_feet || *block->in_feet;
    if (!*block->in_feet) result.metres_per_unit = 1;
    RawPoint point{number, block->name, *codes_first ? code : "", {*x, *y, *z}};
    if (block->remark && !block->remark->empty()) point.description = *block->remark;
    point.digits = block->digits;
    return add_point(result, std::move(point), log);
  });
  if (result.in_some_feet && result.metres_per_unit) {
    log.error({}, "no-units", "some points are in feet and others in metres");
  }
  return result;
}

RawPoints rw5_points(std::string_view text, FindingLog& log) {
  RawPoints result;
  Rw5Points points(result, log);
  for_each_line(text,
                [&](int number, std::string_view line) { return points.take(number, trim(line)); });
  points.warn_of_rest();
  return result;
}

}  // namespace tagsmith::detail
