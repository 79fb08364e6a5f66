// SPDX-License-Identifier: Apache-2.0
// Files of surveyed points of all formats, and the tunnels fitted to them. The first line says the
// order of the columns; it is empty for formats that have none.
#include "tagsmith/draft/fit_tunnel.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

namespace {

constexpr std::size_t kMostFitted = 40;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TagTemplate tag = *read_template("templates/tag-400x300.yaml").value().value;
  const std::string_view text = fuzz::as_text(data, size);
  const std::size_t line_end = std::min(text.find('\n'), text.size());
  PointListOptions options;
  options.order = std::string(text.substr(0, line_end));
  options.header = options.order.ends_with('H');
  const fuzz::FileInMemory file(text.substr(std::min(line_end + 1, text.size())));
  const auto reading = read_point_list(file.path(), options);
  if (!reading || !reading->value || reading->value->points.size() > kMostFitted) return 0;
  TunnelFitOptions fit;
  fit.mount_height = 1.5;
  fit.roof_height = 3;
  (void)fit_tunnel(reading->value->points, Grid{}, tag, fit);
  return 0;
}
