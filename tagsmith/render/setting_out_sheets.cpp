// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/setting_out_sheets.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/survey_views.hpp"
#include "tagsmith/render/tag_text.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

constexpr double kLeft = 0.015;
constexpr double kRight = 0.200;
constexpr double kHeadTop = 0.044;
constexpr double kRowHeight = 0.0065;
constexpr double kBelowRows = 0.017;
constexpr double kCellTextHeight = 0.0022;  // of a capital letter
constexpr double kCellPadding = 0.0012;

struct SheetColumn {
  const char* head;
  double width;
  bool is_number = false;  // numbers end at one place, so that their decimal points stand in line
};

constexpr std::array<SheetColumn, 11> kSheetColumns{{{"tag", 0.015},
                                                     {"side", 0.011},
                                                     {"chainage (m)", 0.021, true},
                                                     {"offset (m)", 0.017, true},
                                                     {"height (m)", 0.017, true},
                                                     {"x (m)", 0.019, true},
                                                     {"y (m)", 0.019, true},
                                                     {"z (m)", 0.017, true},
                                                     {"tol. (mm)", 0.014, true},
                                                     {"digits", 0.0265},
                                                     {"hung", 0.0085}}};

// A text for each column, or a single one across them all.
using TableRow = std::vector<std::string>;

struct PageSize {
  double width = 0.210;  // A4, upright
  double height = 0.297;

  std::size_t rows() const {
    return static_cast<std::size_t>((height - kBelowRows - kHeadTop) / kRowHeight) - 1;
  }
};

class TablePage {
 public:
  TablePage(const std::string& title, const PageSize& size) {
    sheet_.width = size.width;
    sheet_.height = size.height;
    sheet_.title = title;
    sheet_.layers = {{"table", {}}};
  }

  void text(double x, double baseline, const std::string& words, double height, double width) {
    add(SheetText{.text = words, .at = {x, baseline}, .height = height, .max_width = width});
  }

  void line(const Vector2d& from, const Vector2d& to, double width) {
    add(SheetLine{.points = {from, to}, .line = {.width = width}});
  }

  // A row below `top`.
  void row(double top, const TableRow& texts) {
    const auto upright = [&](double x) { line({x, top}, {x, top + kRowHeight}, kExtraNarrow); };
    double x = kLeft;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const bool alone = texts.size() == 1;
      const double width = alone ? kRight - kLeft : kSheetColumns[i].width;
      const double room = width - 2 * kCellPadding;
      const double spare = std::max(0.0, room - text_width(texts[i], kCellTextHeight));
      const double before = !alone && kSheetColumns[i].is_number ? spare : 0;
      text(x + kCellPadding + before, top + kRowHeight - 0.002, texts[i], kCellTextHeight, room);
      upright(x);
      x += width;
    }
    upright(x);
    line({kLeft, top + kRowHeight}, {kRight, top + kRowHeight}, kExtraNarrow);
  }

  Sheet finished() { return std::move(sheet_); }

 private:
  template <class Item>
  void add(Item item) {
    sheet_.layers.front().items.push_back(std::move(item));
  }

  Sheet sheet_;
};

TableRow texts_of(const Survey& survey, const SettingOut& place) {
  const PlacedTag& tag = *place.tag;
  const Eigen::Vector3d& p = tag.p_in_grid;
  return {tag.name,
          to_string(tag.side),
          to_millimetre(place.chainage),
          to_millimetre(place.offset),
          to_millimetre(place.height),
          to_millimetre(p.x()),
          to_millimetre(p.y()),
          to_millimetre(p.z()),
          format_number(place.tolerance * 1000, 1),
          grouped_digits(survey.code, tag.digits),
          ""};
}

// The places, each followed by how its plate turns out of its wall unless all of that wall do.
std::vector<TableRow> rows_of(const Survey& survey, std::span<const SettingOut> list) {
  std::vector<TableRow> rows;
  for (const SettingOut& place : list) {
    rows.push_back(texts_of(survey, place));
    if (!has_own_attitude(survey, *place.tag)) continue;
    const std::optional<PlateAttitude>& attitude = place.tag->attitude;
    rows.push_back({"the plate of " + place.tag->name + " " + attitude_text(*attitude) +
                    (attitude->facing ? ", from +y towards +x of the grid" : "")});
  }
  return rows;
}

void add_heading(TablePage& page, const Survey& survey, const std::string& revision,
                 std::size_t number, std::size_t count) {
  const double width = kRight - kLeft;
  const std::string usual = usual_attitudes_text(survey);
  page.text(kLeft, 0.019, "Setting-out of position tags: " + survey.name, 0.0042, width);
  page.text(kLeft, 0.026,
            fmt::format("{}plate {}{}  \u00b7  page {} of {}",
                        revision.empty() ? "" : "revision " + revision + "  \u00b7  ",
                        survey.tag_template.name, usual.empty() ? "" : ": " + usual, number, count),
            kCellTextHeight, width);
  page.text(kLeft, 0.032,
            "Every place is that of corner P: the upper left inner corner of the black frame, seen "
            "facing the plate.",
            kCellTextHeight, width);
  page.text(kLeft, 0.037,
            "offset: from the center line, negative = left of the drive; height: above the floor; "
            "tol.: P may hang so far from its place.",
            kCellTextHeight, width);
}

void add_head(TablePage& page) {
  TableRow heads;
  for (const SheetColumn& column : kSheetColumns) heads.emplace_back(column.head);
  page.line({kLeft, kHeadTop}, {kRight, kHeadTop}, kWide);
  page.row(kHeadTop, heads);
  page.line({kLeft, kHeadTop + kRowHeight}, {kRight, kHeadTop + kRowHeight}, kWide);
}

}  // namespace

std::vector<Sheet> setting_out_table(const Survey& survey, std::span<const SettingOut> list,
                                     const std::string& revision, Paper paper) {
  const PageSize size = paper == Paper::letter ? PageSize{0.2159, 0.2794} : PageSize{};
  const std::size_t rows_a_page = size.rows();
  const std::vector<TableRow> rows = rows_of(survey, list);
  const std::size_t count = std::max<std::size_t>(1, (rows.size() + rows_a_page - 1) / rows_a_page);
  std::vector<Sheet> sheets;
  for (std::size_t number = 0; number < count; ++number) {
    TablePage page(survey.name + " setting-out", size);
    add_heading(page, survey, revision, number + 1, count);
    add_head(page);
    double top = kHeadTop + kRowHeight;
    const std::size_t last = std::min(rows.size(), (number + 1) * rows_a_page);
    for (std::size_t i = number * rows_a_page; i < last; ++i) {
      page.row(top, rows[i]);
      top += kRowHeight;
    }
    sheets.push_back(page.finished());
  }
  return sheets;
}

Result<std::vector<Sheet>> setting_out_drawing(const Survey& survey,
                                               std::span<const SettingOut> list,
                                               const std::string& revision, Paper paper) {
  constexpr double kLeastPlate = 0.0015;  // a shorter one is a dot
  const Rectangle plate = plate_outline(survey.tag_template);
  TitleBlock block{survey.name, "Setting-out of position tags", {}};
  if (!revision.empty()) block.fields.push_back({"Revision", revision});
  block.fields.push_back({"Plate", survey.tag_template.name});
  if (const std::string usual = usual_attitudes_text(survey); !usual.empty()) {
    block.fields.push_back({"Attitude", usual});
  }
  block.fields.push_back(
      {"P from its upper left corner", format_number(-plate.x * 1000, 1) + " right, " +
                                           format_number(-plate.y * 1000, 1) + " down (mm)"});
  const auto elevation = [&](const PlanStrip& strip, Side side, bool) {
    return setting_out_elevation(survey, strip, side, list);
  };
  const auto has_place = [&](const PlanStrip& strip) {
    return std::ranges::any_of(list,
                               [&](const SettingOut& place) { return strip.has(*place.tag); });
  };
  const DrawingPart part =
      drive_by_strips(survey, paper, elevation, {kSettingOutPitch, kLeastPlate}, has_place);
  return lay_out_sheets(block, std::span(&part, 1));
}

}  // namespace tagsmith::detail
