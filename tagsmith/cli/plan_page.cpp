// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/plan_report.hpp"
#include "tagsmith/cli/web_page.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/render/plan_drawing.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kMostDrawnPoints = 1500;  // of the profile and of the map's lines

constexpr const char* kStyle = R"css(
.key { color: var(--grey); font-size: .9rem; }
.key span { display: inline-block; margin-right: 14px; white-space: nowrap; }
.key i { display: inline-block; width: 18px; height: 5px; margin-right: 5px; vertical-align: middle; }
svg { display: block; width: 100%; touch-action: pan-y; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: var(--grey); }
#read { min-height: 3em; font-size: .9rem; font-variant-numeric: tabular-nums; }
dl { margin: 0; }
dl div { padding: 8px 0; border-top: 1px solid var(--line); }
dt { color: var(--grey); }
dd { margin: 0; overflow-wrap: anywhere; }
th, td { text-align: right; padding: 5px 4px; }
th:first-child, td:first-child { text-align: left; }
@media (min-width: 700px) { dl div { display: grid; grid-template-columns: 200px 1fr; } }
)css";

constexpr const char* kScript = R"js(
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const colours = data.colours;
const NS = 'http://www.w3.org/2000/svg';
function el(parent, name, attributes, text) {
  const node = document.createElementNS(NS, name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  parent.appendChild(node);
  return node;
}
function length(v) {
  if (v === null) return 'none';
  return v < 0.1 ? (1000 * v).toPrecision(3) + ' mm' : v.toFixed(2) + ' m';
}
function drawMap() {
  const svg = document.getElementById('map');
  svg.replaceChildren();
  const width = svg.clientWidth, points = data.walls.flat().concat(data.tags.map(t => [t.x, t.y]));
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const [x, y] of points) {
    x0 = Math.min(x0, x); x1 = Math.max(x1, x); y0 = Math.min(y0, y); y1 = Math.max(y1, y);
  }
  const pad = 14, most = Math.max(240, 0.7 * window.innerHeight);
  const scale = Math.min((width - 2 * pad) / Math.max(x1 - x0, 1e-9),
                         (most - 2 * pad) / Math.max(y1 - y0, 1e-9));
  const height = (y1 - y0) * scale + 2 * pad + 22;
  const left = (width - (x1 - x0) * scale) / 2;
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.style.height = height + 'px';
  const at = ([x, y]) => [left + (x - x0) * scale, pad + (y1 - y) * scale];
  const path = line => line.map(p => at(p).map(v => v.toFixed(1)).join(',')).join(' ');
  for (const wall of data.walls) {
    el(svg, 'polyline', {points: path(wall), fill: 'none', stroke: '#30363c', 'stroke-width': 1.5});
  }
  for (const run of data.coverage) {
    el(svg, 'polyline', {points: path(run.line), fill: 'none', stroke: colours[run.service],
      'stroke-width': 5, 'stroke-linecap': 'butt'});
  }
  for (const field of data.fields) {
    el(svg, 'polygon', {points: path(field), fill: '#1f5fb0', 'fill-opacity': 0.10,
      stroke: '#1f5fb0', 'stroke-width': 1, 'stroke-dasharray': '4 3'});
  }
  for (const tag of data.tags) {
    const [u, v] = at([tag.x, tag.y]);
    const dot = el(svg, 'circle', {cx: u, cy: v, r: 3, fill: tag.read ? '#1b1f24' : '#cc1a1a'});
    el(dot, 'title', {}, tag.name);
  }
  const round = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].filter(v => v * scale <= width / 3);
  const bar = round.length ? round[round.length - 1] : 0.5;
  el(svg, 'path', {d: `M${pad},${height - 16}v5h${bar * scale}v-5`, fill: 'none', stroke: '#5b6570'});
  el(svg, 'text', {x: pad + bar * scale + 6, y: height - 9}, bar + ' m');
}
function drawProfile() {
  const svg = document.getElementById('profile');
  svg.replaceChildren();
  const width = svg.clientWidth, height = Math.max(240, Math.min(360, width * 0.6));
  const l = 58, r = 8, t = 8, b = 40, c = data.profile.chainage;
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.style.height = height + 'px';
  let low = Infinity, high = -Infinity;
  for (const name of ['nominal', 'worst', 'paper']) for (const v of data.profile[name]) {
    if (v !== null) { low = Math.min(low, v); high = Math.max(high, v); }
  }
  if (!(low > 0)) { low = 1e-3; high = 1; }
  const d0 = Math.floor(Math.log10(low)), d1 = Math.min(d0 + 5, Math.max(d0 + 1, Math.ceil(Math.log10(high))));
  const first = c[0], span = Math.max(c[c.length - 1] - first, 1e-9);
  const x = v => l + (v - first) / span * (width - l - r);
  const y = v => t + (d1 - Math.min(d1, Math.max(d0, Math.log10(v)))) / (d1 - d0) * (height - t - b);
  for (let d = d0; d <= d1; ++d) {
    el(svg, 'line', {x1: l, x2: width - r, y1: y(10 ** d), y2: y(10 ** d), stroke: '#d6dbe0'});
    el(svg, 'text', {x: l - 6, y: y(10 ** d) + 4, 'text-anchor': 'end'},
      d < 0 ? +(1000 * 10 ** d).toPrecision(1) + ' mm' : 10 ** d + ' m');
  }
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000];
  const step = steps.find(s => (width - l - r) / (span / s) >= 48) || 50000;
  for (let v = Math.ceil(first / step) * step; v <= first + span + 1e-9; v += step) {
    const anchor = x(v) > width - r - 24 ? 'end' : 'middle';
    el(svg, 'text', {x: x(v), y: height - b + 28, 'text-anchor': anchor}, +v.toFixed(2) + ' m');
  }
  for (let i = 0; i + 1 < c.length; ++i) {
    el(svg, 'rect', {x: x(c[i]), y: height - b + 4, width: Math.max(0.6, x(c[i + 1]) - x(c[i]) + 0.4),
      height: 7, fill: colours[data.profile.service[i]]});
  }
  // Steps: what a place has holds up to the next.
  const curve = (name, attributes) => {
    let d = '', open = false;
    data.profile[name].forEach((v, i) => {
      if (v === null) { open = false; return; }
      d += open ? 'V' + y(v).toFixed(1) : 'M' + x(c[i]).toFixed(1) + ',' + y(v).toFixed(1);
      if (i + 1 < c.length) d += 'H' + x(c[i + 1]).toFixed(1);
      open = true;
    });
    if (d) el(svg, 'path', Object.assign({d, fill: 'none'}, attributes));
  };
  curve('paper', {stroke: '#808890', 'stroke-width': 1.5, 'stroke-dasharray': '5 4'});
  curve('worst', {stroke: '#d97300', 'stroke-width': 1.5});
  curve('nominal', {stroke: '#0d4db3', 'stroke-width': 2.5});
  const mark = el(svg, 'line', {y1: t, y2: height - b, stroke: '#1b1f24', visibility: 'hidden'});
  const show = event => {
    const box = svg.getBoundingClientRect();
    const wanted = first + (event.clientX - box.left - l) / (width - l - r) * span;
    let i = 0;
    while (i + 1 < c.length && c[i + 1] <= wanted) ++i;
    mark.setAttribute('x1', x(c[i])); mark.setAttribute('x2', x(c[i]));
    mark.setAttribute('visibility', 'visible');
    document.getElementById('read').textContent = `${c[i].toFixed(2)} m: ` +
      `center line ${length(data.profile.nominal[i])}, worst pose ${length(data.profile.worst[i])}, ` +
      `paper's method ${length(data.profile.paper[i])}, at least ${data.profile.tags[i]} tags`;
  };
  svg.onpointermove = show;
  svg.onpointerdown = show;
}
function draw() { drawMap(); drawProfile(); }
draw();
window.addEventListener('resize', draw);
)js";

Json value(double number) { return finite_or_null(with_decimals(number, 6)); }

Json point(const Eigen::Vector3d& in_world, const Survey& survey) {
  const Eigen::Vector3d in_grid = grid_from_world(survey.grid, in_world);
  // As it is seen from above: a grid with x to the left is not mirrored.
  const double x = survey.grid.x_axis_left ? -in_grid.x() : in_grid.x();
  return Json::array({with_decimals(x, 3), with_decimals(in_grid.y(), 3)});
}

Json line_beside(const Survey& survey, const ChainageProfile& offset, double from, double to) {
  Json line = Json::array();
  const auto count = static_cast<std::size_t>(std::clamp((to - from) / 0.25, 1.0, 1500.0));
  for (std::size_t i = 0; i <= count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    const double chainage = from + share * (to - from);
    line.push_back(
        point(point_beside(survey.tunnel.centerline, chainage, offset.at(chainage)), survey));
  }
  return line;
}

Json colours() {
  Json all;
  for (const auto& [key, words, colour] : kServiceStyles) {
    const auto byte = [](double share) { return static_cast<int>(std::lround(255 * share)); };
    all[key] =
        fmt::format("#{:02x}{:02x}{:02x}", byte(colour.red), byte(colour.green), byte(colour.blue));
  }
  return all;
}

// Of several columns drawn as one point, the worst.
Json chart_json(const DrivePlan& plan) {
  const std::size_t stride = std::max<std::size_t>(1, plan.columns.size() / kMostDrawnPoints);
  Json json;
  for (const char* name : {"chainage", "nominal", "worst", "paper", "tags", "service"}) {
    json[name] = Json::array();
  }
  for (std::size_t i = 0; i < plan.columns.size(); i += stride) {
    const PlanColumn* worst = &plan.columns[i];
    for (std::size_t j = i; j < std::min(i + stride, plan.columns.size()); ++j) {
      const PlanColumn& column = plan.columns[j];
      if (service_of(plan, column) > service_of(plan, *worst) ||
          (service_of(plan, column) == service_of(plan, *worst) &&
           column.worst.plane > worst->worst.plane)) {
        worst = &column;
      }
    }
    json["chainage"].push_back(value(plan.columns[i].chainage));
    json["nominal"].push_back(value(worst->nominal.plane));
    json["worst"].push_back(value(worst->worst.plane));
    json["paper"].push_back(value(worst->paper.sigma.plane));
    json["tags"].push_back(worst->least_tags);
    json["service"].push_back(style_of(service_of(plan, *worst)).key);
  }
  return json;
}

Json coverage(const Survey& survey, const DrivePlan& plan) {
  return json_list(service_runs(plan), [&](const ServiceRun& run) -> Json {
    const double from = plan.columns[run.first].chainage;
    const double to = plan.columns[run.last].chainage;
    return {{"service", style_of(run.service).key}, {"line", line_beside(survey, 0, from, to)}};
  });
}

Json fields(const PlannedDrive& drive) {
  const double from = drive.plan.columns.front().chainage;
  const double to = drive.plan.columns.back().chainage;
  const auto on_page = [&](const Eigen::Vector3d& corner) { return point(corner, drive.survey); };
  return json_list(fields_of_view(drive.survey, drive.rig, drive.plan, from, to),
                   [&](const auto& outline) { return json_list(outline, on_page); });
}

Json page_data(const PlannedDrive& drive) {
  // The walls as far as the plan goes and tags hang.
  double from = drive.plan.columns.front().chainage;
  double to = drive.plan.columns.back().chainage;
  for (const PlacedTag& tag : drive.survey.tags) {
    from = std::min(from, tag.chainage);
    to = std::max(to, tag.chainage);
  }
  Json data;
  data["colours"] = colours();
  data["walls"] = Json::array({line_beside(drive.survey, drive.survey.tunnel.left, from, to),
                               line_beside(drive.survey, drive.survey.tunnel.right, from, to)});
  data["coverage"] = coverage(drive.survey, drive.plan);
  data["fields"] = fields(drive);
  data["tags"] = Json::array();
  for (std::size_t i = 0; i < drive.survey.tags.size(); ++i) {
    const PlacedTag& tag = drive.survey.tags[i];
    const Json place = point(tag.world_from_plate.translation, drive.survey);
    data["tags"].push_back({{"name", tag.name},
                            {"x", place[0]},
                            {"y", place[1]},
                            {"read", drive.plan.tags[i].is_read}});
  }
  data["profile"] = chart_json(drive.plan);
  return data;
}

std::string share_row(const std::string& name, const WallShare& share) {
  return fmt::format(
      "<tr><td>{}</td><td>{:.1f} %</td><td>{:.1f} %</td><td>{:.1f} %</td><td>{:.1f} %</td></tr>\n",
      name, 100 * (share.both + share.one), 100 * share.both, 100 * share.one, 100 * share.none);
}

std::string answers(const PlannedDrive& drive) {
  std::string list = "<dl>\n";
  for (const PlanAnswer& answer : plan_answers(drive)) {
    list += "<div><dt>" + markup_text(answer.question) + "</dt><dd>" + markup_text(answer.answer) +
            "</dd></div>\n";
  }
  return list + "</dl>\n";
}

void add_cells(const TagView& view, std::string& row) {
  row += fmt::format("<td>{:.2f} m</td><td>{:.2f} m</td><td>{:.2f}</td><td>{:.0f}&deg;</td>",
                     view.chainage, view.distance, view.module_px, degrees(view.incidence));
}

std::string tag_table_html(const PlannedDrive& drive) {
  std::string table =
      "<table><tr><th></th><th colspan=\"4\">first read</th><th colspan=\"4\">last read</th></tr>\n"
      "<tr><th>tag</th><th>at</th><th>distance</th><th>px/module</th><th>angle</th><th>at</th>"
      "<th>distance</th><th>px/module</th><th>angle</th></tr>\n";
  for (std::size_t i = 0; i < drive.plan.tags.size(); ++i) {
    const TagUse& use = drive.plan.tags[i];
    table += "<tr><td>" + markup_text(drive.survey.tags[i].name) + "</td>";
    if (use.is_read) {
      add_cells(use.first, table);
      add_cells(use.last, table);
    } else {
      table += "<td colspan=\"8\">never read</td>";
    }
    table += "</tr>\n";
  }
  return table + "</table>\n";
}

std::string key(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string text = "<p class=\"key\">";
  for (const auto& [colour, words] : entries) {
    text += fmt::format("<span><i style=\"background:{}\"></i>{}</span>", colour, words);
  }
  return text + "</p>\n";
}

// JSON inside a script element: no `<` may end it.
std::string embedded(const Json& data) {
  std::string text = json_text(data);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

}  // namespace

std::string plan_page(const PlannedDrive& drive) {
  const Json data = page_data(drive);
  const auto colour = [&](const char* name) { return data["colours"][name].get<std::string>(); };
  const std::string name = markup_text(drive.survey.name);
  std::string page = page_head("Plan of " + name, kStyle, true) + "<h1>Plan of the drive " + name +
                     "</h1>\n<p class=\"sub\">" + markup_text(plan_heading(drive)) + "</p>\n";
  for (const std::string& assumed : plan_assumptions(drive)) {
    page += "<p class=\"sub\">" + markup_text(assumed) + "</p>\n";
  }
  page +=
      "<h2>Standard deviation in the plane along the chainage</h2>\n" +
      key({{"#0d4db3", "on the center line"},
           {"#d97300", "worst pose"},
           {"#808890", "the paper's method"}}) +
      "<svg id=\"profile\" role=\"img\" aria-label=\"Profile of the standard deviation\"></svg>\n"
      "<p id=\"read\" class=\"sub\">Touch the chart to read a place.</p>\n";
  page += "<h2>Tunnel from above</h2>\n" +
          key({{colour("both"), "both walls, every pose"},
               {colour("confirmed"), "two tags, one at least whole, every pose"},
               {colour("one"), "a tag, every pose"},
               {colour("some"), "some poses have none"},
               {colour("none"), "no tag"},
               {"#1f5fb0", "fields of view"}}) +
          "<svg id=\"map\" role=\"img\" aria-label=\"Map of the tunnel\"></svg>\n";
  page += "<h2>Answers</h2>\n" + answers(drive);
  page +=
      "<h2>Share of the poses</h2>\n<table><tr><th></th><th>any tag</th><th>both walls</th>"
      "<th>one wall</th><th>none</th></tr>\n" +
      share_row("tag seen whole", drive.summary.seen) +
      share_row("read without survey", drive.summary.read_plain) +
      share_row("read with the survey", drive.summary.read) + "</table>\n";
  page += "<h2>Tags as they are read from the center line</h2>\n<div class=\"scroll\">" +
          tag_table_html(drive) + "</div>\n";
  page += "<script type=\"application/json\" id=\"data\">" + embedded(data) +
          "</script>\n<script>" + kScript + "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace tagsmith::detail
