// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <fmt/format.h>

#include "decoder/cli/verify_merge.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light; --ink: #1b1f24; --grey: #5b6570; --line: #d6dbe0; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 16px; max-width: 1100px; color: var(--ink); background: #fff;
  font: 16px/1.45 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.35rem; margin: 0 0 4px; }
h2 { font-size: 1.05rem; margin: 28px 0 8px; }
p { margin: 0 0 8px; }
.map { overflow-x: auto; border: 1px solid var(--line); }
.map svg { display: block; width: 100%; min-width: 640px; height: auto; }
label { display: block; margin: 12px 0; }
input { font: inherit; padding: 8px; width: 100%; max-width: 420px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; min-width: 600px; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 6px 8px 6px 0; border-top: 1px solid var(--line);
  font-size: .9rem; vertical-align: top; overflow-wrap: break-word; }
th { white-space: nowrap; }
.ok { color: #0d8033; } .poor { color: #a85a00; } .faulty { color: #b01818; }
.unseen { color: var(--grey); }
@media print { label { display: none; } table { min-width: 0; } .map svg { min-width: 0; } tr { break-inside: avoid; } }
)css";

constexpr const char* kScript = R"js(
'use strict';
const field = document.getElementById('filter');
function filter() {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  let shown = 0;
  for (const row of document.querySelectorAll('tbody tr')) {
    const text = row.textContent.toLowerCase();
    row.hidden = !words.every(word => text.includes(word));
    shown += row.hidden ? 0 : 1;
  }
  document.getElementById('shown').textContent = shown + ' rows';
}
field.addEventListener('input', filter);
filter();
)js";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

TagRecord record_of(const VerifyMerge& merged, const PlacedTag& tag) {
  const auto found = merged.tags.find(tag.name);
  return found == merged.tags.end() ? TagRecord{} : found->second;
}

Colour colour_of(const std::string& status) {
  if (status == "ok") return colours::kGreen;
  if (status == "poor") return colours::kOrange;
  return status == "faulty" ? colours::kRed : colours::kGrey;
}

// The tunnel from above with a disc on every tag; one sheet or more.
Result<std::string> map_of(const Survey& survey, const VerifyMerge& merged) {
  constexpr double kRadius = 0.0022;
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey)) {
    DrawingView view = plan_view(survey, strip);
    SketchLayer& layer = view.sketch.layer("status");
    for (const PlacedTag& tag : survey.tags) {
      if (tag.chainage < strip.from || tag.chainage > strip.to) continue;
      const Eigen::Vector2d at =
          strip.view_from_world * Eigen::Vector2d(tag.world_from_plate.translation.head<2>());
      layer.add(Dot{at, kRadius, colour_of(status_of(record_of(merged, tag)))});
    }
    views.push_back(std::move(view));
  }
  const Result<std::vector<Sheet>> sheets = lay_out_sheets(
      {"Verification", survey.name, {}}, views, {Paper::a3, coarsest_plan_scale(survey)});
  if (!sheets) return fail(sheets.error().message);
  std::string svg;
  for (const Sheet& sheet : *sheets) {
    const std::string file = render_sheet_svg(sheet);
    svg += "<div class=\"map\">" + file.substr(file.find("<svg")) + "</div>\n";
  }
  return svg;
}

std::string grade_text(const std::optional<double>& grade) {
  return grade ? fmt::format("{:.1f}", *grade) : "-";
}

std::string tag_rows(const Survey& survey, const VerifyMerge& merged) {
  std::string rows;
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag);
    const std::string status = status_of(record);
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"{}\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{}</td></tr>\n",
        escaped(tag.name), status, status, record.seen, record.faults, grade_text(record.best),
        grade_text(record.worst), escaped(record.blame));
  }
  return rows;
}

std::string fault_rows(const VerifyMerge& merged) {
  std::string rows;
  for (const FaultRecord& fault : merged.faults) {
    const VerifyRule* rule = find_verify_rule(fault.rule);
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        escaped(fault.file), escaped(fault.tag), escaped(fault.rule),
                        escaped(fault.message),
                        rule == nullptr ? "" : escaped(std::string(rule->remedy)));
  }
  return rows;
}

std::string summary_of(const Survey& survey, const VerifyMerge& merged) {
  std::map<std::string, int> counts;
  for (const PlacedTag& tag : survey.tags) ++counts[status_of(record_of(merged, tag))];
  return fmt::format(
      "<p>{} files. Of {} tags <b class=\"ok\">{} are ok</b>, <b class=\"poor\">{} print "
      "poorly</b> (worst grade below 1.5), <b class=\"faulty\">{} are faulty</b>, <b "
      "class=\"unseen\">{} were not seen</b>. {} faults in all{}.</p>\n",
      merged.files, survey.tags.size(), counts["ok"], counts["poor"], counts["faulty"],
      counts["unseen"], merged.fault_count,
      merged.fault_count > merged.faults.size()
          ? fmt::format(", of which the first {} are listed", merged.faults.size())
          : "");
}

}  // namespace

Result<std::string> report_page(const Survey& survey, const VerifyMerge& merged) {
  const Result<std::string> map = map_of(survey, merged);
  if (!map) return fail(map.error().message);
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<title>Verification of " +
         escaped(survey.name) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<h1>" +
         "Verification of " + escaped(survey.name) + "</h1>\n" + summary_of(survey, merged) +
         "<h2>Tunnel from above</h2>\n" + *map +
         "<label>Show rows with these words <input id=\"filter\" type=\"search\" "
         "placeholder=\"unseen, 003L, glare\"></label>\n<p id=\"shown\" role=\"status\"></p>\n"
         "<h2>Faults</h2>\n<div class=\"scroll\"><table><thead><tr><th>file</th><th>tag</th>"
         "<th>rule</th><th>what is wrong</th><th>what to do</th></tr></thead><tbody>\n" +
         fault_rows(merged) +
         "</tbody></table></div>\n<h2>Tags</h2>\n<div class=\"scroll\"><table><thead><tr>"
         "<th>tag</th><th>status</th><th>seen</th><th>faults</th><th>best grade</th>"
         "<th>worst</th><th>blame</th></tr></thead><tbody>\n" +
         tag_rows(survey, merged) + "</tbody></table></div>\n<script>" + kScript +
         "</script>\n</body>\n</html>\n";
}

}  // namespace tagsmith
