// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sketch_on_paper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tagsmith/render/text.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// ---- The space for words.

namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

AlignedBox2d bounds_of(const TurnedBox& box) {
  AlignedBox2d bounds;
  for (const Vector2d& side : {Vector2d(0, 0), box.along, box.up, Vector2d(box.along + box.up)}) {
    bounds.extend(Vector2d(box.corner + side));
  }
  return bounds;
}

// True when a line in the direction of a side of `a` lies between the two (separating axes).
bool side_separates(const TurnedBox& a, const TurnedBox& b) {
  for (const Vector2d& side : {a.along, a.up}) {
    const double length = side.squaredNorm();
    const double from = (b.corner - a.corner).dot(side);
    const double along = b.along.dot(side);
    const double up = b.up.dot(side);
    const double least = from + std::min(along, 0.0) + std::min(up, 0.0);
    const double most = from + std::max(along, 0.0) + std::max(up, 0.0);
    if (least >= length || most <= 0) return true;
  }
  return false;
}

// Calls the function with the key of each cell of a grid that the box may reach.
template <class Function>
void for_each_cell(const TurnedBox& box, const Function& function) {
  constexpr double kCell = 0.010;  // metres on paper
  const AlignedBox2d bounds = bounds_of(box);
  const auto cell = [](double at) { return static_cast<std::int64_t>(std::floor(at / kCell)); };
  constexpr double kFarthest = 1e4;  // metres; nothing is drawn so far away
  if (!(bounds.min().cwiseAbs().maxCoeff() < kFarthest)) return;
  if (!(bounds.max().cwiseAbs().maxCoeff() < kFarthest) || bounds.sizes().maxCoeff() > 1) return;
  for (std::int64_t x = cell(bounds.min().x()); x <= cell(bounds.max().x()); ++x) {
    for (std::int64_t y = cell(bounds.min().y()); y <= cell(bounds.max().y()); ++y) {
      function((x << 32) ^ (y & 0xffffffff));
    }
  }
}

}  // namespace

bool LabelRoom::is_free(const TurnedBox& box) const {
  bool free = true;
  for_each_cell(box, [&](std::int64_t cell) {
    const auto found = taken_by_cell_.find(cell);
    if (!free || found == taken_by_cell_.end()) return;
    free = std::ranges::all_of(found->second, [&](std::size_t i) {
      return side_separates(box, taken_[i]) || side_separates(taken_[i], box);
    });
  });
  return free;
}

Vector2d LabelRoom::take(const TurnedBox& box, std::span<const Vector2d> moves) {
  TurnedBox placed = box;
  if (!is_free(box)) {
    const auto found = std::ranges::find_if(moves, [&](const Vector2d& move) {
      return is_free({box.corner + move, box.along, box.up});
    });
    if (found != moves.end()) placed.corner += *found;
  }
  for_each_cell(placed, [&](std::int64_t cell) { taken_by_cell_[cell].push_back(taken_.size()); });
  taken_.push_back(placed);
  return placed.corner - box.corner;
}

// ---- The sketch at a scale.

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kCircleSides = 72;

// On paper y grows downwards.
Vector2d turned_left(const Vector2d& direction) { return {direction.y(), -direction.x()}; }
Vector2d direction_at(double angle) { return {std::cos(angle), -std::sin(angle)}; }

// The angle of a line of text along this direction that is not upside down: above -90 degrees, at
// most 90 (ISO 129-1: read from below or from the right).
double reading_angle(const Vector2d& direction) {
  constexpr double kSlack = 1e-6;
  const double angle = std::atan2(-direction.y(), direction.x());
  if (angle > kPi / 2 + kSlack) return angle - kPi;
  if (angle <= -kPi / 2 + kSlack) return angle + kPi;
  return angle;
}

class Drafter {
 public:
  explicit Drafter(double scale_denominator) : scale_(1 / scale_denominator) {}

  SketchOnPaper take() && { return std::move(result_); }

  void begin_layer(const std::string& name) { result_.layers.push_back({name, {}}); }

  void operator()(const Area& area) { add_area(on_paper(area.points), area.fill); }

  void operator()(const Polyline& line) { add_line(on_paper(line.points), line.line, line.closed); }

  void operator()(const Ellipse& ellipse) {
    const Vector2d axes = ellipse.semi_axes * (ellipse.on_paper ? 1 : scale_);
    add_line(oval(on_paper(ellipse.at), axes, ellipse.angle), ellipse.line, true);
  }

  void operator()(const Dot& dot) {
    add_area(oval(on_paper(dot.at), {dot.radius, dot.radius}, 0), dot.fill);
  }

  void operator()(const Arrow& arrow) {
    add_arrow(on_paper(arrow.from), on_paper(arrow.to), arrow.line, arrow.head);
  }

  void operator()(const Words& words) { add_words(words, on_paper(words.at)); }

  void operator()(const Picture& picture) {
    const Vector2d at = on_paper(picture.at);
    result_.bounds.extend(at);
    result_.bounds.extend(at + Vector2d(picture.width, picture.height));
    result_.layers.back().items.push_back(SheetPicture{at, picture.width, picture.height,
                                                       picture.columns, picture.rows,
                                                       picture.samples, picture.jpeg});
  }

  void operator()(const Dimension& dimension) {
    const Vector2d from = on_paper(dimension.from);
    const Vector2d to = on_paper(dimension.to);
    const double length = (to - from).norm();
    if (length <= 0) return;
    const Vector2d along = (to - from) / length;
    const Vector2d across = turned_left(along) * (dimension.offset < 0 ? -1 : 1);
    const double offset = std::abs(dimension.offset);
    const LineStyle line{dimension.colour, kNarrow, {}};
    for (const Vector2d& end : {from, to}) {
      add_line({end + across * kExtensionGap, end + across * (offset + kExtensionOver)}, line);
    }
    const Vector2d shift = across * offset;
    const bool room = length >= 3 * kHead;
    if (room) {
      add_arrow(from + shift, to + shift, line, kHead);
      add_head(to + shift, from + shift, dimension.colour, kHead);
    } else {
      add_line({from + shift, to + shift}, line);
    }
    if (!room && dimension.in_chain) {
      const Vector2d stroke = (along + turned_left(along)) * kHead / 4;
      for (const Vector2d& end : {from, to}) {
        add_line({end + shift - stroke, end + shift + stroke}, line);
      }
    } else if (!room) {
      add_arrow(from + shift - along * 2.2 * kHead, from + shift, line, kHead);
      add_arrow(to + shift + along * 2.2 * kHead, to + shift, line, kHead);
    }
    add_dimension_text(dimension, from + shift, to + shift, room);
  }

 private:
  static constexpr double kHead = 0.0025;
  static constexpr double kExtensionGap = 0.001;
  static constexpr double kExtensionOver = 0.0015;
  static constexpr double kDimensionText = 0.0018;

  // Above the line's middle; beyond its end where that is too short, or upright in a chain.
  void add_dimension_text(const Dimension& dimension, const Vector2d& from, const Vector2d& to,
                          bool arrows_inside) {
    const double angle = reading_angle(to - from);
    const Vector2d reading = direction_at(angle);
    const Vector2d up = turned_left(reading);
    const double length = (to - from).norm();
    const Vector2d above = (from + to) / 2 + up * 0.0007;
    Words words{.text = dimension.text,
                .height = kDimensionText,
                .angle = angle,
                .level = TextLevel::middle,
                .colour = dimension.colour};
    if (text_width(words.text, words.height) <= length) {
      words.align = TextAlign::centre;
      words.level = TextLevel::baseline;
      return add_words(words, above);
    }
    if (dimension.in_chain) {
      words.angle += kPi / 2;
      return add_words(words, above);
    }
    const Vector2d last = (to - from).dot(reading) > 0 ? to : from;
    add_words(words, last + reading * (arrows_inside ? 0.0015 : 2.6 * kHead));
  }

  Vector2d on_paper(const SketchPoint& point) const {
    const Vector2d up = point.model * scale_ + point.paper;
    return {up.x(), -up.y()};
  }

  std::vector<Vector2d> on_paper(const std::vector<SketchPoint>& points) const {
    std::vector<Vector2d> result;
    result.reserve(points.size());
    for (const SketchPoint& point : points) result.push_back(on_paper(point));
    return result;
  }

  static std::vector<Vector2d> oval(const Vector2d& centre, const Vector2d& axes, double angle) {
    std::vector<Vector2d> points;
    const Vector2d first = direction_at(angle) * axes.x();
    const Vector2d second = direction_at(angle + kPi / 2) * axes.y();
    for (int i = 0; i < kCircleSides; ++i) {
      const double turn = 2 * kPi * i / kCircleSides;
      points.push_back(centre + std::cos(turn) * first + std::sin(turn) * second);
    }
    return points;
  }

  void add_arrow(const Vector2d& from, const Vector2d& to, const LineStyle& line, double head) {
    const double length = (to - from).norm();
    if (length <= 0) return;
    // The line ends inside the head, whose tip stays sharp.
    add_line({from, to - (to - from) / length * std::min(length, head * 0.6)}, line);
    add_head(from, to, line.colour, head);
  }

  void add_head(const Vector2d& from, const Vector2d& tip, const Colour& colour, double head) {
    const Vector2d along = (tip - from).normalized();
    const Vector2d across = turned_left(along);
    add_area({tip, tip - along * head + across * head / 6, tip - along * head - across * head / 6},
             colour);
  }

  void add_words(const Words& words, const Vector2d& at) {
    const auto& [text, unused, height, angle, align, level, colour, in_row] = words;
    const double width = text_width(text, height);
    const Vector2d reading = direction_at(angle);
    const Vector2d down = -turned_left(reading);
    const double back = align == TextAlign::left ? 0 : align == TextAlign::centre ? 0.5 : 1;
    const double drop = level == TextLevel::baseline ? 0 : level == TextLevel::middle ? 0.5 : 1;
    Vector2d start = at - reading * (width * back) + down * (height * drop);
    const Vector2d away = reading * (align == TextAlign::right ? -1 : 1);
    const Vector2d by = room_.take({start, reading * width, down * -height},
                                   moves_of(reading, away, height, in_row));
    start += by;
    if (in_row && !by.isZero()) {
      add_line({at - away * (height / 2), at + by}, {colours::kGrey, kExtraNarrow});
    } else if (std::abs(by.dot(reading)) > height) {
      const Vector2d beside = at + down * (height * 0.65);  // the words that had the place
      add_line({beside, beside + by}, {colours::kGrey, kExtraNarrow});
    }
    for (const double along : {0.0, width}) {
      for (const double below : {-kTextAscent, kTextDescent}) {
        result_.bounds.extend(start + reading * along + down * (height * below));
      }
    }
    result_.layers.back().items.push_back(
        SheetText{text, start, height, angle, width * 1.001, colour});
  }

  // The places to which words may move, the nearest first, when their own place is occupied: lines
  // up or down the sheet, and upright words `away` from the object that they name, or aside in a
  // row.
  static std::vector<Vector2d> moves_of(const Vector2d& reading, const Vector2d& away,
                                        double height, bool in_row) {
    constexpr int kMostLines = 40;
    const bool moves_away = std::abs(away.y()) > 0.7 && !in_row;
    std::vector<Vector2d> moves;
    for (int i = 1; i <= kMostLines; ++i) {
      const double by = 0.6 * height * i;
      if (moves_away) {
        moves.emplace_back(away * by);
      } else {
        moves.emplace_back(turned_left(reading) * by);
        moves.emplace_back(turned_left(reading) * -by);
      }
    }
    return moves;
  }

  void add_line(std::vector<Vector2d> points, const LineStyle& line, bool closed = false) {
    extend(points);
    result_.layers.back().items.push_back(SheetLine{std::move(points), line, closed});
  }

  void add_area(std::vector<Vector2d> points, const Colour& fill) {
    extend(points);
    result_.layers.back().items.push_back(SheetArea{{std::move(points)}, fill});
  }

  void extend(const std::vector<Vector2d>& points) {
    for (const Vector2d& point : points) result_.bounds.extend(point);
  }

  double scale_;
  LabelRoom room_;
  SketchOnPaper result_;
};

// Calls the function with every point that determines the item's place.
template <class Function>
void for_each_point(const SketchItem& any, const Function& function) {
  std::visit(
      [&](const auto& item) {
        if constexpr (requires { item.points; }) {
          std::ranges::for_each(item.points, function);
        } else if constexpr (requires { item.from; }) {
          function(item.from);
          function(item.to);
        } else {
          function(item.at);
        }
      },
      any);
}

}  // namespace

SheetItem moved(SheetItem item, const Vector2d& by) {
  for_each_place(item, [&](Vector2d& at) { at += by; });
  return item;
}

SketchOnPaper sketch_on_paper(const Sketch& sketch, double scale_denominator) {
  Drafter drafter(scale_denominator);
  for (const SketchLayer& layer : sketch.layers) {
    drafter.begin_layer(layer.name);
    for (const SketchItem& item : layer.items) std::visit(drafter, item);
  }
  return std::move(drafter).take();
}

std::optional<Vector2d> model_extent(const Sketch& sketch) {
  AlignedBox2d box;
  bool finite = true;
  for (const SketchLayer& layer : sketch.layers) {
    for (const SketchItem& item : layer.items) {
      for_each_point(item, [&](const SketchPoint& point) {
        finite = finite && point.model.allFinite() && point.paper.allFinite();
        box.extend(point.model);
      });
    }
  }
  if (!finite) return std::nullopt;
  return box.isEmpty() ? Vector2d(0, 0) : Vector2d(box.sizes());
}

// ---- A sketch alone.

Sheet picture_sheet(const Sketch& sketch, const std::string& title) {
  constexpr double kMargin = 0.002;
  SketchOnPaper drawn = sketch_on_paper(sketch, 1);
  Sheet sheet;
  sheet.title = title;
  if (drawn.bounds.isEmpty()) return sheet;
  sheet.width = drawn.bounds.sizes().x() + 2 * kMargin;
  sheet.height = drawn.bounds.sizes().y() + 2 * kMargin;
  const Eigen::Vector2d by = Eigen::Vector2d(kMargin, kMargin) - drawn.bounds.min();
  for (SheetLayer& layer : drawn.layers) {
    for (SheetItem& item : layer.items) item = moved(std::move(item), by);
  }
  sheet.layers = std::move(drawn.layers);
  return sheet;
}

}  // namespace tagsmith::detail
