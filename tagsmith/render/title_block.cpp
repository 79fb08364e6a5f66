// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/title_block.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kBlockWidth = 0.180;  // ISO 7200
constexpr double kBlockHeight = 0.020;
constexpr double kTitleWidth = 0.074;
constexpr double kBlockPadding = 0.002;
constexpr double kValueHeight = 0.0020;
constexpr double kFieldNameHeight = 0.0014;

std::vector<Vector2d> corners(const AlignedBox2d& box) {
  return {box.min(), {box.max().x(), box.min().y()}, box.max(), {box.min().x(), box.max().y()}};
}

void add_text(SheetLayer& layer, const std::string& text, const Vector2d& at, double height,
              double max_width, const Colour& colour = {}) {
  layer.items.push_back(SheetText{
      .text = text, .at = at, .height = height, .max_width = max_width, .colour = colour});
}

std::vector<TitleField> all_fields(const TitleBlock& block, const SheetNumber& number,
                                   std::optional<double> scale) {
  std::vector<TitleField> fields = block.fields;
  if (scale) fields.push_back({"Scale", scale_text(*scale)});
  fields.push_back({"Unit", "metre"});
  fields.push_back(
      {"Sheet", std::to_string(number.number) + " of " + std::to_string(number.count)});
  return fields;
}

// Two rows of cells.
void add_fields(SheetLayer& layer, const std::vector<TitleField>& fields, const AlignedBox2d& box) {
  const std::size_t columns = (fields.size() + 1) / 2;
  const Vector2d cell(box.sizes().x() / static_cast<double>(columns), box.sizes().y() / 2);
  const LineStyle line{.width = kNarrow};
  const double middle = box.center().y();
  layer.items.push_back(SheetLine{{{box.min().x(), middle}, {box.max().x(), middle}}, line});
  for (std::size_t column = 0; column < columns; ++column) {
    const double x = box.min().x() + static_cast<double>(column) * cell.x();
    layer.items.push_back(SheetLine{{{x, box.min().y()}, {x, box.max().y()}}, line});
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::size_t row = i / columns;
    const Vector2d corner = box.min() + Vector2d(static_cast<double>(i % columns) * cell.x(),
                                                 static_cast<double>(row) * cell.y());
    const double width = cell.x() - kBlockPadding;
    add_text(layer, fields[i].name, corner + Vector2d(kBlockPadding / 2, 0.0028), kFieldNameHeight,
             width, colours::kGrey);
    add_text(layer, fields[i].value, corner + Vector2d(kBlockPadding / 2, 0.0075), kValueHeight,
             width);
  }
}

void add_scale_bar(SheetLayer& layer, double scale, const Vector2d& left_end) {
  constexpr int kParts = 4;
  constexpr double kThickness = 0.0015;
  constexpr double kTextHeight = 0.0018;
  constexpr double kLeastLength = 0.025;  // on paper
  const double ground = round_step(kLeastLength * scale);
  const double part = ground / scale / kParts;
  const LineStyle line{.width = kNarrow};
  for (int i = 0; i < kParts; ++i) {
    const Vector2d corner = left_end + Vector2d(i * part, 0);
    const std::vector<Vector2d> box =
        corners({corner, Vector2d(corner + Vector2d(part, kThickness))});
    if (i % 2 == 0) layer.items.push_back(SheetArea{{box}, colours::kBlack});
    layer.items.push_back(SheetLine{box, line, true});
  }
  for (const int tick : {0, kParts / 2, kParts}) {
    const std::string text =
        format_number(ground * tick / kParts, 6) + (tick == kParts ? " m" : "");
    const double width = text_width(text, kTextHeight);
    const double centred = left_end.x() + tick * part -
                           text_width(format_number(ground * tick / kParts, 6), kTextHeight) / 2;
    add_text(layer, text, Vector2d{centred, left_end.y() - 0.0012}, kTextHeight, width * 1.001);
  }
  const std::string text = scale_text(scale);
  add_text(layer, text, left_end + Vector2d(0, 0.0055), 0.0025, text_width(text, 0.0025) * 1.001);
}

Vector2d size_of(Paper paper) {
  if (paper == Paper::letter) return {0.2794, 0.2159};
  return paper == Paper::a4 ? Vector2d(0.297, 0.210) : Vector2d(0.420, 0.297);
}

}  // namespace

std::string scale_text(double denominator) {
  return denominator < 1 ? format_number(1 / denominator, 3) + " : 1"
                         : "1 : " + format_number(denominator, 3);
}

double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= least * (1 - 1e-9)) return step * power;
  }
  return 10 * power;
}

SheetFrame sheet_frame(Paper paper) {
  constexpr double kFiling = 0.020;
  constexpr double kMargin = 0.010;
  constexpr double kInset = 0.005;
  SheetFrame frame;
  frame.paper = size_of(paper);
  frame.border =
      AlignedBox2d(Vector2d(kFiling, kMargin), Vector2d(frame.paper - Vector2d(kMargin, kMargin)));
  const Vector2d corner = frame.border.max();
  frame.block = AlignedBox2d(Vector2d(corner - Vector2d(kBlockWidth, kBlockHeight)), corner);
  frame.views = AlignedBox2d(Vector2d(frame.border.min() + Vector2d(kInset, kInset)),
                             Vector2d(corner.x() - kInset, frame.block.min().y() - kInset));
  return frame;
}

void add_title_block(Sheet& sheet, const TitleBlock& block, const SheetNumber& number,
                     std::optional<double> scale_denominator, const SheetFrame& frame) {
  SheetLayer layer{"title-block", {}};
  layer.items.push_back(SheetLine{corners(frame.border), {.width = 0.0007}, true});
  layer.items.push_back(SheetLine{corners(frame.block), {.width = kWide}, true});
  const Vector2d corner = frame.block.min();
  add_text(layer, block.title, corner + Vector2d(kBlockPadding, 0.0075), 0.0035,
           kTitleWidth - 2 * kBlockPadding);
  add_text(layer, block.subject, corner + Vector2d(kBlockPadding, 0.0135), 0.0022,
           kTitleWidth - 2 * kBlockPadding);
  add_text(layer, "tagsmith", corner + Vector2d(kBlockPadding, 0.0180), kFieldNameHeight,
           kTitleWidth - 2 * kBlockPadding, colours::kGrey);
  add_fields(layer, all_fields(block, number, scale_denominator),
             {Vector2d(corner + Vector2d(kTitleWidth, 0)), frame.block.max()});
  if (scale_denominator) {
    add_scale_bar(layer, *scale_denominator,
                  {frame.border.min().x() + 0.006, frame.border.max().y() - 0.010});
  }
  sheet.layers.push_back(std::move(layer));
}

}  // namespace tagsmith::detail
