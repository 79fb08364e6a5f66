// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/setting_out_sheets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/survey_views.hpp"
#include "tagsmith/render/tag_text.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {
namespace {

using Eigen::Vector2d;

constexpr double kPageWidth = 0.210;  // A4, upright
constexpr double kPageHeight = 0.297;
constexpr double kLeft = 0.015;
constexpr double kRight = 0.200;
constexpr double kHeadTop = 0.044;
constexpr double kRowHeight = 0.0065;
constexpr double kLastRowEnd = 0.280;
constexpr double kTextHeight = 0.0022;  // of a capital letter
constexpr double kPadding = 0.0012;

struct Column {
  const char* head;
  const char* unit;
  double width;
};

constexpr std::array<Column, 11> kColumns{{{"tag", "", 0.015},
                                           {"side", "", 0.011},
                                           {"chainage", "m", 0.021},
                                           {"offset", "m", 0.017},
                                           {"height", "m", 0.017},
                                           {"x", "m", 0.019},
                                           {"y", "m", 0.019},
                                           {"z", "m", 0.017},
                                           {"tol.", "mm", 0.014},
                                           {"digits", "", 0.0265},
                                           {"hung", "", 0.0085}}};

constexpr auto kRowsAPage = static_cast<std::size_t>((kLastRowEnd - kHeadTop) / kRowHeight) - 1;

class TablePage {
 public:
  explicit TablePage(const std::string& title) {
    sheet_.width = kPageWidth;
    sheet_.height = kPageHeight;
    sheet_.title = title;
    sheet_.layers = {{"table", {}}};
  }

  void text(double x, double baseline, const std::string& words, double height, double width) {
    add(SheetText{.text = words, .at = {x, baseline}, .height = height, .max_width = width});
  }

  void line(const Vector2d& from, const Vector2d& to, double width) {
    add(SheetLine{.points = {from, to}, .line = {.width = width}});
  }

  // Texts of one row below `top`.
  void row(double top, const std::array<std::string, kColumns.size()>& texts) {
    double x = kLeft;
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      text(x + kPadding, top + kRowHeight - 0.002, texts[i], kTextHeight,
           kColumns[i].width - 2 * kPadding);
      upright(x, top);
      x += kColumns[i].width;
    }
    upright(x, top);
    line({kLeft, top + kRowHeight}, {kRight, top + kRowHeight}, kExtraNarrow);
  }

  // Words across the whole row below `top`.
  void note(double top, const std::string& words) {
    text(kLeft + kPadding, top + kRowHeight - 0.002, words, kTextHeight,
         kRight - kLeft - 2 * kPadding);
    upright(kLeft, top);
    upright(kRight, top);
    line({kLeft, top + kRowHeight}, {kRight, top + kRowHeight}, kExtraNarrow);
  }

  Sheet finished() { return std::move(sheet_); }

 private:
  // Beside one row.
  void upright(double x, double top) { line({x, top}, {x, top + kRowHeight}, kExtraNarrow); }

  template <class Item>
  void add(Item item) {
    sheet_.layers.front().items.push_back(std::move(item));
  }

  Sheet sheet_;
};

std::string metres(double value) {
  return fmt::format("{:.3f}", std::round(value * 1000) / 1000 + 0.0);
}

std::array<std::string, kColumns.size()> texts_of(const Survey& survey, const SettingOut& place) {
  const PlacedTag& tag = *place.tag;
  const Eigen::Vector3d& p = tag.p_in_grid;
  return {tag.name,
          to_string(tag.side),
          metres(place.chainage),
          metres(place.offset),
          metres(place.height),
          metres(p.x()),
          metres(p.y()),
          metres(p.z()),
          format_number(place.tolerance * 1000, 1),
          grouped_digits(survey.code, tag.digits),
          ""};
}

// A row of the table: a place, or how its plate turns out of its wall.
struct TableRow {
  const SettingOut* place = nullptr;
  bool is_note = false;
};

std::vector<TableRow> rows_of(std::span<const SettingOut> list) {
  std::vector<TableRow> rows;
  for (const SettingOut& place : list) {
    rows.push_back({&place, false});
    if (place.tag->attitude) rows.push_back({&place, true});
  }
  return rows;
}

void add_heading(TablePage& page, const Survey& survey, const std::string& revision,
                 std::size_t number, std::size_t count) {
  const double width = kRight - kLeft;
  page.text(kLeft, 0.019, "Setting-out of position tags: " + survey.name, 0.0042, width);
  page.text(kLeft, 0.026,
            fmt::format("{}plate {}  \u00b7  page {} of {}",
                        revision.empty() ? "" : "revision " + revision + "  \u00b7  ",
                        survey.tag_template.name, number, count),
            kTextHeight, width);
  page.text(kLeft, 0.032,
            "Every place is that of corner P: the upper left inner corner of the black frame, seen "
            "facing the plate.",
            kTextHeight, width);
  page.text(kLeft, 0.037,
            "offset: from the center line, negative = left of the drive; height: above the floor; "
            "tol.: P may hang so far from its place.",
            kTextHeight, width);
}

void add_head(TablePage& page) {
  std::array<std::string, kColumns.size()> heads;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    heads[i] = kColumns[i].head;
    if (*kColumns[i].unit != '\0') heads[i] += std::string(" (") + kColumns[i].unit + ")";
  }
  page.line({kLeft, kHeadTop}, {kRight, kHeadTop}, kWide);
  page.row(kHeadTop, heads);
  page.line({kLeft, kHeadTop + kRowHeight}, {kRight, kHeadTop + kRowHeight}, kWide);
}

}  // namespace

std::vector<Sheet> setting_out_table(const Survey& survey, std::span<const SettingOut> list,
                                     const std::string& revision) {
  const std::vector<TableRow> rows = rows_of(list);
  const std::size_t count = std::max<std::size_t>(1, (rows.size() + kRowsAPage - 1) / kRowsAPage);
  std::vector<Sheet> sheets;
  for (std::size_t number = 0; number < count; ++number) {
    TablePage page(survey.name + " setting-out");
    add_heading(page, survey, revision, number + 1, count);
    add_head(page);
    double top = kHeadTop + kRowHeight;
    const std::size_t last = std::min(rows.size(), (number + 1) * kRowsAPage);
    for (std::size_t i = number * kRowsAPage; i < last; ++i) {
      const PlacedTag& tag = *rows[i].place->tag;
      if (rows[i].is_note) {
        page.note(top, "the plate of " + tag.name + " " + attitude_text(*tag.attitude) +
                           (tag.attitude->facing ? ", from +y towards +x of the grid" : ""));
      } else {
        page.row(top, texts_of(survey, *rows[i].place));
      }
      top += kRowHeight;
    }
    sheets.push_back(page.finished());
  }
  return sheets;
}

Result<std::vector<Sheet>> setting_out_drawing(const Survey& survey,
                                               std::span<const SettingOut> list,
                                               const std::string& revision) {
  const Rectangle plate = draw_tag(survey.tag_template, Digits{}).plate;
  TitleBlock block{survey.name, "Setting-out of position tags", {}};
  if (!revision.empty()) block.fields.push_back({"Revision", revision});
  block.fields.push_back({"Plate", survey.tag_template.name});
  block.fields.push_back(
      {"P from its upper left corner", format_number(-plate.x * 1000, 1) + " right, " +
                                           format_number(-plate.y * 1000, 1) + " down (mm)"});
  const PlanStyle style{Paper::a3, false};
  DrawingPart part{{}, {Paper::a3, coarsest_plan_scale(survey)}};
  bool first = true;
  for (const PlanStrip& strip : plan_strips(survey, style)) {
    part.views.push_back(annotated_plan(survey, strip, style, first));
    for (const Side side : {Side::left, Side::right}) {
      part.views.push_back(setting_out_elevation(survey, strip, side, list));
    }
    first = false;
  }
  return lay_out_sheets(block, std::span(&part, 1));
}

}  // namespace tagsmith
