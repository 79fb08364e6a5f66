// SPDX-License-Identifier: Apache-2.0
// The proof of a print: its files, drawn as pixels and read as a camera would. The reader belongs
// to another layer; the program that combines both passes it in.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/page.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// A page as it was laid out, and the file it stands in.
struct ProofPage {
  std::filesystem::path file;
  int number = 0;  // of the page in a PDF, from 1; 0 in a picture
  const Page* page = nullptr;
  double bar_adjustment = 0;  // metres by which bars and strokes are drawn bolder than laid out
  PrinterScale scale{};       // with which the file has the size of the page as laid out
};

// One tag in the files of one format.
struct TagProof {
  std::string tag;
  std::string file;          // name of the first file that shows it
  double dots_per_inch = 0;  // at which it was drawn
  std::string digits;        // as read; empty when it was not
  double length_error = 0;   // of the feature frame inside, found minus expected, metres
  double height_error = 0;
  double corner_error = 0;  // the farthest of the four inner corners from its place, metres
  std::string zbar{};       // what zbar read; empty when it was not asked
  std::string problem{};    // what is wrong, in words; empty = nothing
};

// Draws the pages, which are in files of one format, at so many dots per inch (fewer where that
// makes too large a picture), puts each tag's pieces together and reads them. A proof for each tag
// at true scale. Fails when a file cannot be drawn.
using ProvePages = std::function<Result<std::vector<TagProof>>(
    const Survey& survey, std::span<const ProofPage> pages, int dots_per_inch)>;

}  // namespace tagsmith::detail
