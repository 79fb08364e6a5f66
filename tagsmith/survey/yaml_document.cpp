// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/yaml_document.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <sstream>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kDeepestNode = 32;
constexpr std::size_t kMostNodes = 4'000'000;

// yaml-cpp reads an outermost [...] or {...} to its end before it reports anything, at some 100
// bytes of memory a byte.
constexpr std::size_t kLongestFlow = 2'000'000;

// Whether a tab is among the blanks that this line begins with.
bool is_indented_by_tab(std::string_view text, int line) {
  text.remove_prefix(start_of_line(text, line));
  return text.substr(0, text.find_first_not_of(" \t")).find('\t') != std::string_view::npos;
}

// Ends the parse; the reason is in the log.
struct Abandoned : std::exception {};

// yaml-cpp counts lines and columns from 0.
Place place_of(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

// A quoted text that takes in lines which look like a file's own, because its first line lacks the
// closing quote.
struct OpenQuote {
  Place place{};  // line 0: there is none
  int last_line = 0;
};

// Whether a line begins with a key, as it or its list's item.
bool begins_with_key(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" -"), line.size()));
  const std::size_t end = std::min(
      line.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"), line.size());
  return end > 0 && end < line.size() && line[end] == ':' &&
         (end + 1 == line.size() || line[end + 1] == ' ');
}

// Whether the quoted text [begin, end) is open: it ends with the file, or lines of it are keys.
bool is_open_quote(std::string_view text, std::size_t begin, std::size_t end) {
  const std::string_view quoted = text.substr(begin, end - begin);
  if (quoted.size() < 2 || quoted.back() != quoted.front()) return true;
  for (std::size_t at = quoted.find('\n'); at < quoted.size(); at = quoted.find('\n', at + 1)) {
    const std::string_view rest = quoted.substr(at + 1);
    if (begins_with_key(rest.substr(0, rest.find_first_of("\r\n")))) return true;
  }
  return false;
}

void log_open_quote(const OpenQuote& quote, FindingLog& log) {
  log.error(quote.place, "open-quote",
            "a quote that is not closed on its line: the text runs on to line " +
                std::to_string(quote.last_line),
            "close it on the same line, behind the last word that it is to hold");
}

void log_too_deep(Place place, FindingLog& log) {
  log.error(place, "too-deep",
            "nested more than " + std::to_string(kDeepestNode) + " deep, expected at most 5");
}

class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(FindingLog& log, std::string_view known_tag, const OpenQuote& open_quote)
      : log_(log), known_tag_(known_tag), open_quote_(open_quote) {}

  std::optional<YamlNode> take() { return std::exchange(root_, std::nullopt); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ < 2) return;
    log_.error(place_of(mark), "several-documents", "a second document begins, expected one",
               "put each into a file of its own");
    throw Abandoned();
  }

  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    add({.place = place_of(mark)}, true);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    add(broken(mark, "alias", "an alias (*name), expected the value itself",
               "write the value out; aliases are not supported"),
        false);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    if (tag == "!" && place_of(mark).line == open_quote_.place.line) {
      log_open_quote(open_quote_, log_);
      throw Abandoned();
    }
    if (!plain_tag(tag)) return add(explicit_tag(mark, tag), false);
    add({.kind = YamlNode::Kind::scalar,
         .quoted = tag == "!",
         .place = place_of(mark),
         .text = value},
        false);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value style) override {
    open(mark, tag, YamlNode::Kind::sequence, style);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value style) override {
    open(mark, tag, YamlNode::Kind::map, style);
  }
  void OnMapEnd() override { close(); }

 private:
  // A map or sequence being read, or the document itself at the bottom.
  struct Open {
    YamlNode node;
    bool at_key_of_parent = false;  // place it at the key it is the value of
  };

  bool plain_tag(const std::string& tag) const {
    return tag.empty() || tag == "?" || tag == "!" || tag == known_tag_;
  }

  YamlNode broken(const YAML::Mark& mark, std::string code, std::string message, std::string hint) {
    log_.error(place_of(mark), std::move(code), std::move(message), std::move(hint));
    return {.kind = YamlNode::Kind::broken, .place = place_of(mark)};
  }

  YamlNode explicit_tag(const YAML::Mark& mark, const std::string& tag) {
    return broken(mark, "yaml-tag", "the YAML tag " + tag + ", expected a plain value",
                  "remove the tag");
  }

  void open(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind,
            YAML::EmitterStyle::value style) {
    if (open_.size() >= kDeepestNode) {
      log_too_deep(place_of(mark), log_);
      throw Abandoned();
    }
    const bool is_block = style == YAML::EmitterStyle::Block;
    YamlNode node{.kind = kind, .place = place_of(mark)};
    if (!plain_tag(tag)) node = explicit_tag(mark, tag);
    node.flow = !is_block;
    open_.push_back({std::move(node), is_block});
  }

  void close() {
    Open entry = std::move(open_.back());
    open_.pop_back();
    add(std::move(entry.node), entry.at_key_of_parent);
  }

  void add(YamlNode node, bool at_key) {
    if (++count_ > kMostNodes) {
      log_.error(node.place, "too-many-values",
                 "more than " + std::to_string(kMostNodes) + " values in one file",
                 "split it into several files");
      throw Abandoned();
    }
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    YamlNode& parent = open_.back().node;
    if (parent.kind == YamlNode::Kind::map && parent.keys.size() == parent.items.size()) {
      add_key(parent, node);
      return;
    }
    if (parent.kind == YamlNode::Kind::map && at_key) node.place = parent.keys.back().place;
    parent.items.push_back(std::move(node));
  }

  void add_key(YamlNode& map, const YamlNode& key) {
    if (key.kind == YamlNode::Kind::sequence || key.kind == YamlNode::Kind::map ||
        key.kind == YamlNode::Kind::empty) {
      log_.error(key.place, "complex-key", "a key that is no word, expected a name",
                 "write `name: value`");
      throw Abandoned();
    }
    map.keys.push_back({key.text, key.place});
  }

  FindingLog& log_;
  std::string_view known_tag_;
  OpenQuote open_quote_;
  std::vector<Open> open_;
  std::optional<YamlNode> root_;
  std::size_t count_ = 0;
  int documents_ = 0;
};

// Follows brackets and braces, skipping quoted text and comments; true when they nest no deeper and
// run no longer than the parser can handle. Whether a quote begins is judged by the character
// before it; the first one that is not closed is noted.
bool check_flow(std::string_view text, OpenQuote& open_quote, FindingLog& log) {
  std::size_t depth = 0;
  std::size_t start = 0;  // of the outermost collection
  int line = 1;
  char before = '\n';  // the last character that is no blank, or a line's end
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool after_blank = i == 0 || text[i - 1] == ' ' || text[i - 1] == '\t' || before == '\n';
    if (c == '#' && after_blank) {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if ((c == '"' || c == '\'') &&
               std::string_view("\n[{,:-?").find(before) != std::string_view::npos) {
      const std::size_t end = end_of_quotes(text, i);
      const int first = line;
      line += static_cast<int>(std::ranges::count(text.substr(i, end - i), '\n'));
      if (open_quote.place.line == 0 && is_open_quote(text, i, end)) {
        open_quote = {{first, static_cast<int>(i - (text.rfind('\n', i) + 1)) + 1}, line};
      }
      i = end - 1;
    } else if (c == '[' || c == '{') {
      if (depth++ == 0) start = i;
    } else if (c == ']' || c == '}') {
      if (depth > 0) --depth;
    }
    if (depth > kDeepestNode) {
      log_too_deep({line, 0}, log);
      return false;
    }
    if (depth > 0 && i - start > kLongestFlow) {
      log.error({line, 0}, "long-flow",
                "brackets around more than " + std::to_string(kLongestFlow) + " characters",
                "write the list without brackets, each item on a line of its own after a dash");
      return false;
    }
    if (c == '\n') ++line;
    if (c != ' ' && c != '\t') before = c;
  }
  return true;
}

// How pictures and PDF files begin.
bool begins_like_picture(std::string_view text) {
  constexpr std::array<std::string_view, 6> kBegins{"\xFF\xD8\xFF", "\x89PNG", "%PDF",
                                                    "II*",          "MM",      "RIFF"};
  return std::ranges::any_of(kBegins,
                             [&](std::string_view begin) { return text.starts_with(begin); });
}

}  // namespace

std::optional<std::size_t> index_of_key(const YamlNode& map, std::string_view key) {
  const auto found = std::ranges::find(map.keys, key, &YamlKey::text);
  if (found == map.keys.end()) return std::nullopt;
  return static_cast<std::size_t>(found - map.keys.begin());
}

const YamlNode* value_at(const YamlNode& map, std::string_view key) {
  const std::optional<std::size_t> index = index_of_key(map, key);
  return index ? &map.items[*index] : nullptr;
}

std::size_t next_line(std::string_view text, std::size_t at) {
  return std::min(text.find('\n', at), text.size() - 1) + 1;
}

std::size_t start_of_line(std::string_view text, int line) {
  std::size_t start = 0;
  for (int i = 1; i < line; ++i) start = next_line(text, start);
  return start;
}

std::size_t end_of_quotes(std::string_view text, std::size_t quote) {
  std::size_t i = quote + 1;
  while (i < text.size() && text[i] != text[quote]) {
    i += text[quote] == '"' && text[i] == '\\' ? 2 : 1;
  }
  return std::min(i + 1, text.size());
}

bool check_utf8(std::string_view text, FindingLog& log) {
  const bool is_picture = begins_like_picture(text);
  Place place{1, 1};
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char first = text.front();
    const bool control =
        static_cast<unsigned char>(first) < 0x20 && first != '\t' && first != '\n' && first != '\r';
    if (length == 0 || control) {
      log.error(place, "not-utf-8", "a byte that is no text, expected UTF-8",
                is_picture ? "this is a picture or a PDF, where a text file is expected"
                           : "save the file as UTF-8");
      return false;
    }
    place = first == '\n' ? Place{place.line + 1, 1} : Place{place.line, place.column + 1};
    text.remove_prefix(length);
  }
  return true;
}

std::optional<YamlNode> parse_yaml(std::string_view text, FindingLog& log,
                                   std::string_view known_tag) {
  OpenQuote open_quote;
  if (!check_utf8(text, log) || !check_flow(text, open_quote, log)) return std::nullopt;
  TreeBuilder builder(log, known_tag, open_quote);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const Abandoned&) {
    return std::nullopt;
  } catch (const YAML::Exception& error) {
    if (open_quote.place.line > 0) {
      log_open_quote(open_quote, log);
      return std::nullopt;
    }
    const Place place = place_of(error.mark);
    return log.error(
        place, "syntax", "no valid YAML: " + error.msg,
        is_indented_by_tab(text, place.line)
            ? "indent by spaces: YAML takes no tabs there"
            : "check indentation, brackets, quotes and colons on this line and the one "
              "before");
  }
  std::optional<YamlNode> root = builder.take();
  if (!root || root->kind == YamlNode::Kind::empty) {
    return log.error({1, 1}, "empty-file", "the file is empty, expected keys and values");
  }
  return root;
}

Result<YamlNode> parse_yaml_to_edit(std::string_view text, const std::string& name) {
  FindingLog log(name);
  std::optional<YamlNode> root = parse_yaml(text, log);
  if (!root) return fail(to_string(log.sorted(), true));
  return std::move(*root);
}

}  // namespace tagsmith::detail
