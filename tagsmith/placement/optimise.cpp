// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/optimise.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith {
namespace {

constexpr double kSpacingStep = 0.05;     // metres: what an installer measures off
constexpr double kDensest = 0.05;         // clear gap of plates hung as densely as possible
constexpr double kWidest = 20;            // clear gap
constexpr int kStepsBeyond = 12;          // of the spacing, tried beyond the first that fails
constexpr double kCoarseStep = 0.10;      // of the chainage while searching
constexpr int kCoarseOffsets = 3;         // over the envelope while searching
constexpr std::size_t kRounds = 2;        // over all freedoms
constexpr double kFloorClearance = 0.05;  // of a plate's edge from floor and roof, metres

// Half the pitch between the walls' plates: each wall's tags stand before the other's gaps.
double stagger_angle(const TagTemplate& tag, double spacing, double width) {
  const double half_pitch = (tag.plate_length + spacing) / 2;
  return std::atan2(tag.frame_inner_length + half_pitch, width);
}

bool has_half_pitch(const Survey& survey, const Layout& layout) {
  return layout.series.pair_angle &&
         std::abs(*layout.series.pair_angle -
                  stagger_angle(layout.tag_template, layout.series.spacing,
                                width_at(survey.tunnel, layout.series.first))) < 1e-9;
}

// The right plates' shift may not take them out of the drive either.
double last_chainage(const Survey& survey, const Layout& layout) {
  const double shift =
      layout.series.pair_angle
          ? std::max(0.0, greatest_width(survey.tunnel) * std::tan(*layout.series.pair_angle) -
                              layout.tag_template.frame_inner_length)
          : 0.0;
  return survey.tunnel.centerline.length() - layout.tag_template.plate_length - shift;
}

int pairs_that_fit(const Survey& survey, const Layout& layout, double up_to) {
  const double room = std::min(last_chainage(survey, layout), up_to) - layout.series.first;
  const double pitch = layout.tag_template.plate_length + layout.series.spacing;
  return room < 0 ? 0 : static_cast<int>(std::floor(room / pitch + 1e-9)) + 1;
}

bool all_look_aside(const Rig& rig) {
  return std::ranges::all_of(rig.cameras,
                             [](const RigCamera& camera) { return camera.side.has_value(); });
}

class Search {
 public:
  Search(const Survey& survey, const Rig& rig, const std::vector<TagTemplate>& templates,
         const Requirement& requirement, CostOrder order, const PlanOptions& options)
      : survey_(survey),
        rig_(rig),
        templates_(templates),
        requirement_(requirement),
        order_(order),
        fine_(options),
        coarse_(options) {
    coarse_.step = std::max(options.step, kCoarseStep);
    coarse_.lateral_offsets = std::min(options.lateral_offsets, kCoarseOffsets);
    coarse_.headings = std::min(options.headings, kCoarseOffsets);
  }

  Layout given() const { return {survey_.tag_template, *survey_.series, std::nullopt}; }

  // Which columns can be served at all; fails when none can.
  Result<double> find_demanded() {
    auto coarse = demanded(coarse_);
    if (!coarse) return fail(coarse.error().message);
    auto fine = demanded(fine_);
    if (!fine) return fail(fine.error().message);
    coarse_demanded_ = std::move(*coarse);
    fine_demanded_ = std::move(*fine);
    const auto count = std::ranges::count(fine_demanded_, true);
    if (count == 0) {
      return fail(fmt::format(
          "{} with {}: even plates {} m apart leave poses without a position everywhere: the "
          "cameras or the envelope must change first",
          survey_.file.string(), rig_.file.string(), format_number(kDensest, 2)));
    }
    return static_cast<double>(count) / static_cast<double>(fine_demanded_.size());
  }

  LayoutReport report(std::string name, const Layout& layout, bool fine) const {
    LayoutReport report;
    report.name = std::move(name);
    report.layout = layout;
    report.tags = 2 * layout.series.pairs;
    report.plate_area =
        report.tags * layout.tag_template.plate_length * layout.tag_template.plate_height;
    if (!fine && !is_read_everywhere(layout, report)) return report;
    const Result<DrivePlan> plan = plan_of(layout, fine ? fine_ : coarse_);
    if (!plan) return report;
    judge(*plan, fine ? fine_demanded_ : coarse_demanded_, report);
    return report;
  }

  bool is_cheaper(const LayoutReport& a, const LayoutReport& b) const {
    if (a.meets != b.meets) return a.meets;
    if (!a.meets) return a.met_share > b.met_share;
    const auto cost = [&](const LayoutReport& report) {
      const TagTemplate& tag = report.layout.tag_template;
      const double plate = std::round(1e6 * tag.plate_length * tag.plate_height);
      return order_ == CostOrder::tags ? std::tuple(static_cast<double>(report.tags), plate)
                                       : std::tuple(plate, static_cast<double>(report.tags));
    };
    return cost(a) < cost(b);
  }

  // The layout with the largest spacing that still meets the requirement, and no more pairs than it
  // takes.
  LayoutReport stretched(const std::string& name, const Layout& layout) const {
    const int densest = static_cast<int>(std::lround(kDensest / kSpacingStep));
    int low = densest - 1;  // meets, once it is a spacing
    int high = static_cast<int>(std::lround(kWidest / kSpacingStep)) + 1;
    // The spacing given is the likeliest of all.
    const int likely = std::clamp(
        static_cast<int>(std::floor(survey_.series->spacing / kSpacingStep)), densest, high - 1);
    for (int middle = likely; high - low > 1; middle = (low + high) / 2) {
      (report(name, spaced(layout, middle * kSpacingStep), false).meets ? low : high) = middle;
    }
    // In bends, and where the drive ends, a wider spacing may do what a closer one does not.
    for (int wider = low + 1; wider <= low + kStepsBeyond && low >= densest; ++wider) {
      if (report(name, spaced(layout, wider * kSpacingStep), false).meets) low = wider;
    }
    const double spacing = std::max(low, densest) * kSpacingStep;
    return trimmed(report(name, spaced(layout, spacing), false));
  }

  // Proves the coarse search's result with the plan as asked for; hangs the plates closer while
  // that does not hold.
  LayoutReport proved(const LayoutReport& coarse) const {
    constexpr int kMostSteps = 40;
    LayoutReport fine = report(coarse.name, coarse.layout, true);
    Layout layout = coarse.layout;
    for (int i = 0; i < kMostSteps && !fine.meets; ++i) {
      const double spacing = layout.series.spacing - kSpacingStep;
      if (spacing < kDensest - 1e-9) break;
      layout = spaced(layout, spacing);
      fine = report(coarse.name, layout, true);
    }
    return fine;
  }

  // Layouts that differ from this one in one respect.
  std::vector<Layout> plates(const Layout& layout) const {
    std::vector<Layout> all;
    for (const TagTemplate& tag : templates_) {
      Layout other = layout;
      other.tag_template = tag;
      if (hangs_in_tunnel(other)) all.push_back(other);
    }
    return all;
  }

  std::vector<Layout> heights(const Layout& layout) const {
    std::vector<Layout> all;
    for (double height = 0.2; height < std::min(survey_.tunnel.height.least(), 4.0);
         height += 0.2) {
      Layout other = layout;
      other.series.mount_height = std::round(height * 100) / 100;
      if (hangs_in_tunnel(other)) all.push_back(other);
    }
    return all;
  }

  std::vector<Layout> staggers(const Layout& layout) const {
    Layout facing = layout;
    facing.series.pair_angle.reset();
    Layout half = layout;
    half.series.pair_angle = stagger_angle(layout.tag_template, layout.series.spacing,
                                           width_at(survey_.tunnel, layout.series.first));
    return {facing, half};
  }

  std::vector<Layout> alphas(const Layout& layout) const {
    std::vector<Layout> all;
    if (!all_look_aside(rig_)) return all;
    for (int alpha = 15; alpha <= 75; alpha += 5) {
      Layout other = layout;
      other.alpha = radians(alpha);
      all.push_back(other);
    }
    return all;
  }

 private:
  Result<DrivePlan> plan_of(const Layout& layout, const PlanOptions& options) const {
    return plan_drive(with_layout(survey_, layout), with_alpha(rig_, layout.alpha), options);
  }

  // Sight alone, which is many times as fast as the accuracy: false, with the share that is served,
  // where some demanded column has too few tags.
  bool is_read_everywhere(const Layout& layout, LayoutReport& report) const {
    PlanOptions sight = coarse_;
    sight.accuracy = false;
    const Result<DrivePlan> plan = plan_of(layout, sight);
    if (!plan) return false;
    int wanted = 0;
    int met = 0;
    for (std::size_t i = 0; i < plan->columns.size(); ++i) {
      if (!coarse_demanded_[i]) continue;
      ++wanted;
      met += plan->columns[i].least_tags > requirement_.tags_lost ? 1 : 0;
    }
    report.met_share = wanted > 0 ? static_cast<double>(met) / wanted : 1;
    return met == wanted;
  }

  bool serves(const PlanColumn& column) const {
    return column.least_tags > requirement_.tags_lost &&
           column.worst.plane <= requirement_.plane_sigma &&
           (requirement_.tags_lost == 0 || column.nominal_one_lost <= requirement_.plane_sigma);
  }

  void judge(const DrivePlan& plan, const std::vector<bool>& demanded, LayoutReport& report) const {
    int wanted = 0;
    int met = 0;
    int covered = 0;
    double worst = -1;
    for (std::size_t i = 0; i < plan.columns.size(); ++i) {
      const PlanColumn& column = plan.columns[i];
      covered += column.least_tags > 0 ? 1 : 0;
      if (std::isfinite(column.worst.plane)) worst = std::max(worst, column.worst.plane);
      if (!demanded[i]) continue;
      ++wanted;
      met += serves(column) ? 1 : 0;
    }
    report.meets = met == wanted;
    report.met_share = wanted > 0 ? static_cast<double>(met) / wanted : 1;
    report.covered_share = static_cast<double>(covered) / static_cast<double>(plan.columns.size());
    report.worst_plane = worst < 0 ? std::numeric_limits<double>::infinity() : worst;
  }

  Result<std::vector<bool>> demanded(const PlanOptions& options) const {
    const auto as_given = plan_of(given(), options);
    if (!as_given) return fail(as_given.error().message);
    const auto densest = plan_of(spaced(given(), kDensest), options);
    if (!densest) return fail(densest.error().message);
    std::vector<bool> columns;
    for (std::size_t i = 0; i < as_given->columns.size(); ++i) {
      columns.push_back(as_given->columns[i].least_tags > requirement_.tags_lost ||
                        densest->columns[i].least_tags > requirement_.tags_lost);
    }
    return columns;
  }

  // As many pairs as may serve the planned stretch.
  Layout spaced(Layout layout, double spacing) const {
    const bool half_pitch = has_half_pitch(survey_, layout);
    layout.series.spacing = spacing;
    if (half_pitch) {
      layout.series.pair_angle = stagger_angle(layout.tag_template, spacing,
                                               width_at(survey_.tunnel, layout.series.first));
    }
    const double up_to = fine_.to.value_or(survey_.tunnel.centerline.length()) + kSightAhead;
    layout.series.pairs = pairs_that_fit(survey_, layout, up_to);
    return layout;
  }

  LayoutReport trimmed(LayoutReport full) const {
    if (!full.meets) return full;
    int low = 0;
    int high = full.layout.series.pairs;
    LayoutReport best = full;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      Layout fewer = full.layout;
      fewer.series.pairs = middle;
      LayoutReport tried = report(full.name, fewer, false);
      if (tried.meets) {
        high = middle;
        best = std::move(tried);
      } else {
        low = middle;
      }
    }
    return best;
  }

  bool hangs_in_tunnel(const Layout& layout) const {
    const TagTemplate& tag = layout.tag_template;
    const double above = (tag.plate_height - tag.frame_inner_height) / 2 - tag.frame_offset_up;
    const double below = tag.plate_height - above;
    return layout.series.mount_height - below >= kFloorClearance &&
           layout.series.mount_height + above <= survey_.tunnel.height.least() - kFloorClearance;
  }

  static constexpr double kSightAhead =
      40;  // metres beyond the plan's end where tags may still help

  const Survey& survey_;
  const Rig& rig_;
  const std::vector<TagTemplate>& templates_;
  const Requirement requirement_;
  const CostOrder order_;
  PlanOptions fine_;
  PlanOptions coarse_;
  std::vector<bool> coarse_demanded_;
  std::vector<bool> fine_demanded_;
};

struct Step {
  std::string name;
  bool allowed = false;
  std::function<std::vector<Layout>(const Layout&)> layouts;
};

Result<void> check(const Survey& survey) {
  if (!survey.series) {
    return fail(survey.file.string() +
                ": has no regular tags (spacing, first, pairs), expected some: placed tags hang "
                "where they hang");
  }
  const bool as_built = std::ranges::any_of(survey.tags, &PlacedTag::surveyed);
  if (as_built) {
    return fail(survey.file.string() +
                ": has tags under `placed`, expected regular ones only: tags that hang already are "
                "not moved");
  }
  return {};
}

}  // namespace

Survey with_layout(const Survey& survey, const Layout& layout) {
  Survey changed = survey;
  changed.tag_template = layout.tag_template;
  changed.series = layout.series;
  changed.tags.clear();
  for (int pair = 0; pair < layout.series.pairs; ++pair) {
    changed.tags.push_back(place_in_series(changed, pair, Side::left));
    changed.tags.push_back(place_in_series(changed, pair, Side::right));
  }
  return changed;
}

Rig with_alpha(const Rig& rig, std::optional<double> alpha) {
  Rig changed = rig;
  if (!alpha) return changed;
  for (RigCamera& camera : changed.cameras) {
    const Eigen::Vector3d axis = camera.vehicle_from_camera.rotation.col(2);
    const Eigen::Vector3d wanted =
        vehicle_from_side_camera(camera.side.value(), *alpha).rotation.col(2);
    const double turn = std::atan2(wanted.y(), wanted.x()) - std::atan2(axis.y(), axis.x());
    camera.vehicle_from_camera.rotation =
        Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * camera.vehicle_from_camera.rotation;
  }
  return changed;
}

Result<Optimisation> optimise(const Survey& survey, const Rig& rig,
                              const std::vector<TagTemplate>& templates,
                              const Requirement& requirement, CostOrder order,
                              const Freedom& freedom, const PlanOptions& options,
                              const SearchProgress& progress) {
  if (auto good = check(survey); !good) return fail(good.error().message);
  Search search(survey, rig, templates, requirement, order, options);
  const Result<double> demanded = search.find_demanded();
  if (!demanded) return fail(demanded.error().message);
  Optimisation result;
  result.demanded_share = *demanded;
  result.alpha_can_vary = all_look_aside(rig);
  result.given = search.report("as given", search.given(), true);

  const std::vector<Step> steps{
      {"plate and spacing", freedom.plate, [&](const Layout& l) { return search.plates(l); }},
      {"height and spacing", freedom.mount_height,
       [&](const Layout& l) { return search.heights(l); }},
      {"stagger and spacing", freedom.stagger, [&](const Layout& l) { return search.staggers(l); }},
      {"alpha and spacing", freedom.alpha, [&](const Layout& l) { return search.alphas(l); }}};
  std::size_t total = 0;
  for (const Step& step : steps) {
    if (step.allowed) total += (1 + kRounds) * step.layouts(search.given()).size();
  }
  std::size_t done = 0;
  const auto best_of = [&](const std::string& name, const LayoutReport& from, const Step& step) {
    LayoutReport best = from;
    for (const Layout& layout : step.layouts(from.layout)) {
      if (progress) progress(done++, total);
      LayoutReport tried = search.stretched(name, layout);
      if (search.is_cheaper(tried, best)) best = std::move(tried);
    }
    return best;
  };
  const LayoutReport spacing = search.stretched("spacing", search.given());
  LayoutReport together = spacing;
  std::vector<LayoutReport> found{spacing};
  for (const Step& step : steps) {
    if (!step.allowed) continue;
    found.push_back(best_of(step.name, spacing, step));
    found.back().name = step.name;
    if (search.is_cheaper(found.back(), together)) together = found.back();
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (const Step& step : steps) {
      if (step.allowed) together = best_of("all together", together, step);
    }
  }
  together.name = "all together";
  found.push_back(together);
  result.chosen = result.given;
  for (const LayoutReport& coarse : found) {
    result.alternatives.push_back(search.proved(coarse));
    if (search.is_cheaper(result.alternatives.back(), result.chosen)) {
      result.chosen = result.alternatives.back();
    }
  }
  if (!result.chosen.meets) {
    return fail(fmt::format(
        "no layout meets the requirement ({} mm in the plane at every pose, {} tags lost): the "
        "best "
        "found ({}, {} m apart) meets it along {:.1f} % of the drive that can be served; ask for "
        "less, or change the cameras",
        format_number(1000 * requirement.plane_sigma, 3), requirement.tags_lost, result.chosen.name,
        format_number(result.chosen.layout.series.spacing, 2), 100 * result.chosen.met_share));
  }
  return result;
}

}  // namespace tagsmith
