// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/rasterize.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <regex>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/wait.h>

#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {

// ---- Other programs.

namespace {

constexpr std::size_t kErrorBytes = 64U << 10U;

// A pipe whose ends close automatically, and are not inherited by other child processes.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) ends_ = {-1, -1};
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool ok() const { return ends_[0] >= 0; }
  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void close_writer() { close_end(1); }

 private:
  void close_end(std::size_t end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

// Starts argv[0] with its output going into the pipes.
Result<pid_t> spawn(const std::vector<std::string>& argv, const Pipe& out, const Pipe& err) {
  std::vector<char*> arguments;
  arguments.reserve(argv.size() + 1);
  for (const std::string& argument : argv) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.writer(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.writer(), STDERR_FILENO);
  pid_t pid = 0;
  const int error =
      ::posix_spawnp(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return fail(argv[0] + ": not found, is it installed?");
  if (error != 0) return fail(argv[0] + ": cannot be started: " + std::strerror(error));
  return pid;
}

int wait_for(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Appends what the descriptor holds; false at its end.
bool drain(int descriptor, std::string& text) {
  std::array<char, 1U << 16U> buffer;
  const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR;
  text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

// Reads both streams until they end. Returns the error message, empty when there was no error.
std::string collect(int out, int err, const ProcessLimits& limits, ProcessOutput& output) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point deadline = Clock::now() + limits.time;
  std::array<pollfd, 2> streams{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) {
      return "did not end within " + std::to_string(limits.time.count()) + " ms";
    }
    if (::poll(streams.data(), streams.size(), static_cast<int>(left.count())) < 0) {
      if (errno == EINTR) continue;
      return std::string("cannot be listened to: ") + std::strerror(errno);
    }
    if (streams[0].revents != 0 && !drain(out, output.out)) streams[0].fd = -1;
    if (streams[1].revents != 0 && !drain(err, output.err)) streams[1].fd = -1;
    if (output.err.size() > kErrorBytes) output.err.resize(kErrorBytes);
    if (output.out.size() > limits.output_bytes) {
      return "wrote more than " + std::to_string(limits.output_bytes) + " bytes";
    }
  }
  return {};
}

}  // namespace

Result<ProcessOutput> run_process(const std::vector<std::string>& argv,
                                  const ProcessLimits& limits) {
  Pipe out;
  Pipe err;
  if (!out.ok() || !err.ok()) return fail(argv[0] + ": no pipe for its output");
  const Result<pid_t> pid = spawn(argv, out, err);
  if (!pid) return fail(pid);
  out.close_writer();
  err.close_writer();
  ProcessOutput output;
  const std::string problem = collect(out.reader(), err.reader(), limits, output);
  if (!problem.empty()) ::kill(*pid, SIGKILL);
  output.exit_code = wait_for(*pid);
  if (!problem.empty()) return fail(argv[0] + ": " + problem);
  return output;
}

// ---- Print files.

namespace {

constexpr int kMaxPages = 1000;
constexpr double kDpi = 150;
constexpr double kMaxRasterPixels = 40e6;
constexpr double kMetresPerPoint = kMetresPerInch / 72;

// A name that poppler's programs cannot mistake for an option.
std::string argument_of(const std::filesystem::path& path) {
  const std::string name = path.string();
  return name.starts_with('-') ? "./" + name : name;
}

std::string first_line(const std::string& text) {
  return std::string(trim(std::string_view(text).substr(0, text.find('\n'))));
}

Result<ProcessOutput> run_poppler(const std::filesystem::path& path,
                                  const std::vector<std::string>& argv) {
  Result<ProcessOutput> output = run_process(argv);
  if (!output) {
    return fail(path.string() + ": PDF files need poppler-utils: " + output.error().message);
  }
  if (output->exit_code == 0) return output;
  const std::string reason = first_line(output->err);
  if (reason.find("Incorrect password") != std::string::npos) {
    return fail(path.string() + ": is protected by a password: save it without one");
  }
  return fail(path.string() +
              ": is no PDF that can be drawn: " + (reason.empty() ? argv[0] + " failed" : reason));
}

// The first error that poppler reports; its warnings do not affect the result.
std::string first_error(const std::string& messages) {
  for (const std::string& line : split(messages, '\n')) {
    if (line.find("Error") != std::string::npos) return std::string(trim(line));
  }
  return {};
}

double dots_per_inch(const PageSize& size) {
  const double square_inches = size.width * size.height / (kMetresPerInch * kMetresPerInch);
  return std::min(kDpi, std::sqrt(kMaxRasterPixels / square_inches));
}

bool has_extension(const std::filesystem::path& path, std::string_view wanted) {
  return lower_case(path.extension().string()) == wanted;
}

// The message of rsvg-convert, without the second copy of the file's name.
std::string svg_problem(const std::string& error, const std::string& path) {
  const std::string words = first_line(error);
  const std::size_t at = words.find(path + ": ");
  return at == std::string::npos ? words : words.substr(at + path.size() + 2);
}

// Whether the drawing's size is stated in pixels, or not at all.
bool is_in_pixels(const std::filesystem::path& path) {
  constexpr std::size_t kHead = 4096;
  std::string head(kHead, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  static const std::regex kRoot(R"(<(\w+:)?svg\b[^>]*>)");
  static const std::regex kPhysical(R"(\bwidth\s*=\s*["'][^"']*(mm|cm|in|pt|pc|Q)\s*["'])");
  std::smatch root;
  if (!std::regex_search(head, root, kRoot)) return false;
  return !std::regex_search(root.str(), kPhysical);
}

// A drawn pixel has the share of it that is paper, which is the light that it reflects: converted
// to the sample that a camera would store for that light, as the reader expects.
GrayImage as_photographed(const GrayImage& drawn) { return linear_as_srgb(drawn.view()); }

// A page, or the part of it that `part` selects, at so many dots per inch.
Result<PageImage> draw_page(const std::filesystem::path& path, int number, const std::string& dpi,
                            const std::vector<std::string>& part, const PrinterScale& scale) {
  const std::string page = std::to_string(number);
  // The crop box is what is printed, where a file has one.
  std::vector<std::string> argv{"pdftoppm", "-gray", "-cropbox", "-f", page, "-l", page};
  if (scale.is_true()) {
    argv.insert(argv.end(), {"-r", dpi});
  } else {
    const double dots = *parse_number(dpi);
    argv.insert(argv.end(), {"-rx", format_number(dots * scale.right, 6), "-ry",
                             format_number(dots * scale.down, 6)});
  }
  argv.insert(argv.end(), part.begin(), part.end());
  argv.push_back(argument_of(path));
  const Result<ProcessOutput> drawn = run_poppler(path, argv);
  if (!drawn) return fail(drawn);
  Result<GrayImage> image = decode_gray_image(path.string(), drawn->out);
  if (!image) return fail(path.string() + ": page " + page + " cannot be drawn");
  return PageImage{as_photographed(*image), kMetresPerInch / *parse_number(dpi),
                   first_error(drawn->err)};
}

}  // namespace

bool is_svg(const std::filesystem::path& path) { return has_extension(path, ".svg"); }

bool is_called_pdf(const std::filesystem::path& path) { return has_extension(path, ".pdf"); }

bool is_pdf(std::string_view bytes) {
  constexpr std::size_t kFarthest = 1024;  // readers ignore what stands before it
  return bytes.substr(0, kFarthest).find("%PDF-") != std::string_view::npos;
}

std::optional<StatedTag> stated_tag(const std::filesystem::path& path, std::string_view bytes) {
  constexpr std::size_t kHead = 4096;
  std::string text(bytes.substr(0, kHead));
  if (is_pdf(bytes)) {
    Result<ProcessOutput> fields = run_poppler(path, {"pdfinfo", argument_of(path)});
    if (!fields) return std::nullopt;
    text = std::move(fields->out);
  }
  // "Title:           corridor 000L", "<title>corridor 000L</title>"; then
  // "template tag-400x300, digits 0190 0000 040 4 (sum10)"
  static const std::regex kTitle(R"((?:Title: +|<title>)[^\n<]* ([^\s<]+)\s*(?:\n|</title>))");
  static const std::regex kDigits(R"(digits ([0-9 ]+) \()");
  std::smatch title, digits;
  if (!std::regex_search(text, title, kTitle) || !std::regex_search(text, digits, kDigits)) {
    return std::nullopt;
  }
  StatedTag stated{title[1], digits[1]};
  std::erase(stated.digits, ' ');
  return stated;
}

Result<std::vector<PageSize>> pdf_pages(const std::filesystem::path& path) {
  const std::string last = std::to_string(kMaxPages + 1);
  const Result<ProcessOutput> text =
      run_poppler(path, {"pdfinfo", "-f", "1", "-l", last, argument_of(path)});
  if (!text) return fail(text);
  // "Page    3 size:  1275.59 x 992.126 pts (A4)", "Page    3 rot:  90"
  static const std::regex kSize(R"(Page +\d+ size: +([\d.]+) x ([\d.]+) .*)");
  static const std::regex kTurned(R"(Page +\d+ rot: +(90|270))");
  std::vector<PageSize> pages;
  std::smatch found;
  for (const std::string& line : split(text->out, '\n')) {
    if (std::regex_match(line, found, kSize)) {
      const PageSize size{parse_number(found[1].str()).value_or(0) * kMetresPerPoint,
                          parse_number(found[2].str()).value_or(0) * kMetresPerPoint};
      if (size.width <= 0 || size.height <= 0) break;
      pages.push_back(size);
    } else if (!pages.empty() && std::regex_match(line, kTurned)) {
      std::swap(pages.back().width, pages.back().height);
    }
  }
  if (pages.empty()) return fail(path.string() + ": has no page that can be drawn");
  if (pages.size() > kMaxPages) {
    return fail(path.string() + ": has more than " + std::to_string(kMaxPages) + " pages");
  }
  return pages;
}

Result<PageImage> rasterize_page(const std::filesystem::path& path, int number,
                                 const PageSize& size, const PrinterScale& scale) {
  return draw_page(path, number, format_number(dots_per_inch(size), 3), {}, scale);
}

Result<PageImage> rasterize_svg(const std::filesystem::path& path, double dots_per_inch) {
  constexpr double kPixelsPerInch = 96;  // CSS Values and Units 3, section 5.2
  const std::string dpi = format_number(dots_per_inch, 6);
  std::vector<std::string> argv{"rsvg-convert", "--dpi-x", dpi, "--dpi-y", dpi};
  // --dpi-x draws lengths in millimetres and the like larger, but not those in pixels.
  if (is_in_pixels(path)) {
    argv.insert(argv.end(), {"--zoom", format_number(dots_per_inch / kPixelsPerInch, 9)});
  }
  argv.insert(argv.end(), {"--background-color", "white", argument_of(path)});
  const Result<ProcessOutput> output = run_process(argv);
  if (!output) {
    return fail(path.string() + ": SVG files need librsvg2-bin: " + output.error().message);
  }
  if (output->exit_code != 0) {
    return fail(path.string() +
                ": is no SVG that can be drawn: " + svg_problem(output->err, argument_of(path)));
  }
  Result<GrayImage> image = decode_gray_image(path.string(), output->out);
  if (!image) return fail(image);
  return PageImage{as_photographed(*image), kMetresPerInch / dots_per_inch, {}};
}

Result<GrayImage> rasterize_part(const std::filesystem::path& path, int number,
                                 double dots_per_inch, const PixelRegion& region,
                                 const PrinterScale& scale) {
  if (number > 0) {
    Result<PageImage> drawn =
        draw_page(path, number, format_number(dots_per_inch, 6),
                  {"-x", std::to_string(region.x), "-y", std::to_string(region.y), "-W",
                   std::to_string(region.width), "-H", std::to_string(region.height)},
                  scale);
    if (!drawn) return fail(drawn);
    return std::move(drawn->image);
  }
  Result<GrayImage> whole = GrayImage{};
  if (is_svg(path)) {
    Result<PageImage> drawn = rasterize_svg(path, dots_per_inch);
    if (!drawn) return fail(drawn);
    whole = std::move(drawn->image);
  } else {
    whole = load_gray_image(path).map(as_photographed);
    if (!whole) return whole;
  }
  if (region.x + region.width > whole->width || region.y + region.height > whole->height) {
    return fail(fmt::format("{}: has {} x {} pixels, expected more at {} dpi", path.string(),
                            whole->width, whole->height, format_number(dots_per_inch, 2)));
  }
  const PixelBox box{region.x, region.y, region.x + region.width, region.y + region.height};
  return copy_of(part_of(whole->view(), box));
}

void paste(const GrayImage& piece, GrayImage& image, int x, int y) {
  for (int row = 0; row < piece.height; ++row) {
    if (y + row < 0 || y + row >= image.height) continue;
    const int first = std::max(0, -x);
    const int last = std::min(piece.width, image.width - x);
    if (first >= last) continue;
    std::memcpy(image.samples.data() +
                    static_cast<std::size_t>(y + row) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(x + first),
                piece.view().row(row) + first, static_cast<std::size_t>(last - first));
  }
}

}  // namespace tagsmith::detail
