// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without a fuzzer: first each file given, and each file in the folders given,
// then these again with memory that ends at one moment after another, then as many changed ones.
// Whatever the compiler, the same seeds give the same inputs.
// Usage: fuzz_NAME EXECUTIONS MOMENTS FILE|FOLDER...
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

// Of memory that ends: allocations until the one that fails; below 0, none does.
std::atomic<long> allocations_left{-1};

void* allocated(std::size_t size, std::size_t alignment) {
  if (allocations_left >= 0 && allocations_left-- == 0) throw std::bad_alloc();
  const std::size_t padded =
      (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, padded);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// The compiler does not see that what the other operators free is of aligned_alloc.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void* operator new(std::size_t size) { return allocated(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocated(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> inputs_in(const std::vector<std::filesystem::path>& paths) {
  std::vector<std::filesystem::path> files;
  for (const auto& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> inputs;
  for (const auto& file : files) inputs.push_back(contents(file));
  return inputs;
}

// A place in the text, or its end.
std::size_t place_in(const std::string& text, std::mt19937& random) {
  return random() % (text.size() + 1);
}

void change_once(std::string& text, const std::string& other, std::mt19937& random) {
  static const std::string special[] = {"-1", "1e308", "nan", "0",    "99999999999999999999",
                                        "\"", "[",     "{",   "\n",   ": ",
                                        "- ", "\xff",  ",",   "null", std::string(1, '\0')};
  const std::size_t at = place_in(text, random);
  switch (random() % 6) {
    case 0:
      if (at < text.size()) text[at] = static_cast<char>(random());
      break;
    case 1:
      text.erase(at, random() % 16);
      break;
    case 2:
      text.insert(at, special[random() % std::size(special)]);
      break;
    case 3:
      text.insert(at, text.substr(place_in(text, random), random() % 64));
      break;
    case 4:
      text.replace(at, random() % 64, other.substr(place_in(other, random), random() % 64));
      break;
    default:
      if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << (random() % 8)));
  }
}

void run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

long allocations_of(const std::string& input) {
  allocations_left = std::numeric_limits<long>::max();
  run(input);
  return std::numeric_limits<long>::max() - allocations_left.exchange(-1);
}

// Memory ends at so many moments of an input, the same way apart: that is told or thrown.
void run_short_of_memory(const std::string& input, long moments) {
  const long all = allocations_of(input);
  for (long k = 0; k < std::min(all, moments); ++k) {
    allocations_left = all * k / moments;
    try {
      run(input);
    } catch (const std::bad_alloc&) {
    }
    allocations_left = -1;
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 4) {
    std::fprintf(stderr, "usage: %s EXECUTIONS MOMENTS FILE|FOLDER...\n", arguments[0]);
    return 2;
  }
  const long executions = std::atol(arguments[1]);
  const auto inputs = inputs_in({arguments + 3, arguments + count});
  if (inputs.empty()) {
    std::fprintf(stderr, "%s: no seeds\n", arguments[0]);
    return 2;
  }
  const long moments = std::atol(arguments[2]);
  for (const std::string& input : inputs) {
    run(input);
    if (moments > 0) run_short_of_memory(input, moments);
  }
  std::mt19937 random(1);
  for (long i = 0; i < executions; ++i) {
    std::string input = inputs[random() % inputs.size()];
    const std::string& other = inputs[random() % inputs.size()];
    for (std::size_t changes = 1 + random() % 4; changes > 0; --changes) {
      change_once(input, other, random);
    }
    run(input);
  }
  std::printf("%zu seeds, each at up to %ld moments short of memory, and %ld changed inputs\n",
              inputs.size(), moments, executions);
}
