// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/region_scan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "decoder/reader/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

SymbolPlace place_of(const ElasticAlignment& alignment) {
  const double begin = alignment.boundaries.front();
  return {begin, (alignment.boundaries.back() - begin) / kModuleCount, 0};
}

namespace {

// Used for the first line; the others are made only after one was found.
const BarLook& plain_look() {
  static const BarLook look{BarShape{}, BarTemplates(BarShape{})};
  return look;
}

const std::vector<BarLook>& other_looks() {
  static const auto all = [] {
    std::vector<BarLook> list;
    for (const double blur : {0.5, 0.3, 0.75, 1.05}) {
      for (const double growth : {0.0, -0.3, 0.3}) {
        const BarShape bars{blur, growth};
        if (bars != BarShape{}) list.push_back({bars, BarTemplates(bars)});
      }
    }
    return list;
  }();
  return all;
}

// A place on one of the lines that are looked at first.
struct FirstPlace {
  std::size_t line = 0;
  SymbolPlace place;
};

std::optional<ElasticReading> read_line(const PlacedLine& line, const BarTemplates& templates,
                                        Wanted wanted, double worst = kAnyCost) {
  if (wanted == Wanted::digits) return read_elastic(line, templates, worst);
  const auto alignment = align_elastic(line, templates, worst);
  if (!alignment) return std::nullopt;
  ElasticReading reading;
  reading.alignment = *alignment;
  return reading;
}

// The look of the bars that suits the line best, and its reading with that look.
const BarLook& best_look(ReadLine& line, Wanted wanted) {
  const SymbolPlace place = place_of(line.reading.alignment);
  const BarLook* best = &plain_look();
  const auto placed = placed_line(line.light, place);
  if (!placed) return *best;
  double least = line.reading.alignment.cost_per_module;
  for (const BarLook& look : other_looks()) {
    const double cost = elastic_cost(*placed, look.templates, least);
    if (cost >= least) continue;
    least = cost;
    best = &look;
  }
  if (const auto reading = read_line(*placed, best->templates, wanted)) line.reading = *reading;
  return *best;
}

// Leaves out the lines that read much worse than most: they lie beyond the bars or in dirt.
void drop_strays(std::vector<ReadLine>& lines) {
  std::vector<double> costs;
  for (const ReadLine& line : lines) costs.push_back(line.reading.alignment.cost_per_module);
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::ranges::nth_element(costs, middle);
  const double most = std::max(kBarLines.good, kBarLines.stray * *middle);
  std::erase_if(
      lines, [&](const ReadLine& line) { return line.reading.alignment.cost_per_module > most; });
}

bool is_inside(const SampledLight& image, PixelPoint at) {
  return at.x >= 0 && at.y >= 0 && at.x <= image.width() - 1 && at.y <= image.height() - 1;
}

// first_line() along the lines of one frame.
std::optional<ReadLine> first_line_in(SampledLight& image, const LineFrame& frame,
                                      const BarRegion& region, Wanted wanted) {
  const double nominal_module = region.length / kModuleCount / frame.step;
  std::vector<ReadLine> lines;
  std::vector<FirstPlace> places;
  for (const double share : {0.0, -0.25, 0.25}) {
    const double offset = share * region.height;
    lines.push_back({offset, light_along(image, frame, offset, region.height / 8), {}});
    for (const SymbolPlace& place :
         find_symbol_places(lines.back().light, nominal_module / kBarLines.most_wider,
                            kBarLines.most_wider * nominal_module, kBarLines.most_places)) {
      places.push_back({lines.size() - 1, place});
    }
  }
  std::ranges::stable_sort(places, {}, [](const FirstPlace& p) { return p.place.cost; });
  if (places.size() > kBarLines.most_places) places.resize(kBarLines.most_places);
  double best = kBarLines.worst_cost;
  std::optional<FirstPlace> found;
  for (const auto& [line, place] : places) {
    const double end = place.begin + kModuleCount * place.module;
    for (const SymbolPlace& way : {place, SymbolPlace{end, -place.module, place.cost}}) {
      const auto placed = placed_line(lines[line].light, way);
      if (!placed) continue;
      const double cost = elastic_cost(*placed, plain_look().templates, best);
      if (cost >= best) continue;
      best = cost;
      found = FirstPlace{line, way};
    }
    if (best < kBarLines.good) break;
  }
  if (!found) return std::nullopt;
  ReadLine first = std::move(lines[found->line]);
  const auto placed = placed_line(first.light, found->place);
  if (!placed) return std::nullopt;
  const auto reading = read_line(*placed, plain_look().templates, wanted);
  if (!reading) return std::nullopt;
  first.reading = *reading;
  return first;
}

}  // namespace

std::optional<FirstLine> first_line(SampledLight& image, const BarRegion& region, Wanted wanted) {
  const LineFrame even = line_frame_for(image, region);
  auto line = first_line_in(image, even, region, wanted);
  if (!line) return std::nullopt;
  FirstLine first{even, *std::move(line)};
  const auto cost_of = [](const ReadLine& of) { return of.reading.alignment.cost_per_module; };
  // The middle of the symbol then moves by as many modules as boundaries may be off.
  constexpr double kNearerEnd = 8.0 * kPlacedSlack / kModuleCount;
  for (const double nearer : {-kNearerEnd, kNearerEnd}) {
    if (cost_of(first.line) < kBarLines.good) break;
    LineFrame slanted = even;
    slanted.foreshortening = nearer / region.length;
    auto other = first_line_in(image, slanted, region, wanted);
    if (other && cost_of(*other) < cost_of(first.line)) first = {slanted, *std::move(other)};
  }
  return first;
}

RegionScan scan_region(SampledLight& image, const BarRegion& region, FirstLine found,
                       Wanted wanted) {
  const LineFrame& frame = found.frame;
  ReadLine& first = found.line;
  const BarLook& look = best_look(first, wanted);
  RegionScan scan{frame, std::max(1.0, region.height / kBarLines.lines), &look, {}};
  for (const double direction : {-1.0, 1.0}) {
    SymbolPlace place = place_of(first.reading.alignment);
    for (double offset = first.offset + direction * scan.spacing;
         std::abs(offset) < 0.6 * region.height; offset += direction * scan.spacing) {
      if (!is_inside(image, frame.pixel(place.begin + kModuleCount / 2.0 * place.module, offset))) {
        break;
      }
      ScanLine light = light_along(image, frame, offset, scan.spacing);
      const auto placed = placed_line(light, place);
      const auto reading =
          placed ? read_line(*placed, look.templates, wanted, kBarLines.worst_cost) : std::nullopt;
      if (!reading || reading->alignment.cost_per_module > kBarLines.worst_cost) continue;
      place = place_of(reading->alignment);
      scan.lines.push_back({offset, std::move(light), *reading});
    }
  }
  scan.lines.push_back(std::move(first));
  drop_strays(scan.lines);
  std::ranges::sort(scan.lines, {}, &ReadLine::offset);
  return scan;
}

}  // namespace tagsmith::detail
