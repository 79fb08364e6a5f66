// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/run_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "decoder/cli/magnified.hpp"
#include "decoder/paper/published.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// A fix and its truth in the world, seen from above.
struct Mark {
  std::string id;
  double chainage = 0;
  std::optional<Vector2d> fix;
  std::optional<Matrix2d> covariance;
  std::optional<Vector2d> truth;
  std::optional<FixError> error;
};

Vector2d plane_point(const Survey& survey, const Vector3d& in_grid) {
  return world_from_grid(survey.grid, in_grid).head<2>();
}

std::vector<Mark> marks_of(const Survey& survey, const Run& run, const std::vector<Fix>& fixes) {
  const Vector2d signs = plane_point(survey, Vector3d::Ones());
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const Fix& fix = fixes[i];
    const Measurement& measurement = run.measurements[i];
    Mark mark;
    mark.id = fix.id;
    if (measurement.truth_in_grid) mark.truth = plane_point(survey, *measurement.truth_in_grid);
    if (fix.position_in_grid && fix.survey == survey.name) {
      mark.fix = plane_point(survey, *fix.position_in_grid);
      mark.error = error_of(fix, measurement);
      if (fix.covariance_in_grid) {
        const Matrix2d in_grid = fix.covariance_in_grid->topLeftCorner<2, 2>();
        mark.covariance = signs.asDiagonal() * in_grid * signs.asDiagonal();
      }
    }
    if (!mark.fix && !mark.truth) continue;
    mark.chainage = survey.tunnel.centerline.locate(mark.truth.value_or(*mark.fix)).chainage;
    marks.push_back(std::move(mark));
  }
  return marks;
}

// The factor by which errors are magnified, so that nine of ten stay within a fifth of the tunnel.
double magnification(const Survey& survey, const std::vector<Mark>& marks) {
  std::vector<double> sizes;
  for (const Mark& mark : marks) {
    double size = mark.error ? mark.error->plane : 0;
    if (mark.covariance) {
      size = std::max(size, kEllipse95 * std::sqrt(mark.covariance->trace()));
    }
    if (mark.fix) sizes.push_back(size);
  }
  return magnification_for(survey.tunnel, std::move(sizes));
}

// --- plan ---

constexpr std::size_t kMostNames = 60;  // on one strip; more would overlap

void add_mark(Sketch& sketch, const PlanStrip& strip, const Mark& mark, double factor, bool named) {
  const Matrix2d turn = strip.view_from_world.linear();
  const auto in_view = [&](const Vector2d& point) { return strip.view_from_world * point; };
  const Vector2d origin = in_view(mark.truth.value_or(mark.fix.value_or(Vector2d::Zero())));
  if (mark.truth) sketch.layer("truth").add(Dot{origin, 0.0006, colours::kGreen});
  if (mark.fix) {
    const Vector2d shown = origin + factor * (in_view(*mark.fix) - origin);
    if (mark.covariance) {
      const Matrix2d covariance = turn * *mark.covariance * turn.transpose();
      sketch.layer("ellipses").add(ellipse95(shown, covariance, factor));
    }
    if (mark.truth) {
      sketch.layer("errors").add(Arrow{origin, shown, {colours::kRed, kNarrow, {}}, 0.0015});
    }
    sketch.layer("fixes").add(Dot{shown, 0.0005, colours::kBlue});
  }
  if (!named) return;
  sketch.layer("run").add(Words{.text = mark.fix ? mark.id : mark.id + ": no position",
                                .at = {origin, {0, -0.0035}},
                                .align = TextAlign::centre,
                                .colour = mark.fix ? colours::kBlack : colours::kRed});
}

void add_track(Sketch& sketch, const PlanStrip& strip, const std::vector<const Mark*>& marks) {
  Polyline track;
  track.line = {colours::kGreen, kExtraNarrow, {}};
  for (const Mark* mark : marks) {
    if (mark->truth) track.points.emplace_back(strip.view_from_world * *mark->truth);
  }
  if (track.points.size() > 1) sketch.layer("truth").add(std::move(track));
}

std::vector<DrawingView> plan_views(const Survey& survey, const std::vector<Mark>& marks,
                                    double factor) {
  const std::vector<PlanStrip> strips = plan_strips(survey);
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : strips) {
    const bool is_first = &strip == &strips.front();
    const bool is_last = &strip == &strips.back();
    std::vector<const Mark*> here;
    for (const Mark& mark : marks) {
      if ((mark.chainage >= strip.from || is_first) && (mark.chainage < strip.to || is_last)) {
        here.push_back(&mark);
      }
    }
    if (here.empty()) continue;
    DrawingView view = plan_view(survey, strip);
    if (factor != 1) {
      view.title += fmt::format("; errors and 95 % ellipses magnified {:g} times", factor);
    }
    add_track(view.sketch, strip, here);
    for (const Mark* mark : here) {
      add_mark(view.sketch, strip, *mark, factor, here.size() <= kMostNames);
    }
    views.push_back(std::move(view));
  }
  return views;
}

// --- chart of the errors ---

// Paper metres from the chart's lower left corner.
constexpr double kChartWidth = 0.15;
constexpr double kChartHeight = 0.05;

Words chart_words(std::string text, double x, double y, TextAlign align,
                  TextLevel level = TextLevel::middle) {
  return {.text = std::move(text), .at = on_paper(x, y), .align = align, .level = level};
}

void add_axes(SketchLayer& layer, double top_mm) {
  const LineStyle frame{colours::kBlack, kNarrow, {}};
  const LineStyle grid{colours::kPale, kExtraNarrow, {}};
  for (const int quarter : {1, 2, 3, 4}) {
    const double y = kChartHeight * quarter / 4;
    layer.add(Polyline{{on_paper(0, y), on_paper(kChartWidth, y)}, grid, false});
    layer.add(chart_words(fmt::format("{:g}", top_mm * quarter / 4), -0.0015, y, TextAlign::right));
  }
  layer.add(chart_words("0", -0.0015, 0, TextAlign::right));
  layer.add(chart_words("mm", -0.0015, kChartHeight + 0.005, TextAlign::right));
  layer.add(Polyline{
      {on_paper(0, kChartHeight), on_paper(0, 0), on_paper(kChartWidth, 0)}, frame, false});
}

void add_bar(SketchLayer& layer, double x, double width, double height, const Colour& colour) {
  layer.add(Area{
      {on_paper(x, 0), on_paper(x + width, 0), on_paper(x + width, height), on_paper(x, height)},
      colour});
}

// The least of 1, 2, 4, 8 times a power of ten that is not below `value`: quarters of it are round.
double round_top(double value) {
  const double power = std::pow(10, std::floor(std::log10(std::max(value, 1e-6))));
  for (const double step : {1.0, 2.0, 4.0, 8.0}) {
    if (step * power >= value) return step * power;
  }
  return 10 * power;
}

// Bars of each fix's error in the plane and in height, as in Figs 20 and 21 of Xu et al. 2017.
std::optional<DrawingView> error_chart(const std::vector<Mark>& marks) {
  std::vector<const Mark*> with_error;
  double greatest = 0;
  for (const Mark& mark : marks) {
    if (!mark.error) continue;
    with_error.push_back(&mark);
    greatest = std::max({greatest, mark.error->plane, mark.error->height});
  }
  if (with_error.empty()) return std::nullopt;
  const double top = round_top(1000 * greatest);
  DrawingView view;
  view.title = "Errors: in the plane (blue), of z (orange)";
  SketchLayer& layer = view.sketch.layer("errors");
  add_axes(layer, top);
  const double step = kChartWidth / static_cast<double>(with_error.size());
  const std::size_t names_every = 1 + with_error.size() / 20;
  for (std::size_t i = 0; i < with_error.size(); ++i) {
    const Mark& mark = *with_error[i];
    const double x = step * static_cast<double>(i);
    const double scale = kChartHeight * 1000 / top;
    add_bar(layer, x + 0.15 * step, 0.35 * step, scale * mark.error->plane, colours::kBlue);
    add_bar(layer, x + 0.50 * step, 0.35 * step, scale * mark.error->height, colours::kOrange);
    if (i % names_every == 0) {
      layer.add(chart_words(mark.id, x + step / 2, -0.0015, TextAlign::centre, TextLevel::top));
    }
  }
  view.new_row = true;
  return view;
}

// --- summary ---

std::string error_words(const char* name, const std::optional<FixError>& error) {
  if (!error) return {};
  return fmt::format("{}: {:.2f} mm in the plane, {:.2f} mm in z", name, 1000 * error->plane,
                     1000 * error->height);
}

DrawingView summary_view(const Survey& survey, const Run& run, const std::vector<Fix>& fixes) {
  const FixSummary summary = summarize(fixes, run.measurements);
  const PublishedErrors& published = published_errors_for(survey.tunnel.centerline);
  std::vector<std::string> lines{
      fmt::format("{}, {} located", counted(summary.count, "measurement"), summary.located),
      error_words("mean error", summary.mean_error),
      error_words("95 % of the errors", summary.error95),
      error_words("greatest error", summary.max_error)};
  if (summary.mean_error) {
    lines.push_back(fmt::format("Xu et al. 2017, {}: mean {:.0f} mm in the plane, {:.0f} mm in z",
                                published.experiment, 1000 * published.mean_plane,
                                1000 * published.mean_height));
  }
  lines.emplace_back("green: truth; blue: positions and their 95 % ellipses; red: errors");
  DrawingView view;
  view.title = "Run";
  std::erase(lines, "");
  add_lines(view.sketch.layer("summary"), lines, 0, colours::kBlack, 0.0025, 0.006);
  return view;
}

std::string methods_of(const std::vector<Fix>& fixes) {
  std::set<std::string> methods;
  std::string text;
  for (const Fix& fix : fixes) {
    if (methods.insert(fix.method).second) text += (text.empty() ? "" : ", ") + fix.method;
  }
  return text;
}

}  // namespace

Result<std::vector<Sheet>> draw_run(const Survey& survey, const Rig& rig, const Run& run,
                                    const std::vector<Fix>& fixes) {
  const std::vector<Mark> marks = marks_of(survey, run, fixes);
  std::vector<DrawingView> views = plan_views(survey, marks, magnification(survey, marks));
  if (auto chart = error_chart(marks)) views.push_back(std::move(*chart));
  views.push_back(summary_view(survey, run, fixes));
  const TitleBlock block{
      survey.name,
      "located run",
      {{"run", run.file.filename().string()}, {"rig", rig.name}, {"method", methods_of(fixes)}}};
  return lay_out_sheets(block, views, {.coarsest_scale = coarsest_plan_scale(survey)});
}

}  // namespace tagsmith::detail
