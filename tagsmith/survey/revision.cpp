// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/revision.hpp"

#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {
namespace {

// The survey as one text with everything in a fixed order. Texts are written with their length, so
// that no two surveys share a text. A change of this text changes all revisions.
class Content {
 public:
  void text(const std::string& value) { bytes_ += fmt::format("{}:{};", value.size(), value); }
  void length(double metres) { number(metres * 1e6); }
  void angle(double radians) { number(radians * 1e9); }
  void number(double value) { bytes_ += fmt::format("{:.0f};", std::round(value) + 0.0); }
  void point(const Eigen::Vector3d& p) {
    for (const double coordinate : p) length(coordinate);
  }
  std::string revision() const { return sha256(bytes_).substr(0, kShown); }

 private:
  static constexpr std::size_t kShown = 12;

  std::string bytes_;
};

void add_profile(Content& content, const ChainageProfile& profile) {
  content.number(static_cast<double>(profile.stations().size()));
  for (const ProfileStation& station : profile.stations()) {
    content.length(station.chainage);
    content.length(station.value);
  }
}

// Of a plain tunnel only its two numbers, as revisions always had them.
void add_room(Content& content, const Tunnel& tunnel) {
  const bool in_the_middle = tunnel.left.at(0) == -tunnel.right.at(0);
  if (is_plain(tunnel) && in_the_middle && tunnel.stand_off == 0) {
    content.length(width_at(tunnel, 0));
    content.length(tunnel.height.at(0));
    return;
  }
  content.text("room");
  for (const ChainageProfile* profile : {&tunnel.left, &tunnel.right, &tunnel.height}) {
    add_profile(content, *profile);
  }
  content.length(tunnel.stand_off);
}

void add_tunnel(Content& content, const Survey& survey) {
  content.number(survey.grid.x_axis_left ? 1 : 0);
  if (survey.grid.epsg != 0) content.text("EPSG:" + std::to_string(survey.grid.epsg));
  add_room(content, survey.tunnel);
  const Centerline& line = survey.tunnel.centerline;
  const CenterlinePoint start = line.at(0);
  content.point(start.position);
  content.angle(start.heading);
  content.number(static_cast<double>(line.elements().size()));
  for (const CenterlineElement& element : line.elements()) {
    content.length(element.length);
    content.angle(element.curvature);
    content.angle(element.grade);
  }
}

void add_template(Content& content, const TagTemplate& tag) {
  for (const double length :
       {tag.plate_length, tag.plate_height, tag.frame_inner_length, tag.frame_inner_height,
        tag.frame_stroke, tag.frame_offset_right, tag.frame_offset_up, tag.quiet_zone_modules,
        tag.margin_modules, tag.label.shown ? tag.label.text_height : -1.0}) {
    content.length(length);
  }
  content.number(tag.dots_per_inch);
  content.length(tag.patch_size);
  content.number(static_cast<double>(tag.holes.size()));
  for (const DrillHole& hole : tag.holes) {
    for (const double length : {hole.right, hole.up, hole.diameter}) content.length(length);
  }
  content.length(tag.cut.contour ? tag.cut.corner_radius : -1.0);
  content.text(tag.material);
  if (tag.white_on_black) content.text("white on black");
  const LabelStyle usual;
  if (!tag.label.lines.empty() || tag.label.left != usual.left || tag.label.right != usual.right) {
    content.text("label " + tag.label.left + " " + tag.label.right);
  }
  for (const std::string& line : tag.label.lines) content.text(line);
  if (!tag.logo.file.empty()) {
    content.text("logo " + tag.logo.file.filename().string());
    content.length(tag.logo.width);
    content.length(tag.logo.height);
  }
  if (tag.qr.size > 0) {
    content.text("QR " + tag.qr.content);
    content.length(tag.qr.size);
  }
}

void add_code(Content& content, const PositionCode& code) {
  content.text(to_string(code.check));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    content.number(code.digit_counts[axis]);
    content.length(code.resolution[axis]);
    content.length(code.origin[axis]);
  }
}

void add_tag(Content& content, const Survey& survey, const PlacedTag& tag) {
  content.text(tag.name);
  content.text(to_string(tag.digits));
  content.point(tag.p_in_grid);
  content.length(states_sigma_of(survey, tag) ? tag.sigma : 0);
  content.text(tag.date);
  if (tag.design_in_grid) content.point(*tag.design_in_grid);
  if (!tag.attitude) return;
  content.text(tag.attitude->facing ? "faces" : "leans");
  content.angle(tag.attitude->facing.value_or(0));
  content.angle(tag.attitude->tilt);
  content.angle(tag.attitude->roll);
}

}  // namespace

// Why: docs/decisions/0015-files-and-ledger.md.
std::string survey_revision(const Survey& survey) {
  Content content;
  content.text(survey.name);
  add_tunnel(content, survey);
  content.text(survey.tag_template.name);
  add_template(content, survey.tag_template);
  // What is assumed belongs to the program, not to the survey.
  content.length(survey.states_sigma ? survey.sigma : 0);
  if (survey.states_angle_sigma && survey.angle_sigma != 0) content.angle(survey.angle_sigma);
  add_code(content, survey.code);
  for (const PlacedTag& tag : survey.tags) add_tag(content, survey, tag);
  return content.revision();
}

std::string template_revision(const TagTemplate& tag) {
  Content content;
  add_template(content, tag);
  return content.revision();
}

}  // namespace tagsmith::detail
