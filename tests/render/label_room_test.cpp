// SPDX-License-Identifier: Apache-2.0
// Words of drawings stand clear of each other, whatever the survey.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/render/setting_out_sheets.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/survey_drawing.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using Eigen::Vector2d;

namespace {

using Corners = std::array<Vector2d, 4>;

// From the baseline to the top of capital letters, a tenth of a millimetre less on every side.
Corners corners_of(const SheetText& text) {
  constexpr double kLess = 0.0001;
  const Vector2d along(std::cos(text.angle), -std::sin(text.angle));
  const Vector2d up(along.y(), -along.x());
  const double length = std::min(text_width(text.text, text.height), text.max_width);
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const double right = i == 0 || i == 3 ? kLess : length - kLess;
    const double above = i < 2 ? kLess : text.height - kLess;
    corners[i] = text.at + along * right + up * above;
  }
  return corners;
}

// All of `b` lies beyond one side of `a`.
bool beyond_a_side(const Corners& a, const Corners& b) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d side = a[(i + 1) % 4] - a[i];
    const Vector2d outward(-side.y(), side.x());
    const bool flip = outward.dot(a[(i + 2) % 4] - a[i]) > 0;
    if (std::ranges::all_of(b, [&](const Vector2d& corner) {
          return (flip ? -1 : 1) * outward.dot(corner - a[i]) > 0;
        })) {
      return true;
    }
  }
  return false;
}

// Pairs of words that stand over each other, on all sheets.
std::vector<std::string> collisions(const std::vector<Sheet>& sheets) {
  std::vector<std::string> found;
  for (const Sheet& sheet : sheets) {
    std::vector<std::pair<std::string, Corners>> texts;
    for (const SheetLayer& layer : sheet.layers) {
      for (const SheetItem& item : layer.items) {
        const auto* text = std::get_if<SheetText>(&item);
        if (text != nullptr && !text->text.empty())
          texts.emplace_back(text->text, corners_of(*text));
      }
    }
    for (std::size_t i = 0; i < texts.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const auto& [word, a] = texts[i];
        const auto& [other, b] = texts[j];
        if (!beyond_a_side(a, b) && !beyond_a_side(b, a)) found.push_back(word + " | " + other);
      }
    }
  }
  return found;
}

Survey drift(const TemporaryFolder& folder, int length, double spacing, int pairs) {
  const auto path = folder.path() / "survey.yaml";
  REQUIRE(write_file(path, fmt::format(R"(survey: drift
tunnel:
  width: 4.5
  height: 4.0
  centerline:
    start: [100, 2000, 0]
    heading: 30
    elements: [ {{ line: {} }}, {{ arc: 60, turn: right, angle: 30 }}, {{ line: {} }} ]
tags: {{ template: tag-400x300, height: 1.6, spacing: {}, first: 2.0, pairs: {} }}
code: {{ check_digit: gs1, resolution: 0.1, digits: [4, 5, 2] }}
)",
                                       length / 2, length / 2 - 30, spacing, pairs)));
  return load_survey(path).value();
}

// The drawing on A3 of all tags of a survey, given as its text.
auto setting_out_of(const std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "survey.yaml";
  REQUIRE(write_file(path, text));
  const Survey survey = load_survey(path).value();
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) tags.push_back(&tag);
  return setting_out_drawing(survey, setting_out(survey, tags, 0.005), "abc", Paper::a3).value();
}

}  // namespace

TEST_CASE("no words of a setting-out or a survey's drawing stand over others") {
  const TemporaryFolder folder;
  for (const auto& [length, spacing, pairs] :
       {std::tuple{100, 4.6, 19}, std::tuple{1000, 4.6, 199}, std::tuple{80, 0.05, 40}}) {
    const Survey survey = drift(folder, length, spacing, pairs);
    std::vector<const PlacedTag*> tags;
    for (const PlacedTag& tag : survey.tags) tags.push_back(&tag);
    for (const Paper paper : {Paper::a3, Paper::a4, Paper::letter}) {
      CAPTURE(length);
      CAPTURE(paper);
      const std::vector<SettingOut> list = setting_out(survey, tags, 0.005);
      const auto drawing = setting_out_drawing(survey, list, "abc", paper).value();
      for (const std::string& pair : collisions(drawing)) FAIL_CHECK(pair);
      for (const Sheet& sheet : setting_out_table(survey, list, "abc", paper)) {
        CHECK(sheet.width == (paper == Paper::letter ? 0.2159 : 0.210));
      }
      const auto drawn = draw_survey(survey, std::nullopt, {paper, "abc"}).value();
      for (const std::string& pair : collisions(drawn)) FAIL_CHECK(pair);
    }
  }
}

TEST_CASE("distances of tags that hang close among distant ones are written over their own gaps") {
  std::string text = R"(survey: face
tunnel: { width: 3, height: 3, centerline: { start: [0, 0, 0], heading: 0, elements: [ { line: 200 } ] } }
tags: { template: tag-a4 }
code: { check_digit: gs1, resolution: 0.1, digits: [4, 5, 2], origin: [-5, -1, 0] }
placed:
)";
  std::vector<double> places{13.1, 13.6, 14.1, 14.6};
  for (double y = 1; y < 200; y += 10) places.push_back(y);
  int pair = 0;
  for (const double y : places) {
    text += fmt::format("  - {{ tag: {:03}L, side: left, p: [-1.5, {}, 1.0] }}\n", pair++, y);
  }
  const auto drawing = setting_out_of(text);
  for (const std::string& pair_of_words : collisions(drawing)) FAIL_CHECK(pair_of_words);
  std::vector<Vector2d> labels;
  std::vector<SheetText> distances;
  for (const SheetLayer& layer : drawing.front().layers) {
    for (const SheetItem& item : layer.items) {
      const auto* words = std::get_if<SheetText>(&item);
      if (words == nullptr) continue;
      if (words->text == "0.500") distances.push_back(*words);
      if (words->text.starts_with("13.") || words->text.starts_with("14.")) {
        labels.push_back(words->at);
      }
    }
  }
  int strips = 0, distances_from_before = 0;
  for (const Sheet& sheet : drawing) {
    for (const SheetLayer& layer : sheet.layers) {
      for (const SheetItem& item : layer.items) {
        const auto* words = std::get_if<SheetText>(&item);
        if (words == nullptr) continue;
        if (words->text.starts_with("Left wall")) ++strips;
        const bool is_from_before =
            words->text.starts_with("10.000 from 0") || words->text == "6.400 from 003L";
        if (is_from_before) ++distances_from_before;
      }
    }
  }
  CHECK(strips > 2);
  CHECK(distances_from_before == strips - 1);
  std::ranges::sort(labels, {}, [](const Vector2d& at) { return at.x(); });
  REQUIRE(labels.size() == 4);
  REQUIRE(distances.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(distances[i].at.x() > labels[i].x());
    CHECK(distances[i].at.x() < labels[i + 1].x());
    CHECK(distances[i].at.y() == doctest::Approx(distances[0].at.y()));
  }
}

TEST_CASE("numbers of the setting-out table end at one place of their column") {
  const TemporaryFolder folder;
  const Survey survey = drift(folder, 1000, 4.6, 199);
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) tags.push_back(&tag);
  const std::vector<SettingOut> list = setting_out(survey, tags, 0.005);
  std::vector<double> ends;
  for (const Sheet& sheet : setting_out_table(survey, list, "abc", Paper::a4)) {
    for (const SheetItem& item : sheet.layers.front().items) {
      const auto* words = std::get_if<SheetText>(&item);
      const auto is_chainage = [&](const SettingOut& place) {
        return words != nullptr && words->text == fmt::format("{:.3f}", place.chainage);
      };
      if (words == nullptr || words->at.x() > 0.0625 || std::ranges::none_of(list, is_chainage)) {
        continue;
      }
      ends.push_back(words->at.x() + text_width(words->text, words->height));
    }
  }
  REQUIRE(ends.size() == list.size());
  const auto [first, last] = std::ranges::minmax(ends);
  CHECK(last - first < 1e-6);
}

TEST_CASE("the grid's origin in a strip does not make the setting-out's scale coarser") {
  std::string text = R"(survey: near
tunnel: { width: 3, height: 3, centerline: { start: [0, 0, 0], heading: 0, elements: [ { line: 40 } ] } }
tags: { template: tag-400x300 }
code: { check_digit: gs1, resolution: 0.01, digits: [4, 4, 3], origin: [-5, -1, 0] }
placed:
)";
  int pair = 0;
  for (const double y : {1.0, 7.0, 9.0, 9.45, 15.0, 15.42, 15.84, 21.0, 36.0}) {
    text += fmt::format("  - {{ tag: {:03}L, side: left, p: [-1.5, {}, 1.0] }}\n", pair++, y);
  }
  const auto drawing = setting_out_of(text);
  for (const std::string& pair_of_words : collisions(drawing)) FAIL_CHECK(pair_of_words);
  // The nearest tags are 0.42 m apart, 8.4 mm of paper.
  CHECK(std::ranges::any_of(drawing.front().layers, [](const SheetLayer& layer) {
    return std::ranges::any_of(layer.items, [](const SheetItem& item) {
      const auto* words = std::get_if<SheetText>(&item);
      return words != nullptr && words->text == "1 : 50";
    });
  }));
}

TEST_CASE("a box moves where there is room, by the first move that leads there") {
  LabelRoom room;
  const TurnedBox box{{0, 0}, {0.010, 0}, {0, 0.002}};
  const std::vector<Vector2d> moves{{0, 0.001}, {0, 0.003}, {0, -0.003}};
  CHECK(room.take(box, moves) == Vector2d(0, 0));
  CHECK(room.take(box, moves) == Vector2d(0, 0.003));
  CHECK(room.take(box, moves) == Vector2d(0, -0.003));
  CHECK(room.take(box, moves) == Vector2d(0, 0));  // nowhere else
  const TurnedBox beside{{0.0101, -0.010}, {0, 0.030}, {0.002, 0}};
  CHECK(room.take(beside, moves) == Vector2d(0, 0));
  const double far = 1e300;
  CHECK(room.take({{far, far}, {1, 0}, {0, 1}}, moves) == Vector2d(0, 0));
}
