// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/calibrate_page.hpp"

#include <cmath>

#include <fmt/format.h>

#include "decoder/cli/calibrate_drawing.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/web_page.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/svg.hpp"

namespace tagsmith::detail {
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

// As an image of its own: the names inside of several SVGs cannot meet.
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
    const bool is_pixels = !number.unit.empty();
    rows += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", number.name,
        is_pixels ? fmt::format("{:.3f} px", number.value) : fmt::format("{:.6f}", number.value),
        is_pixels ? fmt::format("{:.3f} px", number.sigma) : fmt::format("{:.6f}", number.sigma));
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

std::string table(const char* head, const std::string& rows) {
  return "<div class=\"scroll\"><table><thead><tr>" + std::string(head) + "</tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
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
  page += "<h2>Camera</h2>\n" +
          table("<th></th><th>value</th><th>standard deviation</th>", number_rows(calibration));
  page += "<h2>Photos</h2>\n" +
          table(
              "<th>photo</th><th>board</th><th>tags used</th><th>tilt, degrees</th>"
              "<th>distance, m</th><th>residuals, sigmas</th>",
              photo_rows(result));
  page += "<h2>Lens forms that were tried</h2>\n" +
          table("<th>form</th><th>parameters</th><th>chi-square</th><th>BIC</th><th>weight</th>",
                form_rows(calibration));
  return page + "</body>\n</html>\n";
}

}  // namespace tagsmith::detail
