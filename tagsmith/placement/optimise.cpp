// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/optimise.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/placement/plan_summary.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {

// ---- Layouts.

bool all_look_aside(const Rig& rig) {
  return std::ranges::all_of(rig.cameras,
                             [](const RigCamera& camera) { return camera.side.has_value(); });
}

bool is_same(const Layout& a, const Layout& b) {
  return a.tag_template.name == b.tag_template.name && a.series.spacing == b.series.spacing &&
         a.series.mount_height == b.series.mount_height && a.series.pairs == b.series.pairs &&
         a.series.pair_angle == b.series.pair_angle && a.alpha == b.alpha;
}

bool is_served(const PlanColumn& column, const Requirement& requirement) {
  return column.least_tags > requirement.tags_lost &&
         column.worst.plane <= requirement.plane_sigma &&
         (requirement.tags_lost == 0 || column.nominal_one_lost <= requirement.plane_sigma);
}

double served_share(const DrivePlan& plan, const Requirement& requirement,
                    const std::vector<bool>& demanded) {
  int wanted = 0;
  int met = 0;
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    if (!demanded.at(i)) continue;
    ++wanted;
    met += is_served(plan.columns[i], requirement) ? 1 : 0;
  }
  return wanted > 0 ? static_cast<double>(met) / wanted : 1;
}

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

// ---- The search.

namespace {

// ---- The search: the cost and the result of one layout, and how far its plates can be spaced.

constexpr double kSpacingStep = 0.05;     // metres: what an installer can measure
constexpr int kDensest = 1;               // steps: clear gap of plates hung as densely as possible
constexpr int kWidest = 400;              // steps
constexpr int kStepsBeyond = 12;          // tried beyond the first that fails
constexpr double kCoarseStep = 0.10;      // of the chainage while searching
constexpr int kCoarseOffsets = 3;         // over the envelope while searching
constexpr double kFinestShare = 0.5;      // of a plate in the picture, between poses of the proof
constexpr std::size_t kFirstLook = 8;     // columns to one that is checked first
constexpr double kFloorClearance = 0.05;  // of a plate's edge from floor and roof, metres
constexpr double kSightAhead = 40;        // metres beyond the plan's end where tags may still help

// Half the pitch between the walls' plates: each wall's tags stand before the other's gaps.
double stagger_angle(const Survey& survey, const Layout& layout) {
  const TagTemplate& tag = layout.tag_template;
  const double half_pitch = (tag.plate_length + layout.series.spacing) / 2;
  return std::atan2(tag.frame_inner_length + half_pitch,
                    width_at(survey.tunnel, layout.series.first));
}

bool has_half_pitch(const Survey& survey, const Layout& layout) {
  return layout.series.pair_angle &&
         std::abs(*layout.series.pair_angle - stagger_angle(survey, layout)) < 1e-9;
}

// Nor may the right plates' shift take them out of the drive.
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

// Of one plate, square millimetres.
double plate_area(const Layout& layout) {
  const TagTemplate& tag = layout.tag_template;
  return std::round(1e6 * tag.plate_length * tag.plate_height);
}

// Odd, so many values from -most to most that neighbours are at most `step` apart.
int samples_over(double most, double step) {
  constexpr int kMost = 31;
  return std::min(kMost, 2 * static_cast<int>(std::ceil(std::min(most / step, 1e3))) + 1);
}

// Whether the survey's code has digits for the heights of all tags.
bool can_be_coded(const Survey& survey) {
  const auto [low, high] = coded_range(survey.code, 2);
  return std::ranges::all_of(survey.tags, [&, low = low, high = high](const PlacedTag& tag) {
    return tag.p_in_grid.z() >= low && tag.p_in_grid.z() <= high;
  });
}

// Searches with a coarse plan and proves with the plan as requested. Keeps references to all its
// arguments.
class LayoutSearch {
 public:
  LayoutSearch(const Survey& survey, const Rig& rig, const std::vector<TagTemplate>& templates,
               const Requirement& requirement, CostOrder order, const PlanOptions& options)
      : survey_(survey),
        rig_(rig),
        templates_(templates),
        requirement_(requirement),
        order_(order),
        fine_{options, {}},
        coarse_{options, {}} {
    // So that no plate passes through the picture unseen between two poses.
    const double length = survey.tag_template.frame_inner_length;
    const VehicleEnvelope envelope = rig.envelope.value_or(VehicleEnvelope{});
    const double turn = length / least_width(survey.tunnel);
    fine_.options.lateral_offsets =
        std::max(options.lateral_offsets, samples_over(envelope.lateral, kFinestShare * length));
    fine_.options.headings =
        std::max(options.headings, samples_over(envelope.yaw, kFinestShare * turn));
    coarse_.options.step = std::max(options.step, kCoarseStep);
    coarse_.options.lateral_offsets = std::min(options.lateral_offsets, kCoarseOffsets);
    coarse_.options.headings = std::min(options.headings, kCoarseOffsets);
  }

  Layout given() const { return {survey_.tag_template, *survey_.series, std::nullopt}; }

  // Which columns can be served at all: the share of them, of the plan as requested. Fails when
  // none can. Must be called before the functions below.
  Result<double> find_demanded(const Freedom& freedom) {
    for (Demand* demand : {&coarse_, &fine_}) {
      auto columns = find_demanded(demand->options, freedom);
      if (!columns) return fail(columns);
      demand->demanded = std::move(*columns);
    }
    const auto count = std::ranges::count(fine_.demanded, true);
    if (count == 0) {
      return fail(fmt::format(
          "{} with {}: even plates {} m apart, whatever else may vary, leave poses without a "
          "position everywhere: the cameras or the envelope must change first",
          survey_.file.string(), rig_.file.string(), format_number(kDensest * kSpacingStep, 2)));
    }
    return static_cast<double>(count) / static_cast<double>(fine_.demanded.size());
  }

  const std::vector<bool>& demanded() const { return fine_.demanded; }

  // The layout by the plan as asked for.
  LayoutReport report(std::string name, const Layout& layout) const {
    LayoutReport report = priced(std::move(name), layout);
    judge(layout, fine_, report);
    return report;
  }

  bool is_cheaper(const LayoutReport& a, const LayoutReport& b) const {
    if (a.meets != b.meets) return a.meets;
    if (!a.meets) return a.met_share > b.met_share;
    const auto cost = [&](const LayoutReport& report) {
      const double plate = plate_area(report.layout);
      const double tags = report.tags;
      return order_ == CostOrder::tags ? std::tuple(tags, plate) : std::tuple(plate, tags);
    };
    return cost(a) < cost(b);
  }

  // The layout with the largest spacing that still meets the requirement, and no more pairs than
  // necessary, by the coarse plan. With `best`, only if it may be cheaper than that.
  // Why: docs/decisions/0012-planning.md.
  std::optional<LayoutReport> stretched(const std::string& name, const Layout& layout,
                                        const LayoutReport* best = nullptr) const {
    const int least = best != nullptr ? least_steps(layout, *best) : kDensest;
    if (least > kWidest) return std::nullopt;
    int low = least - 1;  // meets, if it is `least` or more
    int high = kWidest + 1;
    // The spacing given is the likeliest of all.
    const int given = static_cast<int>(std::floor(survey_.series->spacing / kSpacingStep));
    for (int middle = best != nullptr ? least : std::clamp(given, least, kWidest); high - low > 1;
         middle = (low + high) / 2) {
      (meets(spaced(layout, middle), coarse_) ? low : high) = middle;
    }
    // In bends, and where the drive ends, a wider spacing may be sufficient where a closer one is
    // not.
    for (int wider = high + 1; wider <= std::min(low + kStepsBeyond, kWidest); ++wider) {
      if (meets(spaced(layout, wider), coarse_)) low = wider;
    }
    if (low >= least) {
      LayoutReport found = priced(name, trimmed(spaced(layout, low)));
      found.meets = true;
      return found;
    }
    if (best != nullptr && best->meets) return std::nullopt;
    LayoutReport failed = priced(name, spaced(layout, least));
    judge(failed.layout, coarse_.thinned(kFirstLook), failed);
    return failed;
  }

  // Proves the result of `stretched` with the plan as requested; hangs the plates closer while it
  // fails.
  LayoutReport proved(const LayoutReport& coarse) const {
    constexpr int kMostSteps = 40;
    Layout layout = coarse.layout;
    for (int i = 0; i < kMostSteps && !meets(layout, fine_); ++i) {
      const int steps = static_cast<int>(std::lround(layout.series.spacing / kSpacingStep)) - 1;
      if (steps < kDensest) break;
      layout = spaced(layout, steps);
    }
    return report(coarse.name, layout);
  }

  // ---- Layouts that differ from this one in one respect.

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
    const double most = std::min(survey_.tunnel.height.least(), 4.0);
    for (int decimetres = 2; decimetres < 10 * most; decimetres += 2) {
      Layout other = layout;
      other.series.mount_height = decimetres / 10.0;
      if (hangs_in_tunnel(other)) all.push_back(other);
    }
    return all;
  }

  std::vector<Layout> staggers(const Layout& layout) const {
    Layout facing = layout;
    facing.series.pair_angle.reset();
    Layout half = layout;
    half.series.pair_angle = stagger_angle(survey_, layout);
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
  // A plan's options, and which of its columns the requirement is for.
  struct Demand {
    PlanOptions options;
    std::vector<bool> demanded;

    // The first column and each `stride`th after it.
    Demand thinned(std::size_t stride) const {
      Demand thin{options, {}};
      thin.options.step *= static_cast<double>(stride);
      // Rounding must not add a column about which nothing is known.
      const double last = static_cast<double>(demanded.size() - 1) * options.step;
      if (!demanded.empty() && last > 0) thin.options.to = options.from.value_or(0) + last;
      for (std::size_t i = 0; i < demanded.size(); i += stride)
        thin.demanded.push_back(demanded[i]);
      return thin;
    }
  };

  Result<DrivePlan> plan_of(const Layout& layout, const PlanOptions& options) const {
    return plan_drive(with_layout(survey_, layout), with_alpha(rig_, layout.alpha), options);
  }

  // The columns that the given layout serves, or plates hung as densely as possible, with any
  // single thing changed that may vary.
  Result<std::vector<bool>> find_demanded(PlanOptions options, const Freedom& freedom) const {
    options.accuracy = false;
    std::vector<Layout> layouts{given(), spaced(given(), kDensest)};
    const auto add = [&](bool allowed, const std::vector<Layout>& others) {
      if (!allowed) return;
      for (const Layout& other : others) layouts.push_back(spaced(other, kDensest));
    };
    add(freedom.mount_height, heights(given()));
    add(freedom.plate, plates(given()));
    add(freedom.alpha, alphas(given()));
    std::vector<bool> columns;
    for (const Layout& layout : layouts) {
      const auto plan = plan_of(layout, options);
      if (!plan) return fail(plan);
      columns.resize(plan->columns.size());
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (plan->columns[i].least_tags > requirement_.tags_lost) columns[i] = true;
      }
      if (std::ranges::all_of(columns, std::identity{})) break;
    }
    return columns;
  }

  // Most layouts fail, and most of those at many places and in the check of sight alone, which is
  // many times as fast as the accuracy.
  bool meets(const Layout& layout, const Demand& demand) const {
    for (const bool accuracy : {false, true}) {
      for (const std::size_t stride : {kFirstLook, std::size_t{1}}) {
        Demand part = demand.thinned(stride);
        part.options.accuracy = accuracy;
        const Result<DrivePlan> plan = plan_of(layout, part.options);
        if (!plan) return false;
        for (std::size_t i = 0; i < plan->columns.size(); ++i) {
          const PlanColumn& column = plan->columns[i];
          const bool served = accuracy ? is_served(column, requirement_)
                                       : column.least_tags > requirement_.tags_lost;
          if (part.demanded.at(i) && !served) return false;
        }
      }
    }
    return true;
  }

  void judge(const Layout& layout, const Demand& demand, LayoutReport& report) const {
    const Result<DrivePlan> plan = plan_of(layout, demand.options);
    if (!plan) return;
    const PlanSummary summary = summarize(*plan);
    report.met_share = served_share(*plan, requirement_, demand.demanded);
    report.meets = report.met_share == 1;
    report.covered_share = summary.covered_share;
    report.worst_plane =
        summary.worst_plane ? summary.worst_plane->worst : std::numeric_limits<double>::infinity();
  }

  LayoutReport priced(std::string name, const Layout& layout) const {
    LayoutReport report;
    report.name = std::move(name);
    report.layout = layout;
    report.tags = 2 * layout.series.pairs;
    report.plate_area = report.tags * plate_area(layout) / 1e6;
    return report;
  }

  // The least spacing at which the layout, before it is trimmed, may cost less than `best` did.
  int least_steps(const Layout& layout, const LayoutReport& best) const {
    if (!best.meets) return kDensest;
    const double plate = plate_area(layout);
    const double best_plate = plate_area(best.layout);
    if (order_ == CostOrder::plate && plate != best_plate) {
      return plate < best_plate ? kDensest : kWidest + 1;
    }
    const int most = pairs_that_fit(survey_, best.layout, up_to());
    int steps = kDensest;
    while (steps <= kWidest && spaced(layout, steps).series.pairs > most) ++steps;
    return steps;
  }

  // As many pairs as may serve the planned stretch.
  Layout spaced(Layout layout, int steps) const {
    const bool half_pitch = has_half_pitch(survey_, layout);
    layout.series.spacing = steps * kSpacingStep;
    if (half_pitch) layout.series.pair_angle = stagger_angle(survey_, layout);
    layout.series.pairs = pairs_that_fit(survey_, layout, up_to());
    return layout;
  }

  // The least number of pairs that still meets what all together do.
  Layout trimmed(Layout layout) const {
    int low = 0;
    int high = layout.series.pairs;
    while (high - low > 1) {
      layout.series.pairs = (low + high) / 2;
      (meets(layout, coarse_) ? high : low) = layout.series.pairs;
    }
    layout.series.pairs = high;
    return layout;
  }

  double up_to() const {
    return fine_.options.to.value_or(survey_.tunnel.centerline.length()) + kSightAhead;
  }

  bool hangs_in_tunnel(const Layout& layout) const {
    const TagTemplate& tag = layout.tag_template;
    const double above = (tag.plate_height - tag.frame_inner_height) / 2 - tag.frame_offset_up;
    const double below = tag.plate_height - above;
    return layout.series.mount_height - below >= kFloorClearance &&
           layout.series.mount_height + above <= survey_.tunnel.height.least() - kFloorClearance &&
           can_be_coded(with_layout(survey_, spaced(layout, kDensest)));
  }

  const Survey& survey_;
  const Rig& rig_;
  const std::vector<TagTemplate>& templates_;
  const Requirement requirement_;
  const CostOrder order_;
  Demand fine_;
  Demand coarse_;
};

// ---- The cheapest layout.

constexpr std::size_t kRounds = 2;  // over all freedoms

// A freedom: layouts that differ from a given one in it.
struct Step {
  bool allowed = true;
  const char* name = "";
  std::vector<Layout> (LayoutSearch::*layouts)(const Layout&) const = nullptr;
};

std::vector<Step> allowed_steps(const Freedom& freedom) {
  std::vector<Step> steps{
      {freedom.plate, "plate and spacing", &LayoutSearch::plates},
      {freedom.mount_height, "height and spacing", &LayoutSearch::heights},
      {freedom.stagger, "stagger and spacing", &LayoutSearch::staggers},
      {freedom.alpha, "alpha and spacing", &LayoutSearch::alphas},
  };
  std::erase_if(steps, [](const Step& step) { return !step.allowed; });
  return steps;
}

// The spacing alone, each freedom with it, then all of them in turn from the best of these.
std::vector<LayoutReport> explore(const LayoutSearch& search, const std::vector<Step>& steps,
                                  const SearchProgress& progress) {
  std::size_t total = 0;
  for (const Step& step : steps) {
    total += (1 + kRounds) * std::invoke(step.layouts, search, search.given()).size();
  }
  std::size_t done = 0;
  const auto best_of = [&](const std::string& name, const LayoutReport& from, const Step& step) {
    LayoutReport best = from;
    for (const Layout& layout : std::invoke(step.layouts, search, from.layout)) {
      if (progress) progress(done++, total);
      auto tried = search.stretched(name, layout, &best);
      if (tried && search.is_cheaper(*tried, best)) best = std::move(*tried);
    }
    best.name = name;
    return best;
  };
  const LayoutReport spacing = *search.stretched("spacing", search.given());
  LayoutReport together = spacing;
  std::vector<LayoutReport> found{spacing};
  for (const Step& step : steps) {
    found.push_back(best_of(step.name, spacing, step));
    if (search.is_cheaper(found.back(), together)) together = found.back();
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (const Step& step : steps) together = best_of("all together", together, step);
  }
  together.name = "all together";
  if (steps.size() > 1) found.push_back(together);
  return found;
}

// The result, by the plan as requested.
std::vector<LayoutReport> prove(const LayoutSearch& search,
                                const std::vector<LayoutReport>& found) {
  std::vector<LayoutReport> proved;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto same = std::ranges::find_if(found, [&](const LayoutReport& earlier) {
      return is_same(earlier.layout, found[i].layout);
    });
    const auto first = static_cast<std::size_t>(same - found.begin());
    proved.push_back(first < i ? proved[first] : search.proved(found[i]));
    proved.back().name = found[i].name;
  }
  return proved;
}

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

Result<Optimisation> optimise(const Survey& survey, const Rig& rig,
                              const std::vector<TagTemplate>& templates,
                              const Requirement& requirement, CostOrder order,
                              const Freedom& freedom, const PlanOptions& options,
                              const SearchProgress& progress) {
  if (auto good = check(survey); !good) return fail(good);
  LayoutSearch search(survey, rig, templates, requirement, order, options);
  const Result<double> demanded_share = search.find_demanded(freedom);
  if (!demanded_share) return fail(demanded_share);
  Optimisation result;
  result.demanded_share = *demanded_share;
  result.demanded = search.demanded();
  result.alpha_can_vary = all_look_aside(rig);
  result.given = search.report("as given", search.given());
  result.alternatives = prove(search, explore(search, allowed_steps(freedom), progress));
  result.chosen = result.given;
  for (const LayoutReport& alternative : result.alternatives) {
    if (search.is_cheaper(alternative, result.chosen)) result.chosen = alternative;
  }
  if (result.chosen.meets) return result;
  return fail(fmt::format(
      "{} with {}: no layout meets the requirement ({} mm in the plane at every pose, {} tags "
      "lost): the best found ({}, {} m apart, {} mm at the worst pose) meets it along {:.1f} % of "
      "the drive that can be served; ask for less, or change the cameras",
      survey.file.string(), rig.file.string(), format_number(1000 * requirement.plane_sigma, 3),
      requirement.tags_lost, result.chosen.name,
      format_number(result.chosen.layout.series.spacing, 2),
      format_number(1000 * result.chosen.worst_plane, 1), 100 * result.chosen.met_share));
}

}  // namespace tagsmith::detail
