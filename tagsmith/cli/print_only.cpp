// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_only.hpp"

#include <istream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"

namespace tagsmith::detail {
namespace {

// What a line requests; a line that cannot be understood has no name.
struct Wanted {
  std::string name;
  bool print = true;
  std::string revision{};
  bool move = false;
};

// `change` as tagsmith diff says it.
Wanted changed(const std::string& tag, std::string_view change) {
  return {tag, change == "print" || change == "reprint", {}, change == "move"};
}

Wanted from_json(const std::string& line) {
  const nlohmann::json object = parse_json(line);
  if (!object.is_object()) return {};
  if (const auto summary = object.find("summary"); summary != object.end()) {
    const bool names_revision = summary->contains("revision") && (*summary)["revision"].is_string();
    return {"summary", false, names_revision ? (*summary)["revision"].get<std::string>() : ""};
  }
  const auto tag = object.find("tag");
  const auto change = object.find("change");
  if (tag == object.end() || !tag->is_string()) return {};
  if (change == object.end()) return {tag->get<std::string>()};
  if (!change->is_string()) return {};
  return changed(*tag, change->get<std::string>());
}

Wanted from_comment(const std::string& line) {
  const bool names_revision = line.starts_with(kRevisionLine);
  return {"#", false, names_revision ? line.substr(kRevisionLine.size()) : ""};
}

Wanted from_words(const std::string& line) {
  const std::vector<std::string> words = split_words(line);
  if (words.size() == 1) return {words[0]};
  const Wanted wanted = changed(words[1], words[0]);
  return wanted.print || wanted.move || words[0] == "remove" ? wanted : Wanted{};
}

}  // namespace

Result<TagsToPrint> read_tags_to_print(const std::string& path, std::istream& standard_input) {
  constexpr std::size_t kMostBytes = 64U << 20U;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string text;
  if (path == "-") {
    text.assign(std::istreambuf_iterator<char>(standard_input), {});
  } else {
    const Result<std::string> bytes = read_file(path, kMostBytes);
    if (!bytes) return fail(bytes);
    text = *bytes;
  }
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  TagsToPrint tags;
  int number = 0;
  for (const std::string& raw : split(text, '\n')) {
    ++number;
    const std::string line(trim(raw));
    if (line.empty()) continue;
    const Wanted wanted = line.front() == '{'   ? from_json(line)
                          : line.front() == '#' ? from_comment(line)
                                                : from_words(line);
    if (wanted.name.empty()) {
      return fail(
          fmt::format("{}:{}: `{}` names no tag, expected a name, or `reprint NAME` as "
                      "tagsmith diff writes it",
                      path, number, line.substr(0, 60)));
    }
    if (!wanted.revision.empty()) tags.revision = wanted.revision;
    if (wanted.print) tags.names.push_back(wanted.name);
    if (wanted.move) tags.moved.push_back(wanted.name);
  }
  return tags;
}

}  // namespace tagsmith::detail
