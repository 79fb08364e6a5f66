// SPDX-License-Identifier: Apache-2.0
// Reads folders of photos that have a truth.json and tables what was read: recall by resolution,
// wrong readings, corner errors. Usage: bench_photo_sets FOLDER...
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/bench/other_readers.hpp"

using namespace tagsmith;
namespace fs = std::filesystem;

namespace {

struct Cell {
  std::vector<int> others;  // read, as bench::other_readers()
  int tags = 0;
  int read = 0;
  std::vector<double> errors;       // of each coordinate of each corner, pixels, absolute
  std::vector<double> chi_squares;  // of each tag's corners against their covariance, over 8
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  bool verbose = false;
  bool with_book = false;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "-v") {
      verbose = true;
      continue;
    }
    if (std::string(argv[i]) == "-b") {
      with_book = true;
      continue;
    }
    const fs::path folder = argv[i];
    const auto truth = nlohmann::json::parse(std::ifstream(folder / "truth.json"));
    std::map<std::string, Cell> cells;
    ReadOptions options;
    options.check = parse_check_digit(truth.at("check").get<std::string>());
    if (with_book) {
      for (const auto& item : truth.at("images")) {
        for (const auto& plate : item.at("plates")) {
          if (!plate.contains("code")) continue;
          const auto code = parse_digits(plate.at("code").get<std::string>());
          if (code && std::find(options.code_book.begin(), options.code_book.end(), *code) ==
                          options.code_book.end()) {
            options.code_book.push_back(*code);
          }
        }
      }
    }
    int wrong = 0;
    std::vector<double> times;
    std::vector<double> bias;
    for (const auto& item : truth.at("images")) {
      const std::string file = item.at("file").get<std::string>();
      const Result<GrayImage> image = load_gray_image(folder / file);
      if (!image) {
        fmt::print("{}\n", image.error().message);
        return 2;
      }
      const auto start = std::chrono::steady_clock::now();
      const ReadResult result = read_tags(image->view(), options);
      times.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
              .count());
      std::vector<std::set<std::string>> other_codes;
      for (const bench::OtherReader& reader : bench::other_readers()) {
        other_codes.push_back(reader.read(image->view()));
      }
      std::vector<bool> right(result.tags.size());
      for (const auto& plate : item.at("plates")) {
        if (plate.at("kind") != "upca" || !plate.at("frame_in_image").get<bool>()) continue;
        const std::string code = plate.at("code").get<std::string>();
        const double ppm = plate.at("px_per_module").get<double>();
        const std::string level = item.value("level", std::string("all"));
        const std::string bin = ppm >= 2     ? "2.0+"
                                : ppm >= 1.5 ? "1.5-2.0"
                                : ppm >= 1   ? "1.0-1.5"
                                : ppm >= 0.8 ? "0.8-1.0"
                                             : "0.0-0.8";
        Cell& cell = cells[level + " " + bin];
        ++cell.tags;
        cell.others.resize(other_codes.size());
        for (std::size_t r = 0; r < other_codes.size(); ++r) {
          cell.others[r] += other_codes[r].contains(code) ? 1 : 0;
        }
        bool found = false;
        for (std::size_t k = 0; k < result.tags.size(); ++k) {
          const Reading& reading = result.tags[k];
          if (to_string(reading.digits) != code) continue;
          right[k] = true;
          found = true;
          ++cell.read;
          const char* names[] = {"P", "F", "R", "Q"};
          std::string text;
          Eigen::Matrix<double, 8, 1> error;
          for (std::size_t c = 0; c < 4; ++c) {
            const auto& corner = plate.at("corners_px").at(names[c]);
            const double ex = reading.corners[c].x - corner[0].get<double>();
            const double ey = reading.corners[c].y - corner[1].get<double>();
            error.segment<2>(static_cast<Eigen::Index>(2 * c)) << ex, ey;
            cell.errors.push_back(std::abs(ex));
            cell.errors.push_back(std::abs(ey));
            text += fmt::format(" {:+.3f},{:+.3f}", ex, ey);
          }
          const CornerCovariance& covariance = reading.corner_covariance;
          const double chi_square = error.dot(covariance.ldlt().solve(error));
          cell.chi_squares.push_back(chi_square / 8);
          if (verbose) {
            fmt::print("{} {} ppm {:.2f} inc {:.0f} conf {:.9f} err{} sigma {:.4f} chi2/8 {:.2f}\n",
                       file, code, ppm, plate.at("incidence_deg").get<double>(), reading.confidence,
                       text, std::sqrt(covariance.trace() / 8), chi_square / 8);
          }
          break;
        }
        if (!found && verbose) {
          fmt::print("{} {} MISSED ppm {:.2f} inc {:.0f} visible {:.2f}:", file, code, ppm,
                     plate.at("incidence_deg").get<double>(),
                     plate.at("fraction_visible").get<double>());
          for (const Rejection& rejection : result.rejected) {
            fmt::print(" [{} {:.0f},{:.0f}]", rejection.reason, rejection.corners[0].x,
                       rejection.corners[0].y);
          }
          fmt::print("\n");
        }
      }
      for (std::size_t k = 0; k < right.size(); ++k) {
        bool known = right[k];
        for (const auto& plate : item.at("plates")) {
          known = known || plate.value("code", std::string()) == to_string(result.tags[k].digits);
        }
        if (known) continue;
        ++wrong;
        fmt::print("WRONG {} {} conf {:.9f} at {:.0f},{:.0f} ppm {:.2f}\n", file,
                   to_string(result.tags[k].digits), result.tags[k].confidence,
                   result.tags[k].corners[0].x, result.tags[k].corners[0].y,
                   result.tags[k].module_px);
      }
    }
    fmt::print("{}: {} images, {} wrong, median {:.2f} ms, max {:.2f} ms\n",
               folder.filename().string(), times.size(), wrong, median(times),
               *std::max_element(times.begin(), times.end()));
    for (const auto& [name, cell] : cells) {
      fmt::print("  {:20} {:3}/{:3} read, corner error median {:.3f} px, of its covariance {:.2f}",
                 name, cell.read, cell.tags, median(cell.errors), median(cell.chi_squares));
      for (std::size_t r = 0; r < cell.others.size(); ++r) {
        fmt::print(", {} {}", bench::other_readers()[r].name, cell.others[r]);
      }
      fmt::print("\n");
    }
  }
  return 0;
}
