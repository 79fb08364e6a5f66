// SPDX-License-Identifier: Apache-2.0
// What becomes of one mistyped number? Usage: bench_mistyped lists|files [N] [SEED]
//
// lists: surveyed points of N drives, each typed four times with one slip, through `new --from`.
// files: one number of a shipped rig, survey or run, through `localize`; rigs as shipped, and as by
// a data sheet. TAGSMITH_PROGRAM names the executable.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/draws.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using test::Draws;
namespace fs = std::filesystem;

namespace {

// ---- A slip in a number.

struct Typed {
  std::string slip;
  std::string text;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::size_t any_digit(const std::string& text, Draws& draws) {
  std::size_t i = draws.index(text.size());
  while (!is_digit(text[i])) i = draws.index(text.size());
  return i;
}

// As typed with one slip; nothing where that is the same number's text.
std::optional<Typed> slip_once(const std::string& number, Draws& draws) {
  std::string text = number;
  const std::size_t i = any_digit(text, draws);
  std::string slip;
  switch (draws.index(7)) {
    case 0:
    case 1:
      slip = "one digit";
      text[i] = static_cast<char>('0' + draws.index(10));
      break;
    case 2:
      slip = "two digits exchanged";
      if (i + 1 < text.size() && is_digit(text[i + 1])) std::swap(text[i], text[i + 1]);
      break;
    case 3:
      slip = "a digit left out";
      if (text.size() > 1) text.erase(i, 1);
      break;
    case 4:
      slip = "a digit typed twice";
      text.insert(i, 1, text[i]);
      break;
    case 5:
      slip = "the decimal point";
      text = fmt::format("{}", *parse_number(text) * (draws.chance(0.5) ? 10 : 0.1));
      break;
    default:
      slip = "the sign";
      text = text.front() == '-' ? text.substr(1) : "-" + text;
  }
  if (text == number || text == "-") return std::nullopt;
  return Typed{slip, text};
}

Typed mistyped(const std::string& number, Draws& draws) {
  std::optional<Typed> typed;
  while (!typed) typed = slip_once(number, draws);
  return *typed;
}

// ---- Lists of surveyed points.

using Row = std::array<std::string, 5>;  // point, east, north, height, description

struct Drive {
  double length = 0;
  double step = 0;      // between points of a wall
  double tag_step = 0;  // between tags of a wall
  std::vector<CenterlineElement> elements;
};

std::vector<Drive> drives() {
  const double grade = 0.02;
  return {{11, 2, 2, {{11, 0, grade}}},
          {60, 4, 6, {{60, 0, grade}}},
          {80, 4, 6, {{25, 0, grade}, {30, 1 / 25.0, grade}, {25, 0, grade}}},
          {150,
           5,
           8,
           {{30, 0, grade},
            {30, 1 / 40.0, grade},
            {30, 0, grade},
            {30, -1 / 60.0, grade},
            {30, 0, grade}}}};
}

// Walls, tags, floor and roof of a drive anywhere, measured to 5 mm.
std::vector<Row> surveyed(Draws& draws) {
  const std::vector<Drive> all = drives();
  const Drive& drive = all[draws.index(all.size())];
  const Centerline line(
      {draws.uniform(1000, 50'000), draws.uniform(1000, 50'000), draws.uniform(-400, 400)},
      draws.uniform(0, 2 * std::numbers::pi), drive.elements);
  const double half = draws.uniform(1.5, 2.5);
  std::vector<Row> rows;
  const auto add_all = [&](double from, double step, double aside, double up, double up_or_down,
                           const char* description) {
    for (double chainage = from; chainage <= drive.length; chainage += step) {
      const CenterlinePoint at = line.at(chainage);
      Eigen::Vector3d p = at.position + aside * right_of(at.heading) + draws.normals(0.005);
      p.z() += up + draws.uniform(-up_or_down, up_or_down);
      rows.push_back({fmt::format("{}", rows.size() + 1), fmt::format("{:.3f}", p.x()),
                      fmt::format("{:.3f}", p.y()), fmt::format("{:.3f}", p.z()), description});
    }
  };
  add_all(0, drive.step, -half, 1.5, 0.2, "WL");
  add_all(0, drive.step, half, 1.5, 0.2, "WR");
  add_all(1, drive.tag_step, -half, 1.5, 0, "TL");
  add_all(1, drive.tag_step, half, 1.5, 0, "TR");
  add_all(0, drive.step, 0, 0, 0, "FL");
  add_all(0, drive.step, 0, 3, 0, "RF");
  return rows;
}

struct MistypedList {
  std::string slip;
  std::vector<Row> rows;
  std::vector<std::size_t> lines;  // concerned, from 1
};

MistypedList mistyped_list(std::vector<Row> rows, Draws& draws) {
  const std::size_t i = draws.index(rows.size());
  const std::size_t column = 1 + draws.index(3);
  MistypedList list{"", {}, {i + 1}};
  switch (draws.index(12)) {
    case 0:
      list.slip = "east and north exchanged";
      std::swap(rows[i][1], rows[i][2]);
      break;
    case 1: {
      list.slip = "the side, or floor for roof";
      const std::map<std::string, std::string> other{{"WL", "WR"}, {"WR", "WL"}, {"TL", "TR"},
                                                     {"TR", "TL"}, {"FL", "RF"}, {"RF", "FL"}};
      rows[i][4] = other.at(rows[i][4]);
      break;
    }
    case 2:
      list.slip = "a coordinate of the line above";
      rows[i][column] = rows[i - std::min<std::size_t>(i, 1)][column];
      break;
    case 3: {
      list.slip = "two lines exchanged";
      const std::size_t j = draws.index(rows.size());
      std::swap(rows[i], rows[j]);
      list.lines.push_back(j + 1);
      break;
    }
    default: {
      const Typed typed = mistyped(rows[i][column], draws);
      list.slip = typed.slip;
      rows[i][column] = typed.text;
    }
  }
  list.rows = std::move(rows);
  return list;
}

struct Drafted {
  int exit_code = 0;
  std::string said;
  std::optional<Survey> survey;
};

Drafted drafted(const std::vector<Row>& rows) {
  const test::TemporaryFolder folder;
  std::string csv;
  for (const Row& row : rows) csv += fmt::format("{}\n", fmt::join(row, ","));
  const fs::path file = folder.path() / "points.csv";
  if (!write_file(file, csv)) std::abort();
  const fs::path out = folder.path() / "drive";
  const test::ProgramOutput ran = test::run_tagsmith(
      fmt::format("new '{}' --from '{}' --order PENZD", out.string(), file.string()));
  Drafted result{ran.exit_code, ran.err, {}};
  if (ran.exit_code != 0) return result;
  if (auto survey = load_survey(out / "survey.yaml")) result.survey = std::move(*survey);
  return result;
}

// Whether messages name one of the lines, and another one.
std::pair<bool, bool> named_lines(const std::string& said, const std::vector<std::size_t>& lines) {
  static const std::regex place("points\\.csv:([0-9]+):|line ([0-9]+): point");
  bool right = false, other = false;
  for (std::sregex_iterator at(said.begin(), said.end(), place), end; at != end; ++at) {
    const std::string number = (*at)[1].matched ? (*at)[1] : (*at)[2];
    const bool is_one = std::ranges::find(lines, std::stoul(number)) != lines.end();
    (is_one ? right : other) = true;
  }
  return {right, other};
}

// A plate more than 30 mm or half a degree from where the right list has it, or none of its name.
bool harms(const Survey& right, const Survey& drafted) {
  if (right.tags.size() != drafted.tags.size()) return true;
  for (const PlacedTag& tag : right.tags) {
    const auto same = std::ranges::find(drafted.tags, tag.name, &PlacedTag::name);
    if (same == drafted.tags.end()) return true;
    const Pose& a = tag.world_from_plate;
    const Pose& b = same->world_from_plate;
    const double turned = Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle();
    if ((tag.p_in_grid - same->p_in_grid).norm() > 0.03 || turned > radians(0.5)) return true;
  }
  return false;
}

enum Outcome { refused_named, refused_others, drafted_named, harmless, harmful, outcomes };
using Counts = std::map<std::string, std::array<int, outcomes>>;

Outcome outcome_of(const Drafted& right, const MistypedList& list) {
  const Drafted made = drafted(list.rows);
  const auto [named, others] = named_lines(made.said, list.lines);
  if (!made.survey) return named ? refused_named : refused_others;
  if (named) return drafted_named;
  return harms(*right.survey, *made.survey) ? harmful : harmless;
}

void try_lists(int drives, std::uint64_t seed) {
  constexpr int kSlips = 4;
  std::vector<std::vector<std::pair<std::string, Outcome>>> found(static_cast<std::size_t>(drives));
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    Draws draws(seed * 1'000'003 + i);
    const std::vector<Row> rows = surveyed(draws);
    const Drafted right = drafted(rows);
    if (!right.survey) std::abort();
    for (int slip = 0; slip < kSlips; ++slip) {
      const MistypedList list = mistyped_list(rows, draws);
      if (list.rows != rows) found[i].emplace_back(list.slip, outcome_of(right, list));
    }
  });
  Counts counts;
  for (const auto& of_drive : found) {
    for (const auto& [slip, outcome] : of_drive) {
      ++counts[slip][outcome];
      ++counts["all"][outcome];
    }
  }
  fmt::print(
      "| mistyped | refused, line named | refused, not named | drafted, line named | silent, no "
      "harm | silent, a plate more than 30 mm or 0.5 degrees off |\n|---|---|---|---|---|---|\n");
  for (const auto& [slip, of_slip] : counts) {
    fmt::print("| {} | {} |\n", slip, fmt::join(of_slip, " | "));
  }
}

// ---- Files of a survey, a rig and a run.

std::string text_of(const fs::path& file) { return read_file(file).value(); }

struct MistypedFile {
  std::string text;
  std::string what;  // was typed for what
};

// One number that is no comment and no part of a word, mistyped.
MistypedFile with_slip(const std::string& text, Draws& draws) {
  static const std::regex number("-?[0-9]+(\\.[0-9]+)?");
  std::vector<std::pair<std::size_t, std::size_t>> places;
  const auto part_of_word = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 ||
                               std::string_view("_-./").find(text[i]) != std::string_view::npos);
  };
  for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at) {
    const auto from = static_cast<std::size_t>(at->position());
    const std::size_t line = text.rfind('\n', from) + 1;
    const bool comment = text.substr(line, from - line).find('#') != std::string::npos;
    const auto length = static_cast<std::size_t>(at->length());
    const bool word = (from > 0 && part_of_word(from - 1)) || part_of_word(from + length);
    if (!comment && !word) places.emplace_back(from, length);
  }
  const auto [from, length] = places[draws.index(places.size())];
  const Typed typed = mistyped(text.substr(from, length), draws);
  const std::size_t line = text.rfind('\n', from) + 1;
  const std::string what = fmt::format("{} | {} typed for {}", text.substr(line, from - line),
                                       typed.text, text.substr(from, length));
  std::string whole = text;
  return {whole.replace(from, length, typed.text), what};
}

struct Files {
  std::string survey, rig, run;
};

enum Located {
  refused,
  all_right,
  some_right,
  none_given,
  wrong_told,
  wrong_silent,
  located_kinds
};

// Whether a position is more than five standard deviations and a millimetre off the truth.
bool is_wrong(const nlohmann::json& row, const std::map<std::string, Eigen::Vector3d>& truths) {
  const Eigen::Vector3d& truth = truths.at(row["id"]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double off =
        std::abs(row["position"][axis].get<double>() - truth[static_cast<int>(axis)]);
    const double sigma = std::sqrt(row["covariance"][4 * axis].get<double>());
    if (off > std::max(0.001, 5 * sigma)) return true;
  }
  return false;
}

std::map<std::string, Eigen::Vector3d> truths_of(const std::string& run) {
  std::map<std::string, Eigen::Vector3d> truths;
  const std::vector<std::string> lines = split(run, '\n');
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> fields = split(lines[i], ',');
    if (fields.size() < 7) continue;
    truths[fields[0]] = {*parse_number(fields[4]), *parse_number(fields[5]),
                         *parse_number(fields[6])};
  }
  return truths;
}

Located locate(const std::string& site, const Files& files,
               const std::map<std::string, Eigen::Vector3d>& truths) {
  const test::TemporaryFolder folder;
  fs::create_directory_symlink(fs::absolute("surveys/" + site + "/photos"),
                               folder.path() / "photos");
  const auto put = [&](const char* name, const std::string& text) {
    if (!write_file(folder.path() / name, text)) std::abort();
    return "'" + (folder.path() / name).string() + "'";
  };
  const test::ProgramOutput ran = test::run_tagsmith(
      fmt::format("localize {} --rig {} --run {} --json", put("survey.yaml", files.survey),
                  put("rig.yaml", files.rig), put("run.csv", files.run)));
  if (ran.exit_code == 2) return refused;
  std::size_t right = 0, wrong = 0;
  for (const nlohmann::json& row : test::json_lines(ran.out)) {
    if (row.contains("status") && row["status"] == "ok") ++(is_wrong(row, truths) ? wrong : right);
  }
  if (wrong > 0) return ran.exit_code == 0 ? wrong_silent : wrong_told;
  return right == truths.size() ? all_right : right > 0 ? some_right : none_given;
}

// The columns of a run before its truth, of one row.
std::string with_slip_in_run(const std::string& run, Draws& draws) {
  std::vector<std::string> lines = split(run, '\n');
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (!lines[i].empty()) rows.push_back(i);
  }
  const std::size_t row = rows[draws.index(rows.size())];
  std::vector<std::string> fields = split(lines[row], ',');
  const std::size_t column = 1 + draws.index(3);
  if (column == 3) {
    fields[3] = mistyped(fields[3], draws).text;
  } else {  // the photo of another row or camera
    fields[column] = split(lines[rows[draws.index(rows.size())]], ',')[1 + draws.index(2)];
  }
  lines[row] = fmt::format("{}", fmt::join(fields, ","));
  return fmt::format("{}", fmt::join(lines, "\n"));
}

struct TriedFile {
  std::string name;
  std::string what;
  Located outcome{};
};

TriedFile try_file(std::uint64_t seed) {
  Draws draws(seed);
  const std::string site = draws.chance(0.5) ? "corridor" : "curved";
  const std::string folder = "surveys/" + site + "/";
  Files files{text_of(folder + "survey.yaml"), text_of(folder + "rig.yaml"),
              text_of(folder + "run.csv")};
  const auto truths = truths_of(files.run);
  const bool by_sheet = draws.chance(0.5);
  if (by_sheet) files.rig = std::regex_replace(files.rig, std::regex(", sigma: 0 \\}"), " }");
  const std::size_t which = draws.index(3);
  TriedFile tried;
  if (which == 2) {
    files.run = with_slip_in_run(files.run, draws);
  } else {
    std::string& text = which == 0 ? files.rig : files.survey;
    MistypedFile mistyped = with_slip(text, draws);
    text = std::move(mistyped.text);
    tried.what = site + ": " + mistyped.what;
  }
  tried.name = fmt::format("{}, rig {}", std::array{"rig", "survey", "run"}[which],
                           by_sheet ? "by data sheet" : "exact");
  tried.outcome = locate(site, files, truths);
  return tried;
}

void try_files(int count, std::uint64_t seed) {
  std::vector<TriedFile> tried(static_cast<std::size_t>(count));
  tbb::parallel_for(std::size_t{0}, tried.size(),
                    [&](std::size_t i) { tried[i] = try_file(seed * 1'000'003 + i); });
  std::map<std::string, std::array<int, located_kinds>> counts;
  for (const TriedFile& file : tried) ++counts[file.name][file.outcome];
  fmt::print(
      "| mistyped in | refused | all positions right | some, right | none | some wrong, and exit "
      "code 1 | some wrong, silent |\n|---|---|---|---|---|---|---|\n");
  for (const auto& [name, of_file] : counts) {
    fmt::print("| {} | {} |\n", name, fmt::join(of_file, " | "));
  }
  for (const TriedFile& file : tried) {
    if (file.outcome >= wrong_told) fmt::print("wrong: {}\n", file.what);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const int count = argc > 2 ? std::atoi(argv[2]) : 100;
  const auto seed = static_cast<std::uint64_t>(argc > 3 ? std::atoi(argv[3]) : 1);
  if (what == "lists") {
    try_lists(count, seed);
  } else if (what == "files") {
    try_files(count, seed);
  } else {
    fmt::print(stderr, "usage: bench_mistyped lists|files [N] [SEED]\n");
    return 2;
  }
  return 0;
}
