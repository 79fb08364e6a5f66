// SPDX-License-Identifier: Apache-2.0
// What truth.json says of a folder's photos.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "decoder/feature_frame/frame.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail::bench {

// The frame's corners of a plate of truth.json, P, F, R, Q, pixels.
inline FrameCorners corners_of(const nlohmann::json& plate) {
  FrameCorners corners{};
  std::size_t next = 0;
  for (const char* name : {"P", "F", "R", "Q"}) {
    const nlohmann::json& at = plate.at("corners_px").at(name);
    corners[next++] = {at[0].get<double>(), at[1].get<double>()};
  }
  return corners;
}

// What a folder's truth.json says. Fails on folders without it, and where it lists no images.
inline Result<nlohmann::json> read_truth(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "truth.json";
  std::ifstream stream(file);
  if (!stream) return fail(file.string() + ": cannot be read, expected a folder of photos with it");
  nlohmann::json truth = nlohmann::json::parse(stream, nullptr, false);
  if (truth.is_object() && truth.contains("images")) return truth;
  return fail(file.string() + ": lists no images, expected what bench_raytraced writes");
}

// The codes of all its plates, in order.
inline std::vector<Digits> codes_of(const nlohmann::json& truth) {
  std::set<Digits> codes;
  for (const auto& item : truth.at("images")) {
    for (const auto& plate : item.at("plates")) {
      const auto code = parse_digits(plate.value("code", std::string()));
      if (code) codes.insert(*code);
    }
  }
  return {codes.begin(), codes.end()};
}

}  // namespace tagsmith::detail::bench
