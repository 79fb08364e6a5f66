// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/plan_summary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tagsmith::detail {
namespace {

constexpr double kWindow = 1.0;      // metres, of the worst stretch
constexpr double kMayBeLost = 0.01;  // of the positions, at "most" speeds

WallShare share_of(const DrivePlan& plan, WallCount PlanColumn::*counts) {
  double both = 0;
  double one = 0;
  for (const PlanColumn& column : plan.columns) {
    both += (column.*counts).both;
    one += (column.*counts).one;
  }
  const double poses =
      static_cast<double>(plan.columns.size()) * static_cast<double>(plan.poses_per_column);
  return {both / poses, one / poses, 1 - (both + one) / poses};
}

double share_of_columns(const DrivePlan& plan, const std::function<bool(const PlanColumn&)>& is) {
  return static_cast<double>(std::ranges::count_if(plan.columns, is)) /
         static_cast<double>(plan.columns.size());
}

double quantile_of_sorted(const std::vector<double>& sorted, double share) {
  const double last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(share * last))];
}

std::optional<SigmaRange> range_of(const DrivePlan& plan,
                                   const std::function<double(const PlanColumn&)>& value) {
  std::vector<double> values;
  for (const PlanColumn& column : plan.columns) {
    if (const double v = value(column); std::isfinite(v)) values.push_back(v);
  }
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  return SigmaRange{quantile_of_sorted(values, 0.5), quantile_of_sorted(values, 0.95),
                    values.back()};
}

// Runs of columns that are so.
std::vector<Stretch> stretches(const DrivePlan& plan, const std::vector<bool>& is) {
  std::vector<Stretch> runs;
  for (std::size_t i = 0; i < is.size(); ++i) {
    if (!is[i]) continue;
    const double chainage = plan.columns[i].chainage;
    if (i == 0 || !is[i - 1]) runs.push_back({chainage, chainage});
    runs.back().to = chainage;
  }
  return runs;
}

std::vector<bool> gap_columns(const DrivePlan& plan) {
  std::vector<bool> gaps;
  for (const PlanColumn& column : plan.columns) gaps.push_back(!is_covered(plan, column));
  return gaps;
}

// The window with the greatest mean of the envelope's worst sigma; columns without a position do
// not count, they are gaps.
void find_worst_stretch(const DrivePlan& plan, PlanSummary& summary) {
  const auto size = std::clamp<std::size_t>(static_cast<std::size_t>(kWindow / plan.options.step),
                                            1, plan.columns.size());
  const auto sigma = [&](std::size_t i) {
    const double value = plan.columns[i].worst.plane;
    return std::isfinite(value) ? value : 0.0;
  };
  double sum = 0;
  double most = 0;
  std::size_t best = 0;
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    sum += sigma(i) - (i >= size ? sigma(i - size) : 0);
    if (i + 1 >= size && sum > most) {
      most = sum;
      best = i + 1 - size;
    }
  }
  if (most <= 0) return;
  summary.worst_stretch =
      Stretch{plan.columns[best].chainage, plan.columns[best + size - 1].chainage};
  for (std::size_t i = best; i < best + size; ++i) {
    summary.worst_stretch_sigma = std::max(summary.worst_stretch_sigma, sigma(i));
  }
}

// The run of gaps and of the tag's own columns around one of these.
Stretch gap_around(const DrivePlan& plan, const std::vector<bool>& gaps,
                   const std::vector<std::size_t>& own, std::size_t start) {
  const auto is_gap = [&](std::size_t i) { return gaps[i] || std::ranges::binary_search(own, i); };
  std::size_t low = start;
  std::size_t high = start;
  while (low > 0 && is_gap(low - 1)) --low;
  while (high + 1 < gaps.size() && is_gap(high + 1)) ++high;
  return {plan.columns[low].chainage, plan.columns[high].chainage};
}

// The effect on the drive when one tag is lost.
void find_critical_tags(const DrivePlan& plan, PlanSummary& summary) {
  const std::vector<bool> gaps = gap_columns(plan);
  std::vector<std::vector<std::size_t>> columns(plan.tags.size());
  std::vector<bool> fragile = gaps;
  for (const SoleTag& sole : plan.sole_tags) {
    fragile[sole.column] = true;
    if (!gaps[sole.column]) columns[sole.tag].push_back(sole.column);
  }
  summary.covered_share_one_lost =
      static_cast<double>(std::ranges::count(fragile, false)) / static_cast<double>(gaps.size());
  for (std::size_t tag = 0; tag < columns.size(); ++tag) {
    const std::vector<std::size_t>& own = columns[tag];
    if (own.empty()) continue;
    CriticalTag critical{tag, static_cast<double>(own.size()) * plan.options.step, {}};
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (i > 0 && own[i] == own[i - 1] + 1) continue;  // the same run
      const Stretch gap = gap_around(plan, gaps, own, own[i]);
      if (i == 0 || gap.length() > critical.longest_gap.length()) critical.longest_gap = gap;
    }
    summary.critical_tags.push_back(critical);
  }
  std::ranges::stable_sort(summary.critical_tags, std::greater<>{}, &CriticalTag::length);
}

void find_first_readings(const DrivePlan& plan, PlanSummary& summary) {
  std::vector<double> distances;
  for (std::size_t tag = 0; tag < plan.tags.size(); ++tag) {
    const TagUse& use = plan.tags[tag];
    if (!use.is_read) {
      summary.unread_tags.push_back(tag);
    } else if (use.first.chainage > plan.columns.front().chainage) {
      distances.push_back(use.first.distance);  // else it may have been read before the start
    }
  }
  if (distances.empty()) return;
  std::ranges::sort(distances);
  summary.first_reading =
      ReadingDistances{distances.front(), quantile_of_sorted(distances, 0.5), distances.back()};
}

std::optional<PaperSummary> summarize_paper(const DrivePlan& plan) {
  PaperSummary paper;
  std::vector<double> magnifications;
  for (const PlanColumn& column : plan.columns) {
    if (column.paper.magnification == 0) continue;
    magnifications.push_back(column.paper.magnification);
    paper.no_solution_share += column.paper.no_solution_share;
  }
  if (magnifications.empty()) return std::nullopt;
  std::ranges::sort(magnifications);
  const auto count = static_cast<double>(magnifications.size());
  paper.magnification = quantile_of_sorted(magnifications, 0.5);
  paper.no_solution_share /= count;
  paper.share = count / static_cast<double>(plan.columns.size());
  paper.plane = range_of(plan, [](const auto& column) { return column.paper.sigma.plane; });
  paper.height = range_of(plan, [](const auto& column) { return column.paper.sigma.height; });
  return paper;
}

}  // namespace

bool is_covered(const DrivePlan& plan, const PlanColumn& column) {
  return column.read.any() == plan.poses_per_column;
}

PlanSummary summarize(const DrivePlan& plan) {
  PlanSummary summary;
  summary.seen = share_of(plan, &PlanColumn::seen);
  summary.read_plain = share_of(plan, &PlanColumn::read_plain);
  summary.read = share_of(plan, &PlanColumn::read);
  summary.covered_share =
      share_of_columns(plan, [&](const PlanColumn& column) { return is_covered(plan, column); });
  summary.wall_pair_share = share_of_columns(
      plan, [&](const PlanColumn& column) { return column.read.both == plan.poses_per_column; });
  summary.confirmed_share = share_of_columns(
      plan, [&](const PlanColumn& column) { return column.confirmed == plan.poses_per_column; });
  summary.gaps = stretches(plan, gap_columns(plan));
  const auto longest = std::ranges::max_element(summary.gaps, {}, &Stretch::length);
  if (longest != summary.gaps.end()) summary.longest_gap = *longest;

  const auto sigma = [&](ColumnSigma PlanColumn::*of, double ColumnSigma::*part) {
    return range_of(plan, [=](const PlanColumn& column) { return column.*of.*part; });
  };
  summary.nominal_plane = sigma(&PlanColumn::nominal, &ColumnSigma::plane);
  summary.nominal_height = sigma(&PlanColumn::nominal, &ColumnSigma::height);
  summary.nominal_heading = sigma(&PlanColumn::nominal, &ColumnSigma::heading);
  summary.worst_plane = sigma(&PlanColumn::worst, &ColumnSigma::plane);
  summary.one_lost_plane =
      range_of(plan, [](const auto& column) { return column.nominal_one_lost; });
  find_worst_stretch(plan, summary);

  for (const PlanColumn& column : plan.columns) {
    summary.travel_all = std::min(summary.travel_all, column.travel);
    summary.speed_all = std::min(summary.speed_all, column.speed);
  }
  // The histograms round down.
  summary.travel_most = std::max(summary.travel_all, plan.travels.quantile(kMayBeLost));
  summary.speed_most = std::max(summary.speed_all, plan.speeds.quantile(kMayBeLost));
  find_first_readings(plan, summary);
  find_critical_tags(plan, summary);
  summary.paper = summarize_paper(plan);
  return summary;
}

}  // namespace tagsmith::detail
