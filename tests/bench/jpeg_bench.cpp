// SPDX-License-Identifier: Apache-2.0
// What a photo's decoding is made of: would decoding less of it help? `./dev bench jpeg`.
#include <cstddef>
#include <cstdio>  // jpeglib.h needs it
#include <jpeglib.h>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "tagsmith/base/file.hpp"

namespace tagsmith::detail {
namespace {

// How much of a photo is decoded.
enum class Part { all, half_size, eighth_size, entropy_alone, coefficients, colour };

// libjpeg's error handler ends the program at a broken file; the shipped photo is none.
void decode(const std::string& bytes, Part part, std::vector<unsigned char>& row) {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  if (part == Part::coefficients) {
    jpeg_read_coefficients(&info);
    jpeg_destroy_decompress(&info);
    return;
  }
  info.out_color_space = part == Part::colour ? JCS_RGB : JCS_GRAYSCALE;
  info.scale_denom = part == Part::eighth_size ? 8 : part == Part::half_size ? 2 : 1;
  jpeg_start_decompress(&info);
  row.resize(3 * static_cast<std::size_t>(info.output_width));
  // Skipped rows are read from the file, and no more.
  if (part == Part::entropy_alone) jpeg_skip_scanlines(&info, info.output_height - 1);
  while (info.output_scanline < info.output_height) {
    JSAMPROW to = row.data();
    jpeg_read_scanlines(&info, &to, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
}

void decode_jpeg_part(benchmark::State& state, Part part) {
  const auto bytes = read_file("surveys/corridor/photos/corridor_01_left.jpg", 1U << 24U);
  if (!bytes) return state.SkipWithError(bytes.error().message.c_str());
  std::vector<unsigned char> row;
  for ([[maybe_unused]] const auto _ : state) decode(*bytes, part, row);
}

BENCHMARK_CAPTURE(decode_jpeg_part, grey, Part::all)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_jpeg_part, grey_half_size, Part::half_size)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_jpeg_part, grey_eighth_size, Part::eighth_size)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_jpeg_part, entropy_alone, Part::entropy_alone)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_jpeg_part, coefficients, Part::coefficients)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_jpeg_part, colour, Part::colour)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tagsmith::detail
