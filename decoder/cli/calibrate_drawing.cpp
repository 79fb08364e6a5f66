// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "decoder/calibrate/distortion_curve.hpp"
#include "decoder/calibrate/ray_sigma.hpp"
#include "decoder/cli/calibrate_result.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/web_page.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/svg.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {

// ---- Pictures.

namespace {

using Eigen::Vector2d;

constexpr Colour kDeepBlue{0.05, 0.20, 0.50};

Words words_at(std::string text, const Vector2d& at, TextAlign align = TextAlign::left,
               TextLevel level = TextLevel::baseline) {
  return {.text = std::move(text), .at = at, .align = align, .level = level};
}

Area box(const Vector2d& from, const Vector2d& to, const Colour& fill) {
  return {{from, Vector2d(to.x(), from.y()), to, Vector2d(from.x(), to.y())}, fill};
}

Polyline outline(const Vector2d& from, const Vector2d& to, const LineStyle& line) {
  return {{from, Vector2d(to.x(), from.y()), to, Vector2d(from.x(), to.y())}, line, true};
}

// --- the image on paper ---

// Its upper left corner is the origin.
struct ImageFrame {
  double scale = 0;  // metres on paper a pixel
  int columns = 0;
  int rows = 0;

  explicit ImageFrame(const Camera& camera) : columns(camera.width), rows(camera.height) {
    constexpr double kWidest = 0.17;
    constexpr double kHighest = 0.115;
    scale = std::min(kWidest / columns, kHighest / rows);
  }
  Vector2d at(const Vector2d& pixel) const {
    return {scale * (pixel.x() + 0.5), -scale * (pixel.y() + 0.5)};
  }
  // Of the image's parts, 0 to 1 to the right and down.
  Vector2d share(double right, double down) const {
    return {scale * columns * right, -scale * rows * down};
  }
};

void add_frame(SketchLayer& layer, const ImageFrame& frame) {
  layer.add(outline(frame.share(0, 0), frame.share(1, 1), {colours::kBlack, kNarrow, {}}));
}

// Of so many items every n-th is shown.
std::size_t stride_for(std::size_t count, std::size_t most) { return 1 + count / most; }

// --- coverage ---

struct SigmaClass {
  double below = 0;  // pixels
  Colour colour;
  std::string words;
};

// The colour steps of a ray's sigma; a value above the last one is refused.
std::vector<SigmaClass> sigma_classes(const Camera& camera) {
  const double refused = std::max(2 * kWeakRay, kRefusedRay * camera.width);
  std::vector<SigmaClass> classes{
      {0.1, {0.78, 0.91, 0.80}, ""},     {0.2, {0.90, 0.95, 0.75}, ""},
      {0.5, {1.00, 0.95, 0.68}, ""},     {kWeakRay, {1.00, 0.82, 0.52}, ""},
      {refused, {0.94, 0.58, 0.42}, ""}, {HUGE_VAL, {0.72, 0.30, 0.36}, ""}};
  for (SigmaClass& one : classes) {
    one.words = std::isfinite(one.below) ? "< " + format_number(one.below) : "more, or unknown";
  }
  return classes;
}

Colour colour_of(const std::vector<SigmaClass>& classes, std::optional<double> sigma) {
  const double value = sigma.value_or(HUGE_VAL);
  for (const SigmaClass& one : classes) {
    if (value < one.below) return one.colour;
  }
  return classes.back().colour;
}

// Fine cells, each coloured by the ray at its middle; nothing where the lens shows none.
void add_sigma_map(SketchLayer& layer, const ImageFrame& frame,
                   const CameraCalibration& calibration, const std::vector<SigmaClass>& classes) {
  constexpr int kColumns = 32;
  constexpr int kRows = 24;
  constexpr double kOverlap = 0.02;  // of a cell: neighbours of one colour show no seam
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Vector2d pixel((column + 0.5) * frame.columns / kColumns - 0.5,
                           (row + 0.5) * frame.rows / kRows - 0.5);
      if (!ray_through(calibration.camera, pixel)) continue;
      layer.add(box(frame.share(1.0 * column / kColumns, 1.0 * row / kRows),
                    frame.share(std::min(1.0, (column + 1 + kOverlap) / kColumns),
                                std::min(1.0, (row + 1 + kOverlap) / kRows)),
                    colour_of(classes, ray_sigma_px(calibration, pixel))));
    }
  }
}

void add_corners(SketchLayer& layer, const ImageFrame& frame,
                 const CameraCalibration& calibration) {
  constexpr std::size_t kMost = 2000;
  const Vector2d half_dot(0.0003, 0.0003);
  const std::size_t stride = stride_for(calibration.residuals.size() * 4, kMost);
  std::size_t place = 0;
  for (const TagResidual& tag : calibration.residuals) {
    for (Eigen::Index i = 0; i < 4; ++i, ++place) {
      if (tag.used && place % stride != 0) continue;
      // A square is a twentieth of a disc in a file.
      const Vector2d at = frame.at(tag.seen.segment<2>(2 * i));
      layer.add(box(at - half_dot, at + half_dot, tag.used ? kDeepBlue : colours::kRed));
    }
  }
}

std::string cell_words(const RayGrid::Cell& cell) {
  if (!cell.has_ray) return "no ray";
  const std::string sigma = std::isfinite(cell.worst_sigma_px)
                                ? fmt::format("{:.2g} px", cell.worst_sigma_px)
                                : "unknown";
  return cell.corners > 0 ? sigma : sigma + ", no tag";
}

// The grid of the findings, each cell with its worst ray.
void add_cells(SketchLayer& layer, const ImageFrame& frame, const RayGrid& grid) {
  const LineStyle line{colours::kGrey, kExtraNarrow, {}};
  for (int i = 0; i < RayGrid::kColumns * RayGrid::kRows; ++i) {
    const int column = i % RayGrid::kColumns;
    const int row = i / RayGrid::kColumns;
    const Vector2d from = frame.share(1.0 * column / RayGrid::kColumns, 1.0 * row / RayGrid::kRows);
    const Vector2d to =
        frame.share((column + 1.0) / RayGrid::kColumns, (row + 1.0) / RayGrid::kRows);
    layer.add(outline(from, to, line));
    const std::string words = cell_words(grid.cells[static_cast<std::size_t>(i)]);
    const Vector2d label = from + Vector2d(0.0008, -0.0008);
    layer.add(box(label,
                  label + Vector2d(text_width(words, kWordsHeight) + 0.0012, -kWordsLine + 0.0006),
                  colours::kWhite));
    layer.add(words_at(words, label + Vector2d(0.0006, -0.0024)));
  }
}

void add_legend(SketchLayer& layer, double y, const std::vector<SigmaClass>& classes) {
  double x = 0;
  for (const SigmaClass& one : classes) {
    layer.add(box({x, y}, {x + 0.004, y + 0.0025}, one.colour));
    layer.add(words_at(one.words, {x + 0.005, y + 0.0003}));
    x += 0.009 + text_width(one.words, kWordsHeight);
  }
}

DrawingView coverage_view(const BoardCalibration& result) {
  const CameraCalibration& calibration = result.calibration;
  const ImageFrame frame(calibration.camera);
  const std::vector<SigmaClass> classes = sigma_classes(calibration.camera);
  DrawingView view;
  view.title = "Coverage: how well rays are known, pixels; corners used (blue), left out (red)";
  view.scale = 1;
  add_sigma_map(view.sketch.layer("sigma"), frame, calibration, classes);
  add_corners(view.sketch.layer("corners"), frame, calibration);
  add_cells(view.sketch.layer("cells"), frame, result.assessment.grid);
  add_frame(view.sketch.layer("frame"), frame);
  add_legend(view.sketch.layer("legend"), frame.share(0, 1).y() - 0.006, classes);
  return view;
}

// --- residuals ---

// By how much residuals are magnified: nine of ten of those used are shorter than kUsual.
double magnification(const ImageFrame& frame, const CameraCalibration& calibration) {
  constexpr double kUsual = 0.004;
  std::vector<double> lengths;
  for (const TagResidual& tag : calibration.residuals) {
    if (!tag.used) continue;
    for (Eigen::Index i = 0; i < 4; ++i) lengths.push_back(tag.residual.segment<2>(2 * i).norm());
  }
  const double usual = lengths.empty() ? 1 : std::max(1e-6, quantile(lengths, 0.9));
  return round_step(kUsual / (frame.scale * usual) / 2);
}

void add_residual(SketchLayer& layer, const Vector2d& from, Vector2d way, const Colour& colour) {
  constexpr double kLongest = 0.015;
  if (way.norm() > kLongest) way *= kLongest / way.norm();
  layer.add(Arrow{
      from, Vector2d(from + way), {colour, kExtraNarrow, {}}, std::min(0.0009, 0.5 * way.norm())});
}

// How a residual of a round length is drawn.
void add_scale(SketchLayer& layer, const ImageFrame& frame, double factor, std::size_t stride) {
  constexpr double kShortest = 0.008;
  const double y = frame.share(0, 1).y() - 0.0045;
  const double px = round_step(kShortest / (frame.scale * factor));
  const double length = px * frame.scale * factor;
  layer.add(Arrow{Vector2d(0, y), Vector2d(length, y), {kDeepBlue, kNarrow, {}}, 0.0012});
  const std::string some =
      stride > 1 ? fmt::format("; one corner of {} is drawn", stride) : std::string();
  layer.add(words_at(fmt::format("{:g} px; {:g} times as long as in the picture, at most 15 mm{}",
                                 px, factor, some),
                     {length + 0.002, y}, TextAlign::left, TextLevel::middle));
}

DrawingView residual_view(const BoardCalibration& result) {
  constexpr std::size_t kMost = 1200;
  const CameraCalibration& calibration = result.calibration;
  const ImageFrame frame(calibration.camera);
  const double factor = magnification(frame, calibration);
  const std::size_t stride = stride_for(calibration.residuals.size() * 4, kMost);
  DrawingView view;
  view.title = "Residuals: from where the camera has a corner to where it was seen; left out: red";
  view.scale = 1;
  add_frame(view.sketch.layer("frame"), frame);
  SketchLayer& layer = view.sketch.layer("residuals");
  std::size_t place = 0;
  for (const TagResidual& tag : calibration.residuals) {
    for (Eigen::Index i = 0; i < 4; ++i, ++place) {
      if (place % stride != 0) continue;
      const Vector2d residual = tag.residual.segment<2>(2 * i);
      const Vector2d seen = tag.seen.segment<2>(2 * i);
      const Vector2d way = factor * frame.scale * Vector2d(residual.x(), -residual.y());
      add_residual(layer, frame.at(tag.used ? Vector2d(seen - residual) : seen), way,
                   tag.used ? kDeepBlue : colours::kRed);
    }
  }
  add_scale(view.sketch.layer("legend"), frame, factor, stride);
  return view;
}

// --- distortion ---

// A chart whose lower left corner is at `corner` on paper.
struct Chart {
  Vector2d corner{0, 0};
  Vector2d size{0, 0};
  Vector2d low{0, 0};  // values there
  Vector2d high{1, 1};

  Vector2d at(double x, double y) const {
    const Vector2d share = (Vector2d(x, y) - low).cwiseQuotient(high - low);
    return corner + size.cwiseProduct(share.cwiseMin(1).cwiseMax(0));
  }
};

// Some five round steps over the range.
std::vector<double> ticks(double low, double high) {
  const double step = round_step((high - low) / 7);
  std::vector<double> values;
  const auto last = std::lround(std::floor(high / step + 1e-9));
  for (auto k = std::lround(std::ceil(low / step)); k <= last; ++k) {
    values.push_back(static_cast<double>(k) * step);
  }
  return values;
}

void add_axes(SketchLayer& layer, const Chart& chart) {
  const LineStyle grid{colours::kPale, kExtraNarrow, {}};
  for (const double y : ticks(chart.low.y(), chart.high.y())) {
    const Vector2d at = chart.at(chart.low.x(), y);
    layer.add(Polyline{{at, chart.at(chart.high.x(), y)}, grid});
    layer.add(words_at(fmt::format("{:g}", y), at - Vector2d(0.0015, 0), TextAlign::right,
                       TextLevel::middle));
  }
  for (const double x : ticks(chart.low.x(), chart.high.x())) {
    const Vector2d at = chart.at(x, chart.low.y());
    layer.add(Polyline{{at, chart.at(x, chart.high.y())}, grid});
    layer.add(words_at(fmt::format("{:g}", x), at - Vector2d(0, 0.0012), TextAlign::centre,
                       TextLevel::top));
  }
  layer.add(outline(chart.at(chart.low.x(), chart.low.y()),
                    chart.at(chart.high.x(), chart.high.y()), {colours::kBlack, kNarrow, {}}));
}

// The range of the values with a little room, zero within.
void set_range(Chart& chart, std::span<const double> values) {
  double low = 0, high = 0;
  for (const double value : values) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const double room = std::max(0.08 * (high - low), 1e-3);
  chart.low.y() = low - room;
  chart.high.y() = high + room;
}

// Where corners end.
void add_seen_mark(SketchLayer& layer, const Chart& chart, const DistortionCurve& curve) {
  if (curve.seen_radius >= chart.high.x()) return;
  layer.add(Polyline{
      {chart.at(curve.seen_radius, chart.low.y()), chart.at(curve.seen_radius, chart.high.y())},
      {colours::kGrey, kNarrow, dashed()}});
}

void add_displacement(Sketch& sketch, Chart chart, const DistortionCurve& curve,
                      const CameraCalibration& calibration) {
  std::vector<double> values;
  Polyline line{{}, {kDeepBlue, kWide, {}}};
  for (const DistortionPoint& point : curve.points) values.push_back(point.displacement);
  set_range(chart, values);
  for (const DistortionPoint& point : curve.points) {
    line.points.emplace_back(chart.at(point.radius, point.displacement));
  }
  add_axes(sketch.layer("axes"), chart);
  add_seen_mark(sketch.layer("marks"), chart, curve);
  sketch.layer("curve").add(std::move(line));
  const char* ideal =
      calibration.camera.lens == LensModel::fisheye ? "f x angle" : "f x tan(angle)";
  sketch.layer("words").add(words_at(
      fmt::format("px outward of {}, over the distance from the principal point, px", ideal),
      chart.corner + Vector2d(0, chart.size.y() + 0.0015)));
}

// The range of values that corners support; outside these the curve may leave the chart.
std::vector<double> supported_values(const DistortionCurve& curve) {
  constexpr double kBeyond = 4;  // times as much is still shown where no corner was seen
  double within = 1e-3, all = 1e-3;
  for (const DistortionPoint& point : curve.points) {
    const double value = std::max(point.sigma, std::abs(point.other.value_or(0)));
    all = std::max(all, value);
    if (point.radius <= curve.seen_radius) within = std::max(within, value);
  }
  const double most = std::min(all, kBeyond * within);
  return {-most, most};
}

void add_deviation(Sketch& sketch, Chart chart, const DistortionCurve& curve,
                   const CameraCalibration& calibration) {
  set_range(chart, supported_values(curve));
  Area band{{}, {0.78, 0.85, 0.95}};
  Polyline other{{}, {colours::kOrange, kWide, {}}};
  for (const DistortionPoint& point : curve.points) {
    band.points.emplace_back(chart.at(point.radius, point.sigma));
    if (point.other) other.points.emplace_back(chart.at(point.radius, *point.other));
  }
  for (std::size_t i = curve.points.size(); i-- > 0;) {
    band.points.emplace_back(chart.at(curve.points[i].radius, -curve.points[i].sigma));
  }
  if (!curve.points.empty()) sketch.layer("band").add(std::move(band));
  add_axes(sketch.layer("axes"), chart);
  add_seen_mark(sketch.layer("marks"), chart, curve);
  if (other.points.size() > 1) sketch.layer("curve").add(std::move(other));
  const std::string runner = curve.other
                                 ? fmt::format("; orange: the runner-up, {}",
                                               to_string(calibration.tried[*curve.other].form))
                                 : std::string();
  sketch.layer("words").add(
      words_at("px off the curve above; band: one standard deviation" + runner,
               chart.corner + Vector2d(0, chart.size.y() + 0.0015)));
}

DrawingView distortion_view(const BoardCalibration& result) {
  const DistortionCurve curve = distortion_curve(result.calibration);
  const double farthest = curve.points.empty() ? 1 : std::max(1.0, curve.points.back().radius);
  Chart chart{{0, 0}, {0.155, 0.030}, {0, 0}, {farthest, 1}};
  DrawingView view;
  view.title = "Distortion";
  if (curve.seen_radius < farthest) view.title += "; dashed: the farthest corner seen";
  view.scale = 1;
  view.sketch.layer("band");  // under everything else
  add_displacement(view.sketch, chart, curve, result.calibration);
  chart.corner.y() = -chart.size.y() - 0.011;  // below the other's labels
  add_deviation(view.sketch, chart, curve, result.calibration);
  return view;
}

// --- texts ---

DrawingView summary_view(const BoardCalibration& result) {
  constexpr double kWidth = 0.17;
  constexpr std::size_t kMostFindings = 6;
  DrawingView view;
  view.title = "Verdict: " + verdict_words(result.assessment.trust);
  view.scale = 1;
  SketchLayer& layer = view.sketch.layer("summary");
  double y = 0;
  const auto add = [&](const std::string& text, const Colour& colour) {
    y = add_lines(layer, lines_of(text, kWidth, kWordsHeight), y, colour);
  };
  for (const std::string& fact : calibration_facts(result)) add(fact, colours::kBlack);
  std::string numbers;
  for (const CameraNumber& number : camera_numbers(result.calibration)) {
    numbers += fmt::format("{}{} {:.6g} ± {:.2g}{}{}", numbers.empty() ? "" : ";  ", number.name,
                           number.value, number.sigma, number.unit.empty() ? "" : " ", number.unit);
  }
  add(numbers, colours::kBlack);
  const std::vector<CalibrationFinding>& findings = result.assessment.findings;
  for (std::size_t i = 0; i < std::min(kMostFindings, findings.size()); ++i) {
    const bool is_fault = findings[i].trust != CalibrationTrust::good;
    add(fmt::format("{}: {}", severity_of(findings[i]), findings[i].message),
        is_fault ? colours::kRed : colours::kBlue);
    add(findings[i].remedy, colours::kBlack);
  }
  if (findings.size() > kMostFindings) {
    add(fmt::format("and {} more findings", findings.size() - kMostFindings), colours::kGrey);
  }
  view.new_row = true;
  return view;
}

// The three pictures, in paper's size: the image with its ray sigmas and the corners seen; the
// residuals as arrows; the distortion along the radius, and below it, magnified, its standard
// deviation and how the runner-up differs.
std::vector<DrawingView> calibration_views(const BoardCalibration& result) {
  return {coverage_view(result), residual_view(result), distortion_view(result)};
}

}  // namespace

Result<std::vector<Sheet>> draw_calibration(const BoardCalibration& result) {
  std::vector<DrawingView> views = calibration_views(result);
  views.insert(views.begin() + 2, summary_view(result));
  std::string boards;
  for (const Board& board : result.boards) boards += (boards.empty() ? "" : ", ") + board.name;
  const TitleBlock block{"Calibration of " + result.camera_name,
                         "What photos of boards say of a camera's lens",
                         {{"Boards", boards},
                          {"Photos", std::to_string(result.views.size())},
                          {"Lens", to_string(result.calibration.form)}}};
  return lay_out_sheets(block, views);
}

// ---- The web page.

namespace {

constexpr const char* kCalibrationStyle = R"css(
.good { color: var(--ok); } .weak { color: var(--poor); } .refused { color: var(--faulty); }
.advice { color: #1f5fb0; }
.verdict { font-size: 1.1rem; font-weight: 600; }
.finding { background: var(--card); border: 1px solid var(--line); border-radius: 8px;
  padding: 10px 12px; margin: 0 0 8px; overflow-wrap: anywhere; }
.finding p { margin: 0; }
img { display: block; width: 100%; height: auto; }
th, td { text-align: right; padding: 5px 8px 5px 0; }
th:first-child, td:first-child { text-align: left; overflow-wrap: anywhere; }
@media print { img, .finding { break-inside: avoid; } }
)css";

std::string findings_text(const BoardCalibration& result) {
  if (result.assessment.findings.empty()) return "<p>Nothing to find fault with.</p>\n";
  std::string text;
  for (const CalibrationFinding& finding : result.assessment.findings) {
    text += fmt::format(
        "<div class=\"finding\"><p><b class=\"{0}\">{0}</b> {1}</p><p>{2}.</p></div>\n",
        severity_of(finding), markup_text(finding.message), markup_text(finding.remedy));
  }
  return text;
}

// As a separate image: so the names inside of several SVGs cannot collide.
std::string pictures(const BoardCalibration& result) {
  std::string text;
  for (const DrawingView& view : calibration_views(result)) {
    const std::string title = markup_text(view.title);
    text += fmt::format("<h2>{0}</h2>\n<img alt=\"{0}\" src=\"data:image/svg+xml;base64,{1}\">\n",
                        title, base64(render_svg(picture_sheet(view.sketch, view.title))));
  }
  return text;
}

std::string number_rows(const CameraCalibration& calibration) {
  std::string rows;
  for (const CameraNumber& number : camera_numbers(calibration)) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", number.name,
                        number.in_words(number.value), number.in_words(number.sigma));
  }
  return rows;
}

std::string form_rows(const CameraCalibration& calibration) {
  std::string rows;
  for (const TriedForm& tried : calibration.tried) {
    rows += fmt::format(
        "<tr><td>{}{}</td><td>{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.2g}</td></tr>\n",
        to_string(tried.form),
        to_string(tried.form) == to_string(calibration.form) ? " (chosen)" : "",
        tried.form.parameters(), tried.chi_square, tried.bic, tried.weight);
  }
  return rows;
}

std::string sighting_row(const BoardCalibration& result, const CalibratedSighting& sighting,
                         std::size_t tags) {
  const double freedom = 8 * static_cast<double>(sighting.tags_used) - 7;
  return fmt::format(
      "<tr{}><td>{}</td><td>{}</td><td>{} of {}</td><td>{:.0f}</td><td>{:.2f}</td><td>{}</td>"
      "</tr>\n",
      sighting.used ? "" : " class=\"weak\"", markup_text(result.views[sighting.view].file),
      markup_text(result.boards[sighting.board].name), sighting.used ? sighting.tags_used : 0, tags,
      degrees(sighting.tilt), sighting.camera_from_board.translation.norm(),
      freedom > 0 ? fmt::format("{:.2f}", std::sqrt(sighting.chi_square / freedom)) : "-");
}

std::string photo_rows(const BoardCalibration& result) {
  std::string rows;
  for (const CalibratedSighting& sighting : result.calibration.sightings) {
    std::size_t tags = 0;
    for (const SeenBoardTag& tag : result.views[sighting.view].tags) {
      tags += tag.board == sighting.board ? 1 : 0;
    }
    rows += sighting_row(result, sighting, tags);
  }
  for (const std::size_t place : photos_without_tags(result)) {
    rows += "<tr class=\"weak\"><td>" + markup_text(result.views[place].file) +
            "</td><td>none</td><td>0</td><td></td><td></td><td></td></tr>\n";
  }
  return rows;
}

}  // namespace

std::string calibration_page(const BoardCalibration& result) {
  const CameraCalibration& calibration = result.calibration;
  const std::string title = "Calibration of " + markup_text(result.camera_name);
  std::string page = page_head(title, kCalibrationStyle, false) + "<h1>" + title + "</h1>\n";
  page += fmt::format("<p class=\"verdict {}\">{}</p>\n", to_string(result.assessment.trust),
                      verdict_words(result.assessment.trust));
  page += findings_text(result);
  for (const std::string& fact : calibration_facts(result)) {
    page += "<p class=\"sub\">" + markup_text(fact) + "</p>\n";
  }
  page += pictures(result);
  page += "<h2>Camera</h2>\n" + page_table("<th></th><th>value</th><th>standard deviation</th>",
                                           number_rows(calibration));
  page += "<h2>Photos</h2>\n" +
          page_table(
              "<th>photo</th><th>board</th><th>tags used</th><th>tilt, degrees</th>"
              "<th>distance, m</th><th>residuals, sigmas</th>",
              photo_rows(result));
  page +=
      "<h2>Lens forms that were tried</h2>\n" +
      page_table("<th>form</th><th>parameters</th><th>chi-square</th><th>BIC</th><th>weight</th>",
                 form_rows(calibration));
  return page + "</body>\n</html>\n";
}

}  // namespace tagsmith::detail
