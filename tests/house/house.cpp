// SPDX-License-Identifier: Apache-2.0
#include "tests/house/house.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <set>

namespace tagsmith::detail::house {
namespace {

constexpr std::array<std::string_view, 26> kLayers{
    "tagsmith/base",         "tagsmith/geometry", "tagsmith/symbology", "tagsmith/tag",
    "tagsmith/survey",       "tagsmith/draft",    "tagsmith/placement", "tagsmith/paper_plan",
    "tagsmith/render",       "tagsmith/cli",      "decoder/image",      "decoder/simulate",
    "decoder/feature_frame", "decoder/scan",      "decoder/reader",     "decoder/paper",
    "decoder/localize",      "decoder/plates",    "decoder/calibrate",  "decoder/grade",
    "decoder/verify",        "decoder/ledger",    "decoder/api",        "decoder/python",
    "decoder/cli",           "main.cpp",
};

constexpr std::array<std::string_view, 6> kTopFolders{"decoder",  "docs",      "surveys",
                                                      "tagsmith", "templates", "tests"};

// Who may include a third-party library. Tests may include any.
struct ThirdParty {
  std::string_view name;
  std::string_view headers;  // regular expression over the whole header name
  std::string_view folders;  // regular expression over the layer
  bool sources_only;         // not in headers: the library stays behind the module's interface
};

constexpr std::array<ThirdParty, 23> kThirdParty{{
    {"OpenSSL", "openssl/evp\\.h", "tagsmith/base", true},
    {"yaml-cpp", "yaml-cpp/.*", "tagsmith/survey", true},
    {"pugixml", "pugixml\\.hpp", "tagsmith/(survey|draft)", true},
    {"Cairo, Pango", "(cairo|pango).*", "tagsmith/render", true},
    {"librsvg", "librsvg/rsvg\\.h", "tagsmith/render", true},
    {"libqrencode", "qrencode\\.h", "tagsmith/render", true},
    {"Little CMS", "lcms2\\.h", "tagsmith/render", true},
    {"zlib", "zlib\\.h", "tagsmith/render|decoder/image", true},
    {"libpng", "png\\.h", "tagsmith/render", true},
    {"libjpeg", "jpeglib\\.h", "decoder/image", true},
    {"libheif", "libheif/heif\\.h", "decoder/image", true},
    {"SQLite", "sqlite3\\.h", "tagsmith/cli|decoder/ledger", true},
    {"CLI11", "CLI/.*", "tagsmith/cli", true},
    {"OpenCV", "opencv2/(core|imgproc|imgcodecs|calib3d)\\.hpp",
     "decoder/(image|simulate|feature_frame|reader|paper|localize|grade)", true},
    {"Ceres", "ceres/.*", "decoder/localize", true},
    {"oneTBB", "(oneapi/)?tbb/.*",
     "(tagsmith|decoder)/cli|tagsmith/placement|decoder/(reader|localize)", true},
    {"nlohmann-json's declarations", "nlohmann/json_fwd\\.hpp", "tagsmith/cli", false},
    {"nlohmann-json", "nlohmann/json\\.hpp",
     "(tagsmith|decoder)/cli|tagsmith/(placement|render)|decoder/verify", true},
    {"tl::expected", "tl/expected.hpp", ".*", false},
    {"fmt", "fmt/.*", "(tagsmith|decoder)/(?!symbology|scan).*|main.cpp", true},
    {"the public interface", "tagsmith/[a-z]+\\.hpp", "decoder/(api|python)", false},
    {"pybind11", "pybind11/.*", "decoder/python", true},
    {"Eigen", "Eigen/.*",
     "tagsmith/(geometry|survey|draft|placement|render|cli)|decoder/(?!python).*", false},
}};

// Folders that run programs or touch files below the C++ library may use the system's headers.
constexpr std::string_view kSystemHeaders = "(sys/)?[a-z0-9_]+\\.h";
constexpr std::string_view kSystemFolders =
    "tagsmith/(base|survey|draft|render|cli)|decoder/(image|verify|cli)|main.cpp";

// The headers that are installed: others include them without this project's tree.
constexpr std::string_view kPublicHeaders = "decoder/api/include/";

// The module that is the public interface in another language, and uses nothing below it.
constexpr std::string_view kOverPublic = "decoder/python";

// The one way to the terminal. A header of templates that take fmt's format strings.
constexpr std::string_view kConsole = "tagsmith/cli/console.hpp";

// The one file that compiles CLI11, which takes ten seconds.
constexpr std::string_view kParser = "tagsmith/cli/parse_command.cpp";

bool matches(std::string_view text, std::string_view pattern) {
  return std::regex_match(text.begin(), text.end(), std::regex(pattern.begin(), pattern.end()));
}

bool starts_with_layer(std::string_view path, std::string_view layer) {
  return path.starts_with(layer) && (path.size() == layer.size() || path[layer.size()] == '/');
}

std::optional<std::size_t> rank_of(std::string_view path) {
  const auto layer = std::ranges::find_if(
      kLayers, [&](std::string_view candidate) { return starts_with_layer(path, candidate); });
  if (layer == kLayers.end()) return std::nullopt;
  return static_cast<std::size_t>(std::distance(kLayers.begin(), layer));
}

std::string allowed_up_to(std::size_t rank) {
  std::string text;
  for (std::size_t i = 0; i <= rank; ++i) {
    text += (i == 0 ? "" : " ") + std::string(kLayers[i]);
  }
  return text;
}

// What is wrong with `#include "header"`; empty when nothing is.
std::string check_own_include(std::string_view file, std::string_view header) {
  const std::optional<std::size_t> rank = rank_of(file);
  const std::optional<std::size_t> included = rank_of(header);
  if (is_public(file)) return "a public header includes <tagsmith/...> and the standard library";
  if (layer_of(file) == kOverPublic && layer_of(header) != kOverPublic) {
    return "decoder/python includes the public interface alone, <tagsmith/...>";
  }
  if (!rank) {
    if (included || header.starts_with("tests/")) return {};
    return "include paths start at the project's root";
  }
  // A document that the build takes into the program.
  if (header.starts_with("docs/") && header.ends_with(".md.inc")) return {};
  if (!included) return "not a folder of the house; allowed: " + allowed_up_to(*rank);
  if (*included <= *rank) return {};
  return std::string(kLayers[*included]) + " stands below; allowed: " + allowed_up_to(*rank);
}

// The same of `#include <header>` in a public header.
std::string check_public_include(std::string_view header) {
  if (matches(header, "[a-z0-9_]+|tagsmith/[a-z]+\\.hpp")) return {};
  return "a public header includes <tagsmith/...> and the standard library";
}

// What is wrong with `#include <header>` in a file of the layer; empty when nothing is.
std::string check_third_party(std::string_view file, std::string_view header) {
  const std::string layer = layer_of(file);
  if (layer.empty()) return {};
  if (matches(header, "[a-z0-9_]+")) return {};  // the standard library
  for (const ThirdParty& library : kThirdParty) {
    if (!matches(header, library.headers)) continue;
    if (!matches(layer, library.folders)) {
      return std::string(library.name) + " is allowed only in " + std::string(library.folders);
    }
    if (library.sources_only && !file.ends_with(".cpp") && file != kConsole) {
      return std::string(library.name) + " is allowed only in .cpp files";
    }
    return {};
  }
  if (matches(header, kSystemHeaders)) {
    if (matches(layer, kSystemFolders)) return {};
    return "system headers are allowed only in " + std::string(kSystemFolders);
  }
  return "not in the house's list of third-party headers (kThirdParty in tests/house/house.cpp)";
}

// What is wrong with a line of code that is no include; empty when nothing is.
std::string check_line(std::string_view file, std::string_view line) {
  static const std::regex unfinished(
      "\\b(TO"
      "DO|FIX"
      "ME|XX"
      "X|HA"
      "CK)\\b");
  static const std::regex prints(
      "std::(cout|cerr|clog)\\b|\\bf?printf\\(|fmt::v?print\\(|\\b(f?puts|f?putc|putchar|fwrite|"
      "perror)\\(");
  static const std::regex ends("std::(exit|abort)\\b");
  if (std::regex_search(line.begin(), line.end(), unfinished)) return "unfinished work";
  const std::string layer = layer_of(file);
  const bool library = !layer.empty() && layer != "main.cpp" && !layer.ends_with("/cli");
  const std::string_view code = line.substr(0, line.find("//"));
  const bool is_print = std::regex_search(code.begin(), code.end(), prints);
  if (library && (is_print || std::regex_search(code.begin(), code.end(), ends))) {
    return "libraries neither print nor end the program";
  }
  if (is_print && !layer.empty() && file != kConsole) {
    return "show text by tagsmith/cli/console.hpp, which makes it harmless";
  }
  static const std::regex parser("\\bCLI::");
  if (!layer.empty() && file != kParser && std::regex_search(code.begin(), code.end(), parser)) {
    return "options are data (tagsmith/cli/command.hpp); CLI11 is for parse_command.cpp";
  }
  return {};
}

std::string check_include_or_line(std::string_view file, std::string_view line) {
  static const std::regex include("\\s*#\\s*include\\s*([<\"])([^>\"]*)[>\"].*");
  std::match_results<std::string_view::const_iterator> match;
  if (!std::regex_match(line.begin(), line.end(), match, include)) return check_line(file, line);
  const std::string header = match[2].str();
  const bool own = match[1].str() == "\"";
  const std::string problem = own               ? check_own_include(file, header)
                              : is_public(file) ? check_public_include(header)
                                                : check_third_party(file, header);
  return problem.empty() ? problem : "includes " + header + ": " + problem;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

}  // namespace

std::span<const std::string_view> layers() { return kLayers; }
std::span<const std::string_view> top_folders() { return kTopFolders; }

std::string layer_of(std::string_view file) {
  const std::optional<std::size_t> rank = rank_of(file);
  return rank ? std::string(kLayers[*rank]) : std::string();
}

bool is_public(std::string_view file) { return file.starts_with(kPublicHeaders); }

std::vector<std::string> check_source(std::string_view file, std::string_view text) {
  std::vector<std::string> violations;
  const auto add = [&](std::size_t line, const std::string& problem) {
    violations.push_back(std::string(file) + ":" + std::to_string(line) + ": " + problem);
  };
  const std::vector<std::string_view> lines = lines_of(text);
  const bool inside = file.starts_with("tests/") || file.starts_with("docs/");
  if (!inside && layer_of(file).empty()) {
    add(1, "lies in no folder of the house; allowed: " + allowed_up_to(kLayers.size() - 1));
  }
  if (lines.empty() || lines[0] != "// SPDX-License-Identifier: Apache-2.0") {
    add(1, "the first line must be the SPDX line");
  }
  if (file.ends_with(".hpp") && std::ranges::find(lines, "#pragma once") == lines.end()) {
    add(1, "a header needs #pragma once");
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string problem = check_include_or_line(file, lines[i]);
    if (!problem.empty()) add(i + 1, problem);
  }
  return violations;
}

std::vector<std::string> include_rings(const std::map<std::string, std::string>& sources) {
  static const std::regex include("\\s*#\\s*include\\s*\"([^\"]*)\"");
  const auto name_of = [](const std::string& file) { return file.substr(0, file.rfind('.')); };
  std::map<std::string, std::set<std::string>> included;
  for (const auto& [file, text] : sources) {
    std::set<std::string>& by_file = included[name_of(file)];
    for (const std::string_view line : lines_of(text)) {
      std::match_results<std::string_view::const_iterator> match;
      if (!std::regex_match(line.begin(), line.end(), match, include)) continue;
      const std::string name = name_of(match[1]);
      if (name != name_of(file)) by_file.insert(name);
    }
  }
  // Takes away what includes nothing that is left, and what nothing that is left includes.
  const auto is_free = [&](const auto& node) {
    const auto is_left = [&](const std::string& name) { return included.contains(name); };
    const auto includes_it = [&](const auto& other) { return other.second.contains(node.first); };
    return std::ranges::none_of(node.second, is_left) ||
           std::ranges::none_of(included, includes_it);
  };
  for (auto node = included.begin(); node != included.end();) {
    if (is_free(*node)) {
      included.erase(node);
      node = included.begin();
    } else {
      ++node;
    }
  }
  std::vector<std::string> rings;
  for (const auto& [name, by_file] : included) rings.push_back(name);
  return rings;
}

std::vector<std::string> types_defined(std::string_view header) {
  static const std::regex definition(
      "(?:struct|class|enum class) (?:TAGSMITH_\\w+ )?([\\w:]+)[^;]*\\{.*");
  std::vector<std::string> names;
  for (const std::string_view line : lines_of(header)) {
    std::match_results<std::string_view::const_iterator> match;
    if (std::regex_match(line.begin(), line.end(), match, definition)) names.push_back(match[1]);
  }
  return names;
}

std::vector<std::string> constants_defined(std::string_view source) {
  static const std::regex definition(
      "(?:inline |static )*(?:constexpr|const) [^;={(]*\\b(k[A-Z]\\w*)(?: =|\\{|\\[|;).*");
  std::vector<std::string> names;
  for (const std::string_view line : lines_of(source)) {
    std::match_results<std::string_view::const_iterator> match;
    if (std::regex_match(line.begin(), line.end(), match, definition)) names.push_back(match[1]);
  }
  return names;
}

namespace {

std::size_t count_matches(std::string_view text, const std::regex& pattern) {
  using Matches = std::regex_iterator<std::string_view::const_iterator>;
  return static_cast<std::size_t>(
      std::distance(Matches(text.begin(), text.end(), pattern), Matches()));
}

}  // namespace

std::size_t count_tuned_values(std::string_view source) {
  static const std::regex value("\\w( = |\\{)");
  std::size_t count = 0;
  bool inside = false;
  for (std::string_view line : lines_of(source)) {
    line = line.substr(0, line.find("//"));
    if (line.starts_with("}")) inside = false;
    if (inside) count += count_matches(line, value);
    if (line.starts_with("struct ") && line.ends_with("Tuning {")) inside = true;
  }
  return count;
}

std::size_t count_named_constants(std::string_view source) {
  static const std::regex constant("constexpr [^;=]*\\bk[A-Z]\\w*( =|\\{|\\[)");
  std::size_t count = 0;
  for (const std::string_view line : lines_of(source)) count += count_matches(line, constant);
  return count;
}

std::vector<std::string> cited_decisions(std::string_view text) {
  static const std::regex citation("decisions/(\\d{4}[\\w-]*\\.md)|\\bdecisions? (?:record )?\\d+",
                                   std::regex::icase);
  std::vector<std::string> cited;
  using Citations = std::regex_iterator<std::string_view::const_iterator>;
  for (Citations at(text.begin(), text.end(), citation), end; at != end; ++at) {
    cited.push_back((*at)[1].matched ? (*at)[1].str() : at->str());
  }
  return cited;
}

std::vector<std::string> unlisted_sources(std::string_view cmake_list,
                                          std::span<const std::string> sources) {
  std::vector<std::string> unlisted;
  for (const std::string& source : sources) {
    const std::regex word("(^|[\\s(/])" + std::regex_replace(source, std::regex("\\."), "\\.") +
                          "([\\s)]|$)");
    if (!std::regex_search(cmake_list.begin(), cmake_list.end(), word)) unlisted.push_back(source);
  }
  return unlisted;
}

}  // namespace tagsmith::detail::house
