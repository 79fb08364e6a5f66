// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/printer_test.hpp"

#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace {

// Of bars, metres: from what office printers can hold to three times a usual module's share.
constexpr std::array kWidths{0.00025, 0.00035, 0.0005, 0.0007, 0.001, 0.0014, 0.002, 0.003};

TagTemplate mark_template() {
  TagTemplate mark;
  mark.name = "printer test";
  mark.plate_length = 0.066;
  mark.plate_height = 0.033;
  mark.frame_inner_length = 0.057;
  mark.frame_inner_height = 0.024;
  mark.frame_stroke = 0.003;
  mark.label.shown = false;
  return mark;
}

Digits mark_code(std::uint8_t number) {
  Digits digits{7, 7, 0, 3, 1, 9, 5, 8, 2, 6, number, 0};
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

}  // namespace

double bar_adjustment_for(const PrinterProfile& profile, bool white_on_black) {
  const double growth = (profile.growth_right + profile.growth_down) / 2;
  return white_on_black ? growth : -growth;
}

PrinterTest printer_test() {
  PrinterTest test;
  test.width = 0.180;
  test.height = 0.250;
  const TagTemplate mark = mark_template();
  const double stroke = mark.frame_stroke;
  const double right = test.width - mark.frame_inner_length - stroke;
  const double down = test.height - mark.frame_inner_height - stroke;
  std::uint8_t number = 0;
  for (const PlatePoint& p : {PlatePoint{stroke, stroke}, PlatePoint{right, stroke},
                              PlatePoint{stroke, down}, PlatePoint{right, down}}) {
    test.codes.push_back(mark_code(++number));
    test.marks.push_back(moved(draw_tag(mark, test.codes.back()), p.x, p.y));
  }
  for (std::size_t i = 0; i < kWidths.size(); ++i) {
    const double place = static_cast<double>(i);
    const double width = kWidths[i];
    test.upright.push_back({(25 + 12 * place) * kMillimetre - width / 2, 0.045, width, 0.040});
    test.lying.push_back({0.130, (45 + 11 * place) * kMillimetre - width / 2, 0.040, width});
  }
  for (int i = 0; i <= 10; ++i) {
    test.tones.push_back({{(18 + 13 * i) * kMillimetre, 0.140, 0.012, 0.012}, i / 10.0});
  }
  test.scales = {Rectangle{0.015, 0.175, 0.150, 0}, Rectangle{0.008, 0.045, 0, 0.150}};
  return test;
}

}  // namespace tagsmith::detail
